"""Extent of a gap between flanks: how far it opens and closes at most, and how fast it changes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class Extent:
    """Bounds of a gap; floats, or arrays that broadcast.

    Attributes
    ----------
    low, high : float or ndarray
        Bounds from below and above, m.
    slope : float or ndarray
        Bound of its change per way along the line of action, m/m.
    """

    low: FloatArray | float = 0.0
    high: FloatArray | float = 0.0
    slope: FloatArray | float = 0.0

    def __add__(self, other: Extent) -> Extent:
        """Return the extent of the sum of two gaps."""
        return Extent(self.low + other.low, self.high + other.high, self.slope + other.slope)

    @property
    def reach(self) -> float:
        """Bound of the size of the gap, m."""
        return float(max(np.max(self.high), -np.min(self.low), 0.0))

    @property
    def span(self) -> float:
        """Bound of the difference between any two places, m."""
        return float(max(np.max(self.high), 0.0) - min(np.min(self.low), 0.0))

    def at(self, index: IntArray) -> Extent:
        """Return the extents at indices into its arrays."""
        low, high, slope = (np.asarray(values)[index] for values in (self.low, self.high, self.slope))
        return Extent(low, high, slope)
