r"""The strip over which two half planes touch whose gap is made of parabolas.

Over the distance x from the touching point the gap is

    g(x) = s x + q x^2/2 + sum_k [a_k d_k + b_k d_k^2/2],    d_k = max(x - x_k, 0)  (x_k >= 0)
                                                             d_k = max(x_k - x, 0)  (x_k < 0),

between the edges `low` <= 0 <= `high`, where the bodies end: a relief begins at x_k with the slope a_k or the
curvature b_k, a tip edge is an end. On the strip c - h .. c + h, with x = c + h sin(t) and means over
-pi/2 < t < pi/2, the half-plane equation gives [1]_

    mean(g') = 0                                   pressure vanishes at both ends,
    p = (pi E*/2) h [mean(g' sin t) + |mean(g')|]  load; mean(g') differs from zero only where the strip ends
                                                   at an edge, and the pressure is singular there,
    approach = mean(g) + k p [ln(a/h) - 1/4]       beyond a patch of half-width a; k = 2/(pi E*).

A strip between two edges is a flat punch. The approach is stationary in c and h, so that its slope in the
load is k [ln(a/h) - 1/4]. Without breaks and edges this is Hertz. `docs/theory/hertz.md` has the
derivation, and the closed form with an edge alone.

References
----------
.. [1] K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, sections 2.7 and 5.5.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.kernel import kernel
from fe_contact.types import FloatArray
from host.loops import njit

_TOLERANCE = 1e-9
"""Error of the strip's half length and of its middle, over the half length, at which an iteration ends.

The approach is stationary in both, so that its own error is of the order of the square.
"""
_STEPS = 100
"""Most steps of a search between bounds."""
_NEWTON_STEPS, _EDGE_STEPS = 8, 12
"""Most steps of Newton's method for half length and middle together, without and with an edge."""
_NEWTON_TOLERANCE = 1e-8
"""Last step of Newton's method over the half length. The error that is left is of the order of its square."""
_TILTED = 0.1
"""Motion of the strip's middle for which `rolling_radii` chooses its tilts, over half the strip."""
_NEAR = 1e-6
"""Step along the flank for numerical derivatives, over half a strip."""
_BLUNTEST = 0.05
"""Least value of cos t at a break that derivatives divide by.

Without it they would be infinite where a break is at the end of the strip.
"""

_SLOPE, CURVATURE, _LOW, _HIGH, _BREAKS = range(5)
_OFFSET, _JUMP, _BEND, _WIDTH = range(4)
"""Columns of a `gap_table`, and of each break in it from column `_BREAKS` on.

Compiled loops pass on one array faster than the seven of a `Gap`.
"""


class Gap(NamedTuple):
    """Gaps of n contacts about their touching points; x > 0 points one way along the flank."""

    slope: FloatArray
    curvature: FloatArray
    """`slope`, `curvature`: s and q; 1 and 1/m. The slope is zero off edges and breaks. Shape (n,) each."""
    low: FloatArray
    high: FloatArray
    """`low`, `high`: Ends of the bodies, m; infinite where there is no end. Shape (n,) each."""
    offset: FloatArray
    jump: FloatArray
    bend: FloatArray
    """`offset`, `jump`, `bend`: x_k in m, a_k and b_k in 1/m; a break at infinity is none. Shape (n, B) each.
    """


def with_breaks(gap: Gap, count: int) -> Gap:
    """Return gaps (...,) with at least `count` breaks; added ones are at infinity."""
    missing_breaks = max(count - gap.offset.shape[-1], 0)
    width = [(0, 0)] * (gap.offset.ndim - 1) + [(0, missing_breaks)]
    offset = np.pad(gap.offset, width, constant_values=np.inf)
    return gap._replace(offset=offset, jump=np.pad(gap.jump, width), bend=np.pad(gap.bend, width))


@njit(cache=True, error_model="numpy")
def rounded(gap: Gap, minimum: FloatArray) -> Gap:
    """Return gaps whose curvature (n,) is nowhere below `minimum` in 1/m."""
    curvature, bend = np.maximum(gap.curvature, minimum), gap.bend.copy()
    for i in range(curvature.size):
        flattest = curvature[i]
        for k in range(bend.shape[1]):
            flattest += min(bend[i, k], 0.0)
        if flattest >= minimum[i]:
            continue
        order = np.argsort(np.abs(gap.offset[i]))
        left, right = curvature[i], curvature[i]
        for k in order:  # away from the touching point to either side
            side_curvature = right if gap.offset[i, k] >= 0.0 else left
            bend[i, k] = max(bend[i, k], minimum[i] - side_curvature)
            if gap.offset[i, k] >= 0.0:
                right += bend[i, k]
            else:
                left += bend[i, k]
    return Gap(gap.slope, curvature, gap.low, gap.high, gap.offset, gap.jump, bend)


def gap_table(gap: Gap) -> FloatArray:
    """Return gaps (..., n) row by row, (..., n, 4 + 3 B): slope, curvature, ends, then each break."""
    table = np.empty((*gap.slope.shape, _BREAKS + _WIDTH * gap.offset.shape[-1]))
    for column, values in enumerate((gap.slope, gap.curvature, gap.low, gap.high)):
        table[..., column] = values
    for column, values in enumerate((gap.offset, gap.jump, gap.bend)):
        table[..., _BREAKS + column :: _WIDTH] = values
    return table


@kernel
def free_strip(gap: FloatArray, i: int) -> float:
    """Return the half strip in m up to which a gap is a parabola, without edge or break; 0 on a slope."""
    if gap[i, _SLOPE] != 0.0:
        return 0.0
    free: float = min(-gap[i, _LOW], gap[i, _HIGH])
    for k in range(_BREAKS, gap.shape[1], _WIDTH):
        free = min(free, abs(gap[i, k]))
    return free


@kernel
def widest_strip(gap: FloatArray, i: int) -> float:
    """Return half the distance from edge to edge, m: no strip is longer."""
    return 0.5 * float(gap[i, _HIGH] - gap[i, _LOW])


@kernel
def half_strip(
    gap: FloatArray, i: int, line_load: float, modulus: float, center: float, guess: float
) -> tuple[float, float, float]:
    """Return middle and half the length of the strip under a load, and the mean gap over it, all in m.

    The middle counts from the touching point. Where Newton's method fails and the half length is searched
    between bounds, the middle returned is `center` unchanged: a mere guess for the next search.

    Parameters
    ----------
    gap : ndarray
        A `gap_table`.
    i : int
        Row of the contact in it.
    line_load : float
        p in N/m, > 0.
    modulus : float
        Contact modulus E* in Pa.
    center, guess : float
        Middle and half length in m of a strip from which Newton's method begins; where `guess` is zero it
        begins with the half length of Hertz.
    """
    hertz = math.sqrt(4.0 * line_load / (math.pi * modulus * gap[i, CURVATURE]))
    if hertz <= free_strip(gap, i):
        return 0.0, hertz, 0.25 * gap[i, CURVATURE] * hertz * hertz
    scaled = 2.0 * line_load / (math.pi * modulus)
    newton_center, half, _, rigid = strip_at(gap, i, scaled, 0.0, center, guess if guess > 0.0 else hertz)
    if half > 0.0:
        return newton_center, half, rigid
    widest = widest_strip(gap, i)
    below, above = 0.0, math.inf
    half, power = min(hertz, widest), 2.0
    last_half, last_error = 0.0, math.inf
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
    return center, half, rigid


@kernel
def strip_load(gap: FloatArray, i: int, half: float, modulus: float) -> tuple[float, float]:
    """Return the line load in N/m under a strip of this half length, and the mean gap over it in m."""
    if half <= free_strip(gap, i):
        rise = 0.25 * gap[i, CURVATURE] * half * half
        return math.pi * modulus * rise, rise
    center = strip_middle(gap, i, half)
    slope, first, mean, _, _, _ = _means(gap, i, center, half)
    if gap[i, _LOW] + half < center < gap[i, _HIGH] - half:
        # the mean of g' is not exactly zero only because the middle is inexact
        first -= slope * _tilting(gap, i, center, half)
    else:
        first += abs(slope)
    return 0.5 * math.pi * modulus * half * first, mean


@kernel
def _tilting(gap: FloatArray, i: int, center: float, half: float) -> float:
    """Return how the mean of g' sin t changes with that of g' as the middle moves.

    Where a break is near the end of the strip both change with the root of their distance, so that no middle
    is exact enough for either of them. One is still a linear function of the other.
    """
    by_slope, by_first = float(gap[i, CURVATURE]), 0.0
    for k in range(_BREAKS, gap.shape[1], _WIDTH):
        side = 1.0 if gap[i, k + _OFFSET] >= 0.0 else -1.0
        sine = side * (gap[i, k + _OFFSET] - center) / half
        if sine < 1.0 + 4.0 * _TOLERANCE:
            # a break at the end of the strip counts, on whichever side rounding puts it
            sine = min(max(sine, -1.0), 1.0)
            cosine = max(math.sqrt(1.0 - sine * sine), 1e-12)
            angle = 0.5 * math.pi - math.asin(sine)
            by_slope += (gap[i, k + _BEND] * angle + gap[i, k + _JUMP] / (half * cosine)) / math.pi
            by_first += (
                side * (gap[i, k + _BEND] * cosine + gap[i, k + _JUMP] * sine / (half * cosine)) / math.pi
            )
    return by_first / by_slope


@kernel
def strip_middle(gap: FloatArray, i: int, half: float) -> float:
    """Return the middle of a strip in m: where pressure vanishes at both ends, or one end is at an edge."""
    low: float = max(-half, gap[i, _LOW] + half)
    high: float = min(half, gap[i, _HIGH] - half)
    if low >= high:
        return 0.5 * (low + high)
    center, before = min(max(0.0, low), high), math.inf
    for _ in range(_STEPS):
        slope, _, _, bend, _, _ = _means(gap, i, center, half)
        if slope > 0.0:
            high = center
        else:
            low = center
        following = center - slope / bend
        if not low < following < high:
            end = high if slope < 0.0 else low
            at_end = _means(gap, i, end, half)[0]
            if slope * at_end >= 0.0:
                return end
            following = 0.5 * (low + high)
        elif abs(slope) > 0.5 * before:  # Newton's method jumps back and forth across a break
            following = 0.5 * (low + high)
        if abs(following - center) <= _TOLERANCE * half:
            return following
        center, before = following, abs(slope)
    return center


class StripMiddles(NamedTuple):
    """Middles of strips of given lengths, and the gap about them; arrays over contacts."""

    middle: FloatArray
    half: FloatArray
    """`middle`, `half`: Distance of the strip's middle from the touching point, and half its length, m."""
    slope: FloatArray
    curvature: FloatArray
    """`slope`, `curvature`: Means of g' and g'' over the strip; 1 and 1/m. The slope is zero off edges."""


@njit(cache=True, error_model="numpy")
def strip_middles(gap: FloatArray, half: FloatArray) -> StripMiddles:
    """Return the middles of strips of half lengths (n,) in m, at most from edge to edge."""
    zero, half = np.zeros(half.size), np.minimum(half, 0.5 * (gap[:, _HIGH] - gap[:, _LOW]))
    middles = StripMiddles(zero, half, zero.copy(), gap[:, CURVATURE].copy())
    for i in range(half.size):
        h = half[i]
        if h > free_strip(gap, i):
            center = strip_middle(gap, i, h)
            inside = gap[i, _LOW] + h < center < gap[i, _HIGH] - h
            middles.middle[i], middles.slope[i] = center, 0.0 if inside else _means(gap, i, center, h)[0]
            if h > 0.0:
                near = _NEAR * h
                rise = _means(gap, i, center + near, h)[0] - _means(gap, i, center - near, h)[0]
                middles.curvature[i] = 0.5 * rise / near
    return middles


@njit(cache=True, error_model="numpy")
def rolling_radii(gap: FloatArray, half: FloatArray) -> FloatArray:
    """Return how far the middles of strips of half lengths (n,) in m move back per slope added to the gap, m.

    It is the mean over a slope added and the same one taken away: those that move the middle by `_TILTED`
    of the half length on plain flanks. The result (n,) is zero where the strip stays at an edge.
    """
    half, radius = np.minimum(half, 0.5 * (gap[:, _HIGH] - gap[:, _LOW])), 1.0 / gap[:, CURVATURE]
    tilt, back, forth = _TILTED * half * gap[:, CURVATURE], gap.copy(), gap.copy()
    back[:, _SLOPE] += tilt
    forth[:, _SLOPE] -= tilt
    for i in range(half.size):
        h = half[i]
        if (1.0 + _TILTED) * h > free_strip(gap, i) and h > 0.0:
            radius[i] = 0.5 * (strip_middle(forth, i, h) - strip_middle(back, i, h)) / tilt[i]
    return radius


@kernel
def strip_at(
    gap: FloatArray, i: int, value: float, length: float, center: float, half: float
) -> tuple[float, float, float, float]:
    """Return the strip of an approach or a load, by Newton's method from a guess on.

    Parameters
    ----------
    gap : ndarray
        A `gap_table`.
    i : int
        Row of the contact in it.
    value : float
        The approach, m; or, where `length` is zero, 2 p/(pi E*), m.
    length : float
        Reference length, m.
    center, half : float
        Guess of the middle and of half the strip, m.

    Returns
    -------
    center, half, first, mean : float
        Middle and half strip in m; means over it of g' sin t, with |mean(g')| added where the strip ends at
        an edge, and of g in m. Four zeros where the method does not converge.
    """
    for _ in range(_NEWTON_STEPS):
        if not half > 0.0:
            break
        if center <= gap[i, _LOW] + half:
            return _strip_at_edge(gap, i, value, length, half, 1.0)
        if center >= gap[i, _HIGH] - half:
            return _strip_at_edge(gap, i, value, length, half, -1.0)
        slope, first, mean, bend, tilt, bulge = _means(gap, i, center, half)
        law, residual, by_center = 1.0, half * first - value, half * tilt
        if length > 0.0:
            law = math.log(length / half) - 0.25
            residual, by_center = mean + half * first * law - value, slope + half * tilt * law
        by_half = law * (first + half * bulge)
        determinant = bend * by_half - tilt * by_center
        center_step = (tilt * residual - by_half * slope) / determinant
        half_step = (by_center * slope - bend * residual) / determinant
        center += center_step
        half += half_step
        if abs(center_step) + abs(half_step) <= _NEWTON_TOLERANCE * half:
            mean += slope * center_step + first * half_step
            return center, half, first + tilt * center_step + bulge * half_step, mean
    return 0.0, 0.0, 0.0, 0.0


@kernel
def _strip_at_edge(
    gap: FloatArray, i: int, value: float, length: float, half: float, side: float
) -> tuple[float, float, float, float]:
    """Return the values of `strip_at` for a strip from the lower edge on (`side` 1) or to the upper edge.

    The sign of mean(g') tells that the strip would go on past the edge; the pressure there is singular.
    """
    widest = widest_strip(gap, i)
    for _ in range(_EDGE_STEPS):
        if not half < widest:
            break
        center = gap[i, _LOW] + half if side > 0.0 else gap[i, _HIGH] - half
        slope, first, mean, bend, tilt, bulge = _means(gap, i, center, half)
        law, first, growth = 1.0, first + side * slope, bend + 2.0 * side * tilt + bulge
        residual = half * first - value
        if length > 0.0:
            law = math.log(length / half) - 0.25
            residual = mean + half * first * law - value
        step = -residual / (law * (first + half * growth))
        if abs(step) <= _NEWTON_TOLERANCE * half and side * slope >= 0.0:
            return center + side * step, half + step, first + growth * step, mean + first * step
        half = max(half + step, 0.1 * half)
    return 0.0, 0.0, 0.0, 0.0


@kernel
def past_break(from_middle: float, half: float) -> tuple[float, float, float, float, float]:
    """Return integrals over the angle t of a strip, from a break to the strip's end beyond it.

    Parameters
    ----------
    from_middle : float
        Distance from the middle of the strip to the break, m; negative where the middle is past the break,
        and less than `half`.
    half : float
        Half length of the strip, m.

    Returns
    -------
    angle, cosine : float
        Range of t past the break, and cos t at the break.
    ramp, tilted, square : float
        Integrals of d, d sin t and d^2, where d is the distance past the break.
    """
    sine = max(from_middle / half, -1.0)
    cosine = math.sqrt(1.0 - sine * sine)
    angle = 0.5 * math.pi - math.asin(sine)
    ramp = half * cosine - from_middle * angle
    tilted = 0.5 * half * (angle + sine * cosine) - from_middle * cosine
    return angle, cosine, ramp, tilted, half * tilted - from_middle * ramp


@njit(cache=True, error_model="numpy")
def means_past_break(
    from_middle: FloatArray, half: FloatArray, jump: FloatArray, bend: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the means over strips (k,) of jump d + bend d^2/2 in m, and of its derivative in d.

    d is the distance past a break that lies `from_middle` in m from the middle of each strip, and zero before
    the break. `half`: Half lengths of the strips, m.
    """
    height, slope = np.zeros((2, from_middle.size))
    for i in range(from_middle.size):
        if from_middle[i] < half[i]:
            angle, _, ramp, _, square = past_break(from_middle[i], half[i])
            height[i] = (jump[i] * ramp + 0.5 * bend[i] * square) / math.pi
            slope[i] = (jump[i] * angle + bend[i] * ramp) / math.pi
    return height, slope


@kernel
def _means(
    gap: FloatArray, i: int, center: float, half: float
) -> tuple[float, float, float, float, float, float]:
    """Return the means of g', g' sin t, g, g'', g'' sin t and g'' sin^2 t over the angle t of the strip."""
    s, q = float(gap[i, _SLOPE]), float(gap[i, CURVATURE])
    slope = s + q * center
    first = 0.5 * q * half
    mean = s * center + 0.5 * q * (center * center + 0.5 * half * half)
    bend, tilt, bulge = q, 0.0, 0.5 * q
    for k in range(_BREAKS, gap.shape[1], _WIDTH):
        side = 1.0 if gap[i, k + _OFFSET] >= 0.0 else -1.0
        from_middle = side * (gap[i, k + _OFFSET] - center)
        if from_middle >= half:
            continue
        a, b = gap[i, k + _JUMP], gap[i, k + _BEND]
        angle, cosine, ramp, tilted, square = past_break(from_middle, half)
        slope += side * (a * angle + b * ramp) / math.pi
        first += (a * cosine + b * tilted) / math.pi
        mean += (a * ramp + 0.5 * b * square) / math.pi
        sine, blunt = max(from_middle / half, -1.0), a / (half * max(cosine, _BLUNTEST))
        bend += (b * angle + blunt) / math.pi
        tilt += side * (b * cosine + blunt * sine) / math.pi
        bulge += (0.5 * b * (angle + sine * cosine) + blunt * sine * sine) / math.pi
    return slope, first, mean, bend, tilt, bulge
