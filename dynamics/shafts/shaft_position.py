"""Positions along a shaft: which of them coincide, and which are on it."""

from __future__ import annotations

from typing import Protocol

SAME_POSITION = 1e-9
"""Of the shaft's length: positions nearer than this coincide. n added lengths round by n eps of their sum."""


class OnShaft(Protocol):
    """A part at a position on a shaft, m from its left end."""

    @property
    def name(self) -> str:
        """Its name."""
        ...

    @property
    def shaft(self) -> str:
        """Name of the shaft."""
        ...

    @property
    def position(self) -> float:
        """Position along the shaft."""
        ...


def on_length(position: float, length: float) -> bool:
    """Whether `position` (m from the left end) is on a shaft of `length`, m, but for rounding."""
    return -SAME_POSITION * length <= position <= (1.0 + SAME_POSITION) * length


def nearest_on(position: float, length: float) -> float:
    """Return the position on a shaft of `length` nearest to `position`, m from the left end."""
    return min(max(position, 0.0), length)
