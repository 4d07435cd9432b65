"""Places along a shaft: which of them are one, and which are on it."""

from __future__ import annotations

from typing import Protocol

SAME_PLACE = 1e-9
"""Of the shaft's length: places nearer than this are one. n added lengths round by n eps of their sum."""


class Placed(Protocol):
    """A part at a place of a shaft, m from its left end."""

    @property
    def name(self) -> str:
        """What it is called."""
        ...

    @property
    def shaft(self) -> str:
        """Name of the shaft."""
        ...

    @property
    def position(self) -> float:
        """Place along the shaft."""
        ...


def on_length(place: float, length: float) -> bool:
    """Whether `place` (m from the left end) is on a shaft of `length`, m, but for rounding."""
    return -SAME_PLACE * length <= place <= (1.0 + SAME_PLACE) * length


def nearest_on(place: float, length: float) -> float:
    """Return the place on a shaft of `length` nearest to `place`, m from the left end."""
    return min(max(place, 0.0), length)
