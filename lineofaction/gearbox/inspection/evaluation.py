"""Evaluation of a trace: Gaussian filter (ISO 16610-21), mean line, slope and form (ISO 1328-1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray

ALPHA = math.sqrt(math.log(2.0) / math.pi)
"""A wave as long as the cut-off keeps half its amplitude (ISO 16610-21)."""
CUTOFFS = 30.0
"""Cut-offs over the length of a trace, where none is stated."""
_MAX_CUTOFFS, _MAX_POINTS = 200, 20_000
_PER_CUTOFF = 2
"""Steps of the stations at which the filtered trace is kept."""


@dataclass(frozen=True)
class Split:
    """A trace split into its mean line and the rest, m."""

    coordinate: FloatArray
    """Stations, even over the length of the trace."""
    slope: float
    """Rise of the mean line from the first station to the last."""
    rest: FloatArray
    """Filtered trace less its mean line, at the stations."""
    cutoff: float
    """Wavelength of which the filter keeps half the amplitude."""

    @property
    def form(self) -> float:
        """Form deviation: the range of `rest`."""
        return float(np.ptp(self.rest))


def split(coordinate: FloatArray, values: FloatArray, cutoff: float | None = None) -> Split:
    """Filter a trace and split it.

    Raises `ValueError`: too few or too many points, points further apart than the cut-off, or one that is too
    short.

    Parameters
    ----------
    coordinate, values : ndarray, shape (n,)
        Places in order and deviations, m.
    cutoff : float, optional
        m; left out: a thirtieth of the length.
    """
    if not 3 <= coordinate.size <= _MAX_POINTS:
        raise ValueError(f"a trace of 3 to {_MAX_POINTS} points; it has {coordinate.size}")
    length = float(coordinate[-1] - coordinate[0])
    cutoff = length / CUTOFFS if cutoff is None else cutoff
    if cutoff < length / _MAX_CUTOFFS:
        raise ValueError(f"a trace of at most {_MAX_CUTOFFS} cut-offs; {1e3 * cutoff:.4g} mm is too short")
    spacing = float(np.diff(coordinate).max())
    if spacing > cutoff * (1.0 + 1e-9):
        raise ValueError(
            f"a trace whose points are at most the cut-off {1e3 * cutoff:.4g} mm apart; "
            f"two are {1e3 * spacing:.4g} mm apart"
        )
    stations = np.linspace(coordinate[0], coordinate[-1], math.ceil(_PER_CUTOFF * length / cutoff) + 1)
    filtered = gaussian(coordinate, values, stations, cutoff)
    slope, mean = np.polyfit((stations - stations[0]) / length, filtered, 1)
    rest = filtered - mean - slope * (stations - stations[0]) / length
    return Split(stations, float(slope), rest, cutoff)


def gaussian(coordinate: FloatArray, values: FloatArray, at: FloatArray, cutoff: float) -> FloatArray:
    """Return a trace (n,) at places (k,), all in m, filtered by the Gaussian of a cut-off.

    The weights hold lines, so that a slope passes unchanged up to the ends (ISO 16610-28); inside they are
    those of ISO 16610-21.
    """
    way = (coordinate - at[:, None]) / (ALPHA * cutoff)
    weight = np.exp(-math.pi * way**2) * np.gradient(coordinate)
    zero, one, two = (np.sum(weight * way**power, axis=1) for power in range(3))
    mean, moment = weight @ values, (weight * way) @ values
    return np.asarray((two * mean - one * moment) / (zero * two - one**2))
