"""Speeds at which the forced response is looked for."""

from __future__ import annotations

from service.schemas.speeds import OverOrders


class Inputs(OverOrders):
    """Speeds at which the forced response is looked for."""
