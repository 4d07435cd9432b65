"""Load and alignment at which the flanks are looked at."""

from __future__ import annotations

from lineofaction.gearbox.schemas.flank import FlankPoint


class Inputs(FlankPoint):
    """One load and one alignment; what is left out is taken from the case."""
