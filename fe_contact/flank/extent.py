"""Extent of a gap between flanks: how far it opens and closes, how fast it changes and how it bends."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from fe_contact.types import FloatArray, IntArray

_KINK = 1000.0
"""Length over which a jump of the slope counts as a curvature, over the relative radius. The error of the gap
is then below 1 nm.
"""


@dataclass(frozen=True)
class Extent:
    """Bounds of a gap; floats, or arrays that broadcast."""

    low: FloatArray | float = 0.0
    high: FloatArray | float = 0.0
    """`low`, `high`: Bounds from below and above, m."""
    slope: FloatArray | float = 0.0
    """Bound of the slope of the gap along the line of action, m/m."""
    spread: FloatArray | float = 0.0
    """Bound of the range of the gap along a profile, m."""
    kink: FloatArray | float = 0.0
    bend: FloatArray | float = 0.0
    """`kink`, `bend`: Bounds of jumps of the slope, and of the curvature in 1/m, over the roll length."""
    rotation_bound: FloatArray | float = 0.0
    """Bound of the slope times the square of the base radius, for deviations that turn with a gear, m^2. The
    angle of the gear grows with the root of the length along the flank, so that such a gap bends too.
    """

    def __add__(self, other: Extent) -> Extent:
        """Return the extent of the sum of two gaps."""
        return Extent(*(getattr(self, name) + getattr(other, name) for name in _NAMES))

    @property
    def reach(self) -> float:
        """Bound of the size of the gap, m."""
        return float(max(np.max(self.high), -np.min(self.low), 0.0))

    @property
    def span(self) -> float:
        """Bound of the difference between any two places, m."""
        return float(max(np.max(self.high), 0.0) - min(np.min(self.low), 0.0))

    def at(self, index: IntArray) -> Extent:
        """Return the extents at indices into its arrays; numbers hold everywhere."""
        return Extent(*(_at(getattr(self, name), index) for name in _NAMES))

    def curvature(self, base_radius: float, gear: int, rolls: tuple[FloatArray, FloatArray]) -> FloatArray:
        """Return a bound of the curvature along the flanks of a gear, 1/m.

        Parameters
        ----------
        base_radius : float
            Of the gear that the gap belongs to, m.
        gear : int
            0 of the pinion, 1 of the wheel.
        rolls : (ndarray, ndarray)
            Roll lengths of both gears, m.
        """
        roll = rolls[gear]
        per_length = base_radius / roll  # roll length over length along the flank
        kinks = _KINK * self.kink * per_length * (1.0 / rolls[0] + 1.0 / rolls[1])
        return np.asarray(self.bend * per_length**2 + self.rotation_bound / roll**3 + kinks)


_NAMES = tuple(field.name for field in fields(Extent))


def _at(values: FloatArray | float, index: IntArray) -> FloatArray | float:
    return values[index] if isinstance(values, np.ndarray) else values
