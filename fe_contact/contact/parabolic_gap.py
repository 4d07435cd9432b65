"""Gaps made of parabolas along flanks: their least values, and the gaps about these points.

About a touching point, x = 0, a gap (`Gap`) is slope x + curvature x^2/2. At each of its breaks, x = offset,
the slope has a jump and the curvature changes by bend on the side away from the touching point. n gaps are
computed at once.
"""

from __future__ import annotations

import math

import numpy as np

from fe_contact.contact.strip import Gap
from fe_contact.types import FloatArray
from host.loops import inner, njit


@njit(cache=True, error_model="numpy")
def touching_offsets(gap: Gap, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return where gaps that grow to both sides are least between `low` and `high` (n,), m."""
    touching = np.empty(gap.slope.size)
    for i in range(touching.size):
        position = 0.0
        rising = _slope(gap, i, position)  # the search goes downhill: towards -x for a positive slope
        end = low[i] if rising > 0.0 else high[i]
        # the slope is made of straight pieces: from break to break until it changes its sign
        while rising != 0.0 and position != end:
            stop = end  # the next break, or the end
            for k in range(gap.offset.shape[1]):
                offset = gap.offset[i, k]
                if (position - offset) * rising > 0.0 and (offset - stop) * rising > 0.0:
                    stop = offset
            curvature = _curvature(gap, i, 0.5 * (position + stop))
            slope = _one_sided_slope(gap, i, position, -rising)
            step = -slope / curvature if curvature > 0.0 else -rising * math.inf
            if slope * rising <= 0.0:  # the gap grows on behind this break: the least value is here
                break
            if (position + step - stop) * rising >= 0.0:  # the slope vanishes before the next break
                position += step
                break
            position = stop
        touching[i] = position
    return touching


@inner(error_model="numpy")
def _slope(gap: Gap, i: int, x: float) -> float:
    """Return the slope on the side to which the gap falls; zero where the gap grows to both sides."""
    left, right = _one_sided_slope(gap, i, x, -1.0), _one_sided_slope(gap, i, x, 1.0)
    if left > 0.0:
        return left
    return right if right < 0.0 else 0.0


@inner(error_model="numpy")
def _one_sided_slope(gap: Gap, i: int, x: float, side: float) -> float:
    """Return the slope of gap `i` at x on the side of larger (`side` > 0) or smaller x."""
    slope: float = gap.slope[i] + gap.curvature[i] * x
    for k in range(gap.offset.shape[1]):
        offset = gap.offset[i, k]
        right = offset >= 0.0
        beyond = (x - offset) if right else (offset - x)  # distance behind the break
        passed = beyond > 0.0 or (beyond == 0.0 and (side > 0.0) == right)
        if passed:
            slope += (gap.jump[i, k] + gap.bend[i, k] * beyond) * (1.0 if right else -1.0)
    return slope


@inner(error_model="numpy")
def _curvature(gap: Gap, i: int, x: float) -> float:
    """Return the curvature of gap `i` at x, which is no break, 1/m."""
    curvature: float = gap.curvature[i]
    for k in range(gap.offset.shape[1]):
        offset = gap.offset[i, k]
        if (x > offset) if offset >= 0.0 else (x < offset):
            curvature += gap.bend[i, k]
    return curvature


@njit(cache=True, error_model="numpy")
def shifted_gap(gap: Gap, shift: FloatArray) -> tuple[FloatArray, Gap]:
    """Return the values (n,) of gaps at `shift` (n,), both m, and the gaps about these points.

    A break between the old and the new origin changes the side that it lies on: its bend then counts in the
    curvature, and acts on the other side with the opposite sign.
    """
    n, breaks = gap.offset.shape
    minimum, slope, curvature = np.empty(n), np.empty(n), np.empty(n)
    position, bend = gap.offset.copy(), gap.bend.copy()
    for i in range(n):
        x = shift[i]
        minimum[i] = gap.slope[i] * x + 0.5 * gap.curvature[i] * x * x
        curvature[i] = gap.curvature[i]
        kink = x == gap.low[i] or x == gap.high[i]
        for k in range(breaks):
            offset = gap.offset[i, k]
            right = offset >= 0.0
            beyond = max((x - offset) if right else (offset - x), 0.0)
            minimum[i] += beyond * (gap.jump[i, k] + 0.5 * gap.bend[i, k] * beyond)
            kink = kink or x == offset
            position[i, k] = offset - x
            if (position[i, k] >= 0.0) != right:
                curvature[i] += gap.bend[i, k]
                bend[i, k] = -gap.bend[i, k]
        # a touching point between ends and breaks has no slope
        slope[i] = _one_sided_slope(gap, i, x, -1.0) if kink else 0.0
    return minimum, Gap(slope, curvature, gap.low - shift, gap.high - shift, position, gap.jump, bend)
