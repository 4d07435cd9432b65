"""The evaluation of `MeshForce` compiled: force and stiffness at many points, equal to the last bit."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fe_contact.types import FloatArray, IntArray
from host.loops import inner, njit

LIFTED_OFF, ABOVE_TABLE, OUTSIDE_MISALIGNMENT, OUTSIDE_CENTER_DISTANCE = 1, 2, 4, 8


class KernelTable(NamedTuple):
    """Arrays of a force table that the compiled kernel reads."""

    knots: FloatArray
    spacing: FloatArray
    """`knots`, `spacing`: Knots of position, misalignment and center-distance change, one axis after the
    other, and widths of the intervals that begin at them (unused at the last knot of an open axis). Shape
    (K,) each.
    """
    first: IntArray
    size: IntArray
    """`first`, `size`: Index of the first knot of each axis, and its number of knots. Shape (3,) each."""
    period: float
    """Period of the position, base pitches."""
    level: FloatArray
    """Forces of the levels. Shape (L,)."""
    deflection: FloatArray
    stiffness: FloatArray
    """`deflection`, `stiffness`: O derivatives for every knot and level, side by side. O is also the number
    of a cell's corners, 2^A over A axes of several knots. Shape (P M D L O,) each.
    """
    order: IntArray
    """Orders of each derivative in the axes, 1 or 0. Shape (O, A)."""


@inner(nogil=True, error_model="numpy")
def _wrapped_query(knots: FloatArray, first: int, size: int, period: float, query: float) -> float:
    """Return the query wrapped into the period, or clipped to the ends of an open axis (period 0)."""
    start = knots[first]
    if period > 0.0 and size > 1:
        if start <= query < start + period:
            return float(query)
        return float(start + (query - start) % period)
    return float(min(max(query, start), knots[first + size - 1]))


@inner(nogil=True, error_model="numpy")
def _interval(knots: FloatArray, first: int, size: int, closed: bool, inside: float) -> int:
    """Return the last knot not above a value (as by np.searchsorted) of those at which an interval begins."""
    low, high = 0, size
    while low < high:
        middle = (low + high) >> 1
        if inside < knots[first + middle]:
            high = middle
        else:
            low = middle + 1
    last = size - 1 if closed else max(size - 2, 0)
    return min(max(low - 1, 0), last)


@inner(nogil=True, error_model="numpy")
def _corners(offset: IntArray, active: int, left: int, size: int) -> None:
    """Append an axis to the indices of the 2^`active` corners: each gets two knots, or the only one.

    Backwards, as the corners 2 c and 2 c + 1 take the place of corners that are read before.
    """
    for corner in range((1 << active) - 1, -1, -1):
        begin = offset[corner] * size
        if size > 1:
            offset[2 * corner] = begin + left
            offset[2 * corner + 1] = begin + (left + 1 if left + 1 < size else 0)
        else:
            offset[corner] = begin


@inner(nogil=True, error_model="numpy")
def _weigh(weight: FloatArray, axis: int, t: float, h: float) -> None:
    """Fill the Hermite weights (2 knots, value and slope) of one axis: `Stencil.weights`."""
    s = 1.0 - t
    weight[axis, 0, 0] = (1.0 + 2.0 * t) * s * s
    weight[axis, 0, 1] = h * t * s * s
    weight[axis, 1, 0] = t * t * (3.0 - 2.0 * t)
    weight[axis, 1, 1] = -h * t * t * s


@inner(nogil=True, error_model="numpy")
def _factors(factor: FloatArray, weight: FloatArray, order: IntArray) -> None:
    """Fill the products of one-axis weights, (corners, derivatives): `LevelGrid._factor`."""
    corners, active = order.shape
    for corner in range(corners):
        for o in range(corners):
            total = 1.0
            for axis in range(active):
                term = weight[axis, (corner >> (active - 1 - axis)) & 1, order[o, axis]]
                total = term if axis == 0 else total * term
            factor[corner, o] = total


@inner(nogil=True, error_model="numpy")
def _value(numbers: FloatArray, offset: IntArray, factor: FloatArray, level: int) -> float:
    """Return the value of one level at the query that was placed: `LevelGrid._sum`."""
    total, corners = 0.0, offset.size
    for corner in range(corners):
        start = offset[corner] + level * corners
        for o in range(corners):
            total = total + factor[corner, o] * numbers[start + o]
    return total


@inner(nogil=True, error_model="numpy")
def _level_below(numbers: FloatArray, offset: IntArray, factor: FloatArray, levels: int, d: float) -> int:
    """Return the highest level not above a deflection, -1 below lift-off: `MeshForce._level_below`."""
    low, high = -1, levels
    while high - low > 1:
        middle = (low + high) >> 1
        if _value(numbers, offset, factor, middle) <= d:
            low = middle
        else:
            high = middle
    return low


@inner(nogil=True, error_model="numpy")
def _between(
    d: float, d0: float, d1: float, low: float, high: float, stiffness0: float, stiffness1: float
) -> tuple[float, float]:
    """Force and stiffness by the cubic between two levels: `ForceCubic.cubic` and `ForceCubic.sample`."""
    width = d1 - d0
    t = min(max((d - d0) / width, 0.0), 1.0)
    k0, k1 = width * stiffness0, width * stiffness1
    s = 1.0 - t
    force = low + (high - low) * t * t * (3.0 - 2.0 * t) + t * s * (s * k0 - t * k1)
    tangent = 6.0 * t * s * (high - low) + s * (1.0 - 3.0 * t) * k0 + t * (3.0 * t - 2.0) * k1
    return max(force, 0.0), max(tangent / width, 0.0)


@inner(nogil=True, error_model="numpy")
def _at_deflection(
    level: FloatArray,
    deflection: FloatArray,
    stiffness: FloatArray,
    offset: IntArray,
    factor: FloatArray,
    d: float,
) -> tuple[float, float, int]:
    """Force, stiffness and validity at deflection `d` of the query that was placed: `MeshForce.force_at`."""
    below = _level_below(deflection, offset, factor, level.size, d)
    if below < 0:
        return 0.0, 0.0, LIFTED_OFF
    k = min(below, level.size - 2)
    top, end = _value(deflection, offset, factor, k + 1), _value(stiffness, offset, factor, k + 1)
    if below == level.size - 1:
        return level[k + 1] + end * (d - top), end, ABOVE_TABLE if d > top else 0
    bottom, begin = _value(deflection, offset, factor, k), _value(stiffness, offset, factor, k)
    force, slope = _between(d, bottom, top, level[k], level[k + 1], begin, end)
    return force, slope, 0


@njit(cache=True, nogil=True, error_model="numpy")
def sample_forces(
    table: KernelTable,
    points: FloatArray,
    force: FloatArray,
    stiffness: FloatArray,
    validity: NDArray[np.int8],
) -> None:
    """Fill force (N), stiffness (N/m) and validity, each (n,).

    `points` (4, n) are position, misalignment, change of center distance and deflection, all finite.
    """
    knots, spacing, first, size, period, level, deflections, stiffnesses, order = table
    corners = order.shape[0]
    weight, factor = np.empty((3, 2, 2)), np.empty((corners, corners))
    offset, stride = np.zeros(corners, np.int64), level.size * corners
    for i in range(force.size):
        offset[0], flags, active = 0, 0, 0
        for axis in range(3):
            turn, query = period if axis == 0 else 0.0, points[axis, i]
            inside = _wrapped_query(knots, first[axis], size[axis], turn, query)
            left = _interval(knots, first[axis], size[axis], turn > 0.0, inside)
            _corners(offset, active, left, size[axis])
            if size[axis] > 1:
                knot = first[axis] + left
                width = spacing[knot]
                _weigh(weight, active, (inside - knots[knot]) / width, width)
                active += 1
            if turn == 0.0 and query != inside:
                flags += OUTSIDE_MISALIGNMENT if axis == 1 else OUTSIDE_CENTER_DISTANCE
        for corner in range(corners):
            offset[corner] *= stride
        _factors(factor, weight, order)
        force[i], stiffness[i], flag = _at_deflection(
            level, deflections, stiffnesses, offset, factor, points[3, i]
        )
        validity[i] = flags + flag
