"""Speeds at which the forced response is looked for."""

from __future__ import annotations

from lineofaction.gearbox.schemas.speeds import OverOrders


class Inputs(OverOrders):
    """Speeds at which the forced response is looked for."""
