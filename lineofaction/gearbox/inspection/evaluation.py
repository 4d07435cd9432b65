"""Evaluation of a trace: Gaussian filter (ISO 16610-21), mean line, slope and form (ISO 1328-1)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.types import FloatArray
from lineofaction.gearbox.inspection.sheet import Interval

ALPHA = math.sqrt(math.log(2.0) / math.pi)
"""A wave as long as the cut-off keeps half its amplitude (ISO 16610-21)."""
CUTOFFS = 30.0
"""Cut-offs over the length of a trace, where none is stated."""
_MAX_CUTOFFS, _MAX_POINTS = 200, 20_000
"""Largest number of cut-offs and of points of a trace."""
_PER_CUTOFF = 2
"""Stations of the filtered trace in a cut-off."""
_ROUNDING = 1e-9
"""Relative rounding of the spacing, and rounding of the ends of an interval, m."""


@dataclass(frozen=True)
class Split:
    """A trace split into its mean line and the rest, m."""

    coordinate: FloatArray
    """Stations, even over the length of the trace."""
    length: float
    slope: float
    """`length`, `slope`: Length over which the slope is stated, and rise of the mean line over it."""
    form: float
    """Form deviation: the range of the evaluated trace less its mean line."""
    rest: FloatArray
    """Filtered trace less its mean line, at the stations."""
    cutoff: float
    """Wavelength of which the filter keeps half the amplitude."""


def split(
    coordinate: FloatArray, values: FloatArray, cutoff: float | None = None, interval: Interval | None = None
) -> Split:
    """Filter a trace and split it.

    Where the machine states an interval, it has filtered the trace before it stores it: slope and form are
    those of the points in the interval, and the filter only thins the rest.

    Raises `ValueError`: too few or too many points, points further apart than the cut-off, or one that is too
    short.

    Parameters
    ----------
    coordinate, values : ndarray, shape (n,)
        Places in order and deviations, m.
    cutoff : float, optional
        m; left out: a thirtieth of the length.
    interval : Interval, optional
        Evaluated part; left out: the whole trace.
    """
    if not 3 <= coordinate.size <= _MAX_POINTS:
        raise ValueError(f"a trace of 3 to {_MAX_POINTS} points; it has {coordinate.size}")
    length = float(coordinate[-1] - coordinate[0])
    cutoff = length / CUTOFFS if cutoff is None else cutoff
    if cutoff < length / _MAX_CUTOFFS:
        raise ValueError(f"a trace of at most {_MAX_CUTOFFS} cut-offs; {1e3 * cutoff:.4g} mm is too short")
    spacing = float(np.diff(coordinate).max())
    if spacing > cutoff * (1.0 + _ROUNDING):
        bound = f"a trace whose points are at most the cut-off {1e3 * cutoff:.4g} mm apart"
        raise ValueError(f"{bound}; two are {1e3 * spacing:.4g} mm apart")
    stations = np.linspace(coordinate[0], coordinate[-1], math.ceil(_PER_CUTOFF * length / cutoff) + 1)
    filtered = gaussian(coordinate, values, stations, cutoff)
    if interval is None:
        slope, mean = np.polyfit((stations - stations[0]) / length, filtered, 1)
        rest = filtered - mean - slope * (stations - stations[0]) / length
        return Split(stations, length, float(slope), float(np.ptp(rest)), rest, cutoff)
    slope, mean, form = _mean_line(coordinate, values, interval)
    rest = filtered - mean - slope * (stations - interval.first) / interval.length
    return Split(stations, interval.length, slope, form, rest, cutoff)


def _mean_line(coordinate: FloatArray, values: FloatArray, interval: Interval) -> tuple[float, float, float]:
    """Return slope and value at the beginning of the mean line of an interval, and the form there."""
    inside = (coordinate >= interval.first - _ROUNDING) & (coordinate <= interval.last + _ROUNDING)
    if inside.sum() < 3:
        raise ValueError(f"a trace of 3 points where it is evaluated; it has {inside.sum()}")
    way = (coordinate[inside] - interval.first) / interval.length
    slope, mean = np.polyfit(way, values[inside], 1)
    return float(slope), float(mean), float(np.ptp(values[inside] - mean - slope * way))


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
