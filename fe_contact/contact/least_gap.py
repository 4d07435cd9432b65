"""Least of many gaps along flanks, by their true values: from samples to the lowest point nearby."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from fe_contact.types import FloatArray, IntArray
from host.loops import inner, njit

TrueGap = Callable[[FloatArray, IntArray], FloatArray]
"""Gap in m at ways (k,) in m along the flanks of the contacts (k,)."""
_VALLEYS = 8
"""Most valleys of the samples from which the gap is followed."""
_DEEPER = 4.0
"""Possible depth of a valley below its samples over the depth of the parabola through them. The curvature may
jump at a node of a surface.
"""
_STEPS, _MIN_STEPS = 15, 6
"""Most and fewest refinements of a point. Each side of it is halved once."""
_HALVED = 3
"""Period of the refinements that halve the longer side. Parabolas alone can keep one end of a bracket."""
_NEAREST = 1e-3
"""Least distance of a refinement from the lowest place, over the bracket."""


def least_gap(
    gap: TrueGap, x: FloatArray, of: IntArray, allowed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return where each gap is least (n,), and the gap there; m.

    Parameters
    ----------
    x, of : ndarray, shape (k,)
        Samples in m and their contacts, ordered by contact and way; each contact has one at least.
    allowed : ndarray, shape (n,)
        Allowed difference of the returned gap from the least value about the lowest sample, m.

    Notes
    -----
    A valley is the range between the neighbors of a sample that is lower than both. The gap is followed
    downwards in the valley in which the parabola through these three points is lowest, then in each further
    valley whose parabola is lower than the least gap so far. Parabolas only propose points; the true gap at a
    point decides.
    """
    value = gap(x, of)
    first = np.searchsorted(of, np.arange(allowed.size + 1))
    promise = _promises(x, value, first)
    position, minimum = x[first[:-1]].copy(), np.full(allowed.size, np.inf)
    for _ in range(_VALLEYS):
        on, ways, values = _lowest_valleys(x, value, promise, first, minimum - allowed)
        if not on.size:
            break
        _follow(gap, on, ways, values, allowed[on])
        lower = values[1] < minimum[on]
        position[on[lower]], minimum[on[lower]] = ways[1, lower], values[1, lower]
    return position, minimum


def _follow(
    gap: TrueGap, contact: IntArray, ways: FloatArray, values: FloatArray, allowed: FloatArray
) -> None:
    """Follow gaps of contacts (n,) down between three points (3, n), in place.

    The middle point is the lowest of the three, or at an end of the window the same as an outer one.
    """
    on: IntArray = np.arange(allowed.size)
    for k in range(_STEPS):
        halving, always = k % _HALVED == _HALVED - 1, k < _MIN_STEPS
        position, gain = _refinements(ways, values, on, halving)
        height = gap(position, contact[on])
        on = _narrow(ways, values, (on, position, height, gain), allowed, always)
        if not on.size:
            break


@inner(error_model="numpy")
def _parabola(ways: FloatArray, values: FloatArray, i: int) -> tuple[float, float]:
    """Return the lowest point of the parabola through three points, and its depth below the middle one.

    Where the middle point is not the lowest of the three, it is returned itself, with a depth of 0.
    """
    before, after = ways[1, i] - ways[0, i], ways[2, i] - ways[1, i]
    up, down = values[0, i] - values[1, i], values[2, i] - values[1, i]
    if not (before > 0.0 and after > 0.0 and up >= 0.0 and down >= 0.0 and up + down > 0.0):
        return ways[1, i], 0.0
    rise, fall = down / after, up / before
    bend = (rise + fall) / (before + after)  # half the curvature
    slope = (rise * before - fall * after) / (before + after)
    return ways[1, i] - 0.5 * slope / bend, 0.25 * (slope * slope) / bend


@inner(error_model="numpy")
def _about(x: FloatArray, at: int, first: int, last: int, triple: FloatArray, i: int) -> None:
    """Fill column i of `triple` (3, n) with a sample and its neighbors; at an end it is a neighbor itself."""
    triple[0, i], triple[1, i], triple[2, i] = x[max(at - 1, first)], x[at], x[min(at + 1, last)]


@njit(cache=True, error_model="numpy")
def _promises(x: FloatArray, value: FloatArray, first: IntArray) -> FloatArray:
    """Return the lowest possible gap about each sample; contact n has samples first[n] to first[n + 1]."""
    promise = np.empty(x.size)
    ways, values = np.empty((3, 1)), np.empty((3, 1))
    for n in range(first.size - 1):
        for at in range(first[n], first[n + 1]):
            _about(x, at, first[n], first[n + 1] - 1, ways, 0)
            _about(value, at, first[n], first[n + 1] - 1, values, 0)
            promise[at] = value[at] - _DEEPER * _parabola(ways, values, 0)[1]
    return promise


@njit(cache=True, error_model="numpy")
def _lowest_valleys(
    x: FloatArray, value: FloatArray, promise: FloatArray, first: IntArray, bound: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return contacts with a promise below `bound` (n,), and points and gaps about their best sample.

    Contacts are (m,), points and gaps (3, m).
    The sample with the lowest promise of a contact is taken, and not again by a later call.
    """
    on = np.empty(bound.size, dtype=np.int64)
    ways, values = np.empty((3, bound.size)), np.empty((3, bound.size))
    count = 0
    for n in range(bound.size):
        best = first[n]
        for at in range(first[n] + 1, first[n + 1]):
            if promise[at] < promise[best]:
                best = at
        if promise[best] < bound[n]:
            promise[best] = np.inf
            _about(x, best, first[n], first[n + 1] - 1, ways, count)
            _about(value, best, first[n], first[n + 1] - 1, values, count)
            on[count] = n
            count += 1
    return on[:count], ways[:, :count].copy(), values[:, :count].copy()


@njit(cache=True, error_model="numpy")
def _refinements(
    ways: FloatArray, values: FloatArray, on: IntArray, halving: bool
) -> tuple[FloatArray, FloatArray]:
    """Return the next points between points (3, n) of contacts `on` (m,), and the gain by a parabola."""
    positions, gains = np.empty(on.size), np.empty(on.size)
    for m in range(on.size):
        i = on[m]
        low, middle, high = ways[0, i], ways[1, i], ways[2, i]
        position, gains[m] = _parabola(ways, values, i)
        longer = high if high - middle > middle - low else low
        if halving or middle in (low, high):
            positions[m] = 0.5 * (middle + longer)
        else:
            direction = longer - middle if position == middle else position - middle
            distance = max(abs(position - middle), _NEAREST * (high - low))
            positions[m] = min(max(middle + math.copysign(distance, direction), low), high)
    return positions, gains


@njit(cache=True, error_model="numpy")
def _narrow(
    ways: FloatArray,
    values: FloatArray,
    new: tuple[IntArray, FloatArray, FloatArray, FloatArray],
    allowed: FloatArray,
    always: bool,
) -> IntArray:
    """Replace points (3, n) by the lowest of them and a new one with its neighbors; return contacts to go on.

    `new` has contacts, new points, their gaps, and the depths of the parabolas, (m,) each. A contact goes on
    while a gap or a parabola is lower by more than `allowed`, or `always`.
    """
    on, positions, heights, gains = new
    more, count = np.empty(on.size, dtype=np.int64), 0
    for m in range(on.size):
        i, position, height = on[m], positions[m], heights[m]
        lower, outer = height < values[1, i], 2 if position > ways[1, i] else 0
        if always or gains[m] > allowed[i] or values[1, i] - height > allowed[i]:
            more[count] = i
            count += 1
        if lower:  # the new point is the middle: the old one is its end on the other side
            ways[2 - outer, i], values[2 - outer, i] = ways[1, i], values[1, i]
            ways[1, i], values[1, i] = position, height
        else:
            ways[outer, i], values[outer, i] = position, height
    return more[:count]


class Nodes(NamedTuple):
    """Sorted lists of the coordinates at which gaps of n contacts are sampled, one list after the other."""

    s: FloatArray
    """Coordinates along the flank, m."""
    start: IntArray
    """Start of each list in `s`. Shape (L + 1,)."""
    list_of: IntArray
    """Numbers of the lists of each contact. Shape (K, n)."""
    origin: FloatArray
    """Origin of each list's coordinates at the contact, m. Shape (K, n)."""


@njit(cache=True, error_model="numpy")
def samples(
    window: tuple[FloatArray, FloatArray],
    begin: FloatArray,
    parts: FloatArray,
    nodes: Nodes,
    alike: FloatArray,
) -> tuple[FloatArray, IntArray]:
    """Return ways in m at which gaps are sampled, and their contacts, ordered by contact and way.

    The samples of a window (n,) are `begin` (n,), points at the `parts` (k,) of the window, and nodes. A
    sample within `alike` (n,) m of the next lower one is left out.
    """
    low, high = window
    nearest, beyond = _nodes_within(window, nodes)
    room = (parts.size + 1) * low.size + (beyond - nearest).sum()
    x, of = np.empty(room), np.empty(room, dtype=np.int64)
    first = 0
    for n in range(low.size):
        last = first
        for part in parts:
            x[last] = low[n] + (high[n] - low[n]) * part
            last += 1
        last = _insert(x, min(max(begin[n], low[n]), high[n]), first, last)
        for k in range(len(nodes.origin)):
            for node in range(nearest[k, n], beyond[k, n]):
                last = _insert(x, nodes.s[node] - nodes.origin[k, n], first, last)
        count, below = first, -np.inf
        for at in range(first, last):
            sample = x[at]
            if sample - below > alike[n]:
                x[count], of[count] = sample, n
                count += 1
            below = sample
        first = count
    return x[:first], of[:first]


@inner(error_model="numpy")
def _nodes_within(window: tuple[FloatArray, FloatArray], nodes: Nodes) -> tuple[IntArray, IntArray]:
    """Return the first node (K, n) within each window, and the first one beyond it."""
    nearest, beyond = (
        np.empty(nodes.origin.shape, dtype=np.int64),
        np.empty(nodes.origin.shape, dtype=np.int64),
    )
    for k in range(len(nodes.origin)):
        for n in range(window[0].size):
            start, stop = nodes.start[nodes.list_of[k, n]], nodes.start[nodes.list_of[k, n] + 1]
            along, origin = nodes.s[start:stop], nodes.origin[k, n]
            nearest[k, n] = start + np.searchsorted(along, origin + window[0][n])
            beyond[k, n] = start + np.searchsorted(along, origin + window[1][n])
    return nearest, beyond


@inner(error_model="numpy")
def _insert(x: FloatArray, value: float, first: int, last: int) -> int:
    """Insert a value into the increasing values from `first` to `last`; return the new `last`."""
    at = last
    while at > first and x[at - 1] > value:
        x[at] = x[at - 1]
        at -= 1
    x[at] = value
    return last + 1
