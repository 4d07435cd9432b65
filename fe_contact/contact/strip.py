r"""The strip over which two half planes touch whose gap is made of parabolas.

Over the distance x from the touching point the gap is

    g(x) = s x + q x^2/2 + sum_k [a_k d_k + b_k d_k^2/2],    d_k = max(x - x_k, 0)  (x_k >= 0)
                                                             d_k = max(x_k - x, 0)  (x_k < 0),

between the edges `low` <= 0 <= `high`, where the bodies end: a relief begins at x_k with the slope a_k or the
curvature b_k, a tip edge is an end. On the strip c - h .. c + h, with x = c + h sin(t) and means over
-pi/2 < t < pi/2, the half-plane equation gives [1]_

    mean(g') = 0                                   pressure vanishes at both ends,
    p = (pi E*/2) h [mean(g' sin t) + |mean(g')|]  load; a mean other than zero belongs to an end at an edge,
                                                   where the pressure is singular,
    approach = mean(g) + k p [ln(a/h) - 1/4]       beyond a patch of half-width a; k = 2/(pi E*).

A strip between two edges is a flat punch. The approach is stationary in c and h, so that its slope in the
load is k [ln(a/h) - 1/4]. Without breaks and edges this is Hertz; with an edge alone it is the law of
`fe_contact.hertz.edge_contact`. `docs/theory/hertz.md` has the derivation.

References
----------
.. [1] K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, sections 2.7 and 5.5.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from fe_contact.types import FloatArray, IntArray

_TOLERANCE = 1e-9
"""Of strip and middle over the strip; the approach is stationary in both."""
_STEPS = 100
_BLUNTEST = 0.05
"""Least cosine at a break in derivatives: they are infinite where a break is at the end of the strip."""


class Gap(NamedTuple):
    """Gaps of n contacts about their touching points; x > 0 points one way along the flank.

    Attributes
    ----------
    slope, curvature : ndarray, shape (n,)
        s and q; 1 and 1/m. The slope is zero except where flanks touch at an edge or a break.
    low, high : ndarray, shape (n,)
        Where the bodies end, m; infinite = nowhere near.
    place, jump, bend : ndarray, shape (n, B)
        x_k in m, a_k and b_k in 1/m; a break at infinity is none.
    """

    slope: FloatArray
    curvature: FloatArray
    low: FloatArray
    high: FloatArray
    place: FloatArray
    jump: FloatArray
    bend: FloatArray


@njit(cache=True, error_model="numpy")
def gap_at(about: Gap, position: int) -> Gap:
    """Return the gaps (n,) at one of the positions of arrays (P, n) and (P, n, B)."""
    return Gap(
        about.slope[position],
        about.curvature[position],
        about.low[position],
        about.high[position],
        about.place[position],
        about.jump[position],
        about.bend[position],
    )


@njit(cache=True, error_model="numpy")
def some_gaps(gap: Gap, keep: IntArray) -> Gap:
    """Return some of n gaps."""
    return Gap(
        gap.slope[keep],
        gap.curvature[keep],
        gap.low[keep],
        gap.high[keep],
        gap.place[keep],
        gap.jump[keep],
        gap.bend[keep],
    )


@njit(cache=True, error_model="numpy")
def half_strip(gap: Gap, i: int, line_load: float, modulus: float) -> tuple[float, float]:
    """Return half the length of the strip in m and the mean gap over it in m, from the touching point's on.

    Parameters
    ----------
    gap : Gap
    i : int
        Of the contact.
    line_load : float
        p in N/m, > 0.
    modulus : float
        Contact modulus E* in Pa.
    """
    hertz = math.sqrt(4.0 * line_load / (math.pi * modulus * gap.curvature[i]))
    if gap.slope[i] == 0.0 and is_plain(gap, i, hertz):
        return hertz, 0.25 * gap.curvature[i] * hertz * hertz
    widest = 0.5 * (gap.high[i] - gap.low[i])
    below, above = 0.0, math.inf
    half, power = min(hertz, widest), 2.0
    last_half, last_error, rigid = 0.0, math.inf, 0.0
    for _ in range(_STEPS):
        load, rigid = strip_load(gap, i, half, modulus)
        error = math.log(load / line_load)
        if error < 0.0:
            if half >= widest:
                break  # a flat punch between two edges
            below = half
        else:
            above = half
        if last_half > 0.0:
            power = max((error - last_error) / math.log(half / last_half), 0.5)
        following = half * math.exp(-error / power)
        if not below < following < above or abs(error) > 0.5 * abs(last_error):
            following = 0.5 * (below + above) if above < math.inf else 2.0 * half
        following = min(following, widest)
        if abs(following - half) <= _TOLERANCE * half:
            break
        last_half, last_error, half = half, error, following
    return half, rigid


@njit(cache=True, error_model="numpy")
def strip_load(gap: Gap, i: int, half: float, modulus: float) -> tuple[float, float]:
    """Return the line load in N/m under a strip of this half length, and the mean gap over it in m."""
    if gap.slope[i] == 0.0 and is_plain(gap, i, half):
        rise = 0.25 * gap.curvature[i] * half * half
        return math.pi * modulus * rise, rise
    centre = _centre(gap, i, half)
    slope, first, mean, _ = _means(gap, i, centre, half)
    return 0.5 * math.pi * modulus * half * (first + abs(slope)), mean


@njit(cache=True, error_model="numpy")
def is_plain(gap: Gap, i: int, half: float) -> bool:
    """Whether neither an edge nor a break is within `half` of the touching point."""
    if -gap.low[i] < half or gap.high[i] < half:
        return False
    nearest = math.inf
    for k in range(gap.place.shape[1]):
        nearest = min(nearest, abs(gap.place[i, k]))
    return nearest >= half


@njit(cache=True, error_model="numpy")
def _centre(gap: Gap, i: int, half: float) -> float:
    """Return the middle of the strip: where pressure vanishes at both ends, or one end is at an edge."""
    low: float = max(-half, gap.low[i] + half)
    high: float = min(half, gap.high[i] - half)
    if low >= high:
        return 0.5 * (low + high)
    centre, before = min(max(0.0, low), high), math.inf
    for _ in range(_STEPS):
        slope, _, _, bend = _means(gap, i, centre, half)
        if slope > 0.0:
            high = centre
        else:
            low = centre
        following = centre - slope / bend
        if not low < following < high:
            end = high if slope < 0.0 else low
            at_end = _means(gap, i, end, half)[0]
            if slope * at_end >= 0.0:
                return end
            following = 0.5 * (low + high)
        elif abs(slope) > 0.5 * before:  # Newton runs back and forth over the end of a break
            following = 0.5 * (low + high)
        if abs(following - centre) <= _TOLERANCE * half:
            return following
        centre, before = following, abs(slope)
    return centre


@njit(cache=True, error_model="numpy")
def _means(gap: Gap, i: int, centre: float, half: float) -> tuple[float, float, float, float]:
    """Return the means of g', g' sin t, g and g'' over the angle t of the strip."""
    s, q = float(gap.slope[i]), float(gap.curvature[i])
    slope = s + q * centre
    first = 0.5 * q * half
    mean = s * centre + 0.5 * q * (centre * centre + 0.5 * half * half)
    bend = q
    for k in range(gap.place.shape[1]):
        side = 1.0 if gap.place[i, k] >= 0.0 else -1.0
        beyond = side * (gap.place[i, k] - centre)  # from the middle to the break
        if beyond >= half:
            continue
        a, b = gap.jump[i, k], gap.bend[i, k]
        sine = max(beyond / half, -1.0)
        cosine = math.sqrt(1.0 - sine * sine)
        angle = 0.5 * math.pi - math.asin(sine)
        ramp = half * cosine - beyond * angle  # integrals over the angle of d, d sin t, d^2
        tilted = 0.5 * half * (angle + sine * cosine) - beyond * cosine
        square = half * tilted - beyond * ramp
        slope += side * (a * angle + b * ramp) / math.pi
        first += (a * cosine + b * tilted) / math.pi
        mean += (a * ramp + 0.5 * b * square) / math.pi
        bend += b * angle / math.pi
        bend += a / (math.pi * half * max(cosine, _BLUNTEST))
    return slope, first, mean, bend


@njit(cache=True, error_model="numpy")
def rounded(gap: Gap, least: FloatArray) -> Gap:
    """Return gaps whose curvature (n,) is nowhere below `least` in 1/m."""
    curvature, bend = np.maximum(gap.curvature, least), gap.bend.copy()
    for i in range(curvature.size):
        order = np.argsort(np.abs(gap.place[i]))
        left, right = curvature[i], curvature[i]
        for k in order:  # away from the touching point to either side
            here = right if gap.place[i, k] >= 0.0 else left
            bend[i, k] = max(bend[i, k], least[i] - here)
            if gap.place[i, k] >= 0.0:
                right += bend[i, k]
            else:
                left += bend[i, k]
    return Gap(gap.slope, curvature, gap.low, gap.high, gap.place, gap.jump, bend)


@njit(cache=True, error_model="numpy")
def touching_places(gap: Gap, low: FloatArray, high: FloatArray) -> FloatArray:
    """Return where gaps that grow to both sides are least between `low` and `high` (n,), m."""
    found = np.empty(gap.slope.size)
    for i in range(found.size):
        place = 0.0
        rising = _slope(gap, i, place)
        end = low[i] if rising > 0.0 else high[i]
        # the slope is made of straight pieces: from break to break until it changes its sign
        while rising != 0.0 and place != end:
            stop = end
            for k in range(gap.place.shape[1]):
                at = gap.place[i, k]
                if (place - at) * rising > 0.0 and (at - stop) * rising > 0.0:
                    stop = at
            curvature = _curvature(gap, i, 0.5 * (place + stop))
            here = _slope_beside(gap, i, place, -rising)
            step = -here / curvature if curvature > 0.0 else -rising * math.inf
            if here * rising <= 0.0:
                break
            if (place + step - stop) * rising >= 0.0:
                place += step
                break
            place = stop
        found[i] = place
    return found


@njit(cache=True, error_model="numpy")
def _slope(gap: Gap, i: int, x: float) -> float:
    """Return the slope of the gap, the side to which it falls if there is one; zero at a break that holds."""
    left, right = _slope_beside(gap, i, x, -1.0), _slope_beside(gap, i, x, 1.0)
    if left > 0.0:
        return left
    return right if right < 0.0 else 0.0


@njit(cache=True, error_model="numpy")
def _slope_beside(gap: Gap, i: int, x: float, side: float) -> float:
    """Return the slope of the gap just to one side of x."""
    slope: float = gap.slope[i] + gap.curvature[i] * x
    for k in range(gap.place.shape[1]):
        at = gap.place[i, k]
        right = at >= 0.0
        beyond = (x - at) if right else (at - x)
        inside = beyond > 0.0 or (beyond == 0.0 and (side > 0.0) == right)
        if inside:
            slope += (gap.jump[i, k] + gap.bend[i, k] * beyond) * (1.0 if right else -1.0)
    return slope


@njit(cache=True, error_model="numpy")
def _curvature(gap: Gap, i: int, x: float) -> float:
    """Return the curvature of the gap between breaks."""
    curvature: float = gap.curvature[i]
    for k in range(gap.place.shape[1]):
        at = gap.place[i, k]
        if (x > at) if at >= 0.0 else (x < at):
            curvature += gap.bend[i, k]
    return curvature


@njit(cache=True, error_model="numpy")
def moved_gap(gap: Gap, shift: FloatArray) -> tuple[FloatArray, Gap]:
    """Return the gap (n,) in m at `shift` (n,) in m, and that about there."""
    n, breaks = gap.place.shape
    least, slope, curvature = np.empty(n), np.empty(n), np.empty(n)
    place, bend = gap.place.copy(), gap.bend.copy()
    for i in range(n):
        x = shift[i]
        least[i] = gap.slope[i] * x + 0.5 * gap.curvature[i] * x * x
        curvature[i] = gap.curvature[i]
        held = x == gap.low[i] or x == gap.high[i]
        for k in range(breaks):
            at = gap.place[i, k]
            right = at >= 0.0
            beyond = max((x - at) if right else (at - x), 0.0)
            least[i] += beyond * (gap.jump[i, k] + 0.5 * gap.bend[i, k] * beyond)
            held = held or x == at
            place[i, k] = at - x
            if (place[i, k] >= 0.0) != right:
                curvature[i] += gap.bend[i, k]
                bend[i, k] = -gap.bend[i, k]
        slope[i] = _slope_beside(gap, i, x, -1.0) if held else 0.0
    return least, Gap(slope, curvature, gap.low - shift, gap.high - shift, place, gap.jump, bend)
