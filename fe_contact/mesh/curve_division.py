"""Division of curves into edges whose length follows a size function."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_contact.types import FloatArray

SizeFunction = Callable[[FloatArray], FloatArray]


def divide(start: float, end: float, size: SizeFunction, samples: int = 2001) -> FloatArray:
    """Divide an interval into parts of the length `size`, scaled so that their number is whole.

    Parameters
    ----------
    start, end : float
        Ends of the interval; `end` may be below `start`.
    size : callable
        Wanted length of a part at the coordinates given, > 0, in the unit of the coordinate.
    samples : int
        Points at which `size` is evaluated.

    Returns
    -------
    (n + 1,) array
        Ends of the n >= 1 parts from `start` to `end`, both exact.
    """
    t = np.linspace(start, end, samples)
    density = 1.0 / size(t)
    # number of parts from the start to each sample: it increases where `end` is below `start` too
    number = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.abs(np.diff(t)))])
    count = max(1, int(np.ceil(number[-1] - 1e-9)))  # rounding errors add no part
    ends = np.interp(np.linspace(0.0, number[-1], count + 1), number, t)
    ends[0], ends[-1] = start, end
    return ends


def middles(ends: FloatArray) -> FloatArray:
    """Return the middle of each part."""
    return 0.5 * (ends[1:] + ends[:-1])


def spread(
    points: FloatArray, sizes: FloatArray, growth: float, largest: float
) -> Callable[[FloatArray], FloatArray]:
    """Return the size at a distance from sources of known size: min(largest, size_p + growth |x - p|).

    Parameters
    ----------
    points : (n, 2) array
        Sources, m.
    sizes : (n,) array
        Size at each, m.
    growth : float
        Growth per unit distance.
    largest : float
        Upper bound, m.

    Returns
    -------
    callable
        Maps (k, 2) points to (k,) sizes.
    """

    def size(target: FloatArray) -> FloatArray:
        across, along = (target[:, None, axis] - points[:, axis] for axis in (0, 1))  # (k, n) each
        nearest: FloatArray = np.min(sizes + growth * np.sqrt(across * across + along * along), axis=1)
        return np.minimum(nearest, largest)

    return size
