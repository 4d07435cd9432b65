"""Least of many gaps along flanks, by their true values: from samples to the lowest place beside them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_contact.types import FloatArray, IntArray

TrueGap = Callable[[FloatArray, IntArray], FloatArray]
"""Gap in m at ways (k,) in m along the flanks of the contacts (k,)."""
_VALLEYS = 8
"""Samples from which the gap is followed at most."""
_DEEPER = 4.0
"""How much deeper than its parabola a valley may be: its curvature may jump at a node of a surface."""
_STEPS, _LEAST_STEPS = 15, 6
"""Refinements of a place at most, and at least: each side of it is halved once."""
_HALVED = 3
"""One in so many of them halves the longer side: parabolas alone can keep one end of a bracket."""
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
        What the gap may be above its least value about the lowest sample, m.

    Notes
    -----
    Between the neighbors of a sample that is lower than both the gap is followed downwards, first where the
    parabola through the three is lowest, then where another one is lower than what was found. A place is
    taken by the gap there alone.
    """
    value = gap(x, of)
    first = np.searchsorted(of, np.arange(allowed.size))
    last = np.append(first[1:], of.size) - 1
    here = np.arange(of.size)
    left, right = np.maximum(here - 1, first[of]), np.minimum(here + 1, last[of])
    ways, values = (np.stack([each[left], each, each[right]]) for each in (x, value))
    promise = value - _DEEPER * _gain(ways, values)[1]
    place, least = x[first].copy(), np.full(allowed.size, np.inf)
    for _ in range(_VALLEYS):
        lowest = np.minimum.reduceat(promise, first)
        on = np.flatnonzero(lowest < least - allowed)
        if not on.size:
            break
        best = np.flatnonzero(promise == lowest[of])
        best = best[np.unique(of[best], return_index=True)[1]][on]
        promise[best] = np.inf
        ways_on, values_on = _followed(gap, on, ways[:, best], values[:, best], allowed[on])
        lower = values_on < least[on]
        place[on[lower]], least[on[lower]] = ways_on[lower], values_on[lower]
    return place, least


def _gain(ways: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return lowest places of parabolas through three points (3, n), and how far they are below the middle.

    Where the middle is not the lowest of three points it is the place, and nothing is gained.
    """
    before, after = ways[1] - ways[0], ways[2] - ways[1]
    up, down = values[0] - values[1], values[2] - values[1]
    turn = (before > 0.0) & (after > 0.0) & (up >= 0.0) & (down >= 0.0) & (up + down > 0.0)
    before, after = np.where(turn, before, 1.0), np.where(turn, after, 1.0)
    rise, fall = down / after, up / before
    bend = np.where(turn, (rise + fall) / (before + after), 1.0)  # half the curvature
    slope = (rise * before - fall * after) / (before + after)
    place = np.where(turn, ways[1] - 0.5 * slope / bend, ways[1])
    return place, np.where(turn, 0.25 * slope**2 / bend, 0.0)


def _followed(
    gap: TrueGap, of: IntArray, ways: FloatArray, values: FloatArray, allowed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Follow gaps of contacts `of` (n,) down between three points (3, n), the middle the lowest or an end."""
    on: IntArray = np.arange(allowed.size)
    for k in range(_STEPS):
        at, heights = ways[:, on], values[:, on]
        place, gained = _gain(at, heights)
        longer = np.where(at[2] - at[1] > at[1] - at[0], 2, 0)
        side = at[longer, np.arange(on.size)]
        at_end = (at[0] == at[1]) | (at[1] == at[2])
        halved = at_end | (k % _HALVED == _HALVED - 1)
        nearest = _NEAREST * (at[2] - at[0])
        towards = np.where(place == at[1], side - at[1], place - at[1])
        place = at[1] + np.copysign(np.maximum(np.abs(place - at[1]), nearest), towards)
        place = np.where(halved, 0.5 * (at[1] + side), np.clip(place, at[0], at[2]))
        height = gap(place, of[on])
        ways[:, on], values[:, on] = _narrowed(at, heights, place, height)
        more = (gained > allowed[on]) | (heights[1] - height > allowed[on]) | (k < _LEAST_STEPS)
        on = on[more]
        if not on.size:
            break
    return ways[1], values[1]


def _narrowed(
    ways: FloatArray, values: FloatArray, place: FloatArray, height: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the points (3, n) about the lowest of three and a new one."""
    lower, right = height < values[1], place > ways[1]
    outer = np.where(right, 2, 0)
    column = np.arange(place.size)
    new_ways, new_values = ways.copy(), values.copy()
    # the new point is the middle: the old one is its end on the other side; else it is an end itself
    end = np.where(lower, 2 - outer, outer)
    new_ways[end, column] = np.where(lower, ways[1], place)
    new_values[end, column] = np.where(lower, values[1], height)
    new_ways[1], new_values[1] = np.where(lower, place, ways[1]), np.where(lower, height, values[1])
    return new_ways, new_values


def samples(
    nodes: FloatArray, origin: FloatArray, window: tuple[FloatArray, FloatArray]
) -> tuple[FloatArray, IntArray]:
    """Return the ways from `origin` (n,) to all of the nodes (k,), increasing, within windows, and of which.

    All in m along the flank; windows as ways from the origin.
    """
    low, high = (np.searchsorted(nodes, origin + end) for end in window)
    count = np.maximum(high - low, 0)
    of = np.repeat(np.arange(origin.size), count)
    begin = np.cumsum(count) - count
    node = np.arange(of.size) - begin[of] + low[of]
    return nodes[node] - origin[of], of
