"""What the steps of the two-stage example spend, thorough and quick."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Effort:
    """What the steps spend."""

    search: dict[str, int]
    """Settings of the search."""
    duration: float
    """Of the run-up, s; 0: none."""
    load_cases: int
    """Of the spectrum, the largest shares of time first."""
    element_size_mm: float
    """Of the mesh of the case."""
    modes: int
    """Of the case that are kept."""
    speed_rpm: str
    """Speeds at which the sound is found."""
    orders: int
    """Multiples of the first mesh's frequency in it."""
    band: str
    """Option of `loa noise`: whether levels have a band over what is only guessed."""


THOROUGH = Effort({"evaluations": 600}, 1.0, 4, 20.0, 80, "500:6000:25", 3, "--band")
FEW_DESIGNS = {"evaluations": 64, "sample": 12, "trials": 1}
QUICK = Effort(FEW_DESIGNS, 0.0, 1, 40.0, 40, "500:6000:50", 1, "--no-band")
