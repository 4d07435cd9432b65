"""Cumulative pitch tolerance of a gear by its size: both libraries size run-out by it."""

from __future__ import annotations

import math

RUN_OUT_SHARE = 0.9
"""Run-out over cumulative pitch tolerance (ISO 1328-1:2013, annex E)."""


def cumulative_pitch_of_class(module: float, diameter: float, tolerance_class: int = 5) -> float:
    """Return F_pT by formula (6) of ISO 1328-1:2013, 5.3.2, not rounded, um; `module`, `diameter` in mm."""
    fifth = 0.002 * diameter + 0.55 * math.sqrt(diameter) + 0.7 * module + 12.0
    return fifth * math.sqrt(2.0) ** (tolerance_class - 5)
