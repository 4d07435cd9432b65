r"""Local approach of the contacts as the compiled solver uses it: increasing and concave in the load.

The formulas are those of `fe_contact.contact.strip`, beyond the reference length of the problem (see
`fe_contact.contact.problem`). Two guards make Newton's method safe, both fixed by the contact strip alone, so
that the law is one and the same for every load and scales with the lengths:

- k p ln(1/p) has infinite slope at zero; below a strip of `SMALLEST_STRIP` reference lengths the law is its
  secant.
- Where the strip outgrows the reference length the slope would fall below zero; from `LARGEST_STRIP` of them
  on the law goes on straight with the slope it has there, and the contact is flagged: its strip is as wide as
  the tooth or as the slice.

A contact that grows adds the pressure of a rigid punch as wide as itself, whose mean logarithm is the same at
every point of the strip, whatever the gap:

    d(approach)/dp = k [ln(l/h) - 1/4],    h = half the length of the strip, l = the reference length.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from fe_contact.contact.strip import Gap, free_strip, half_strip, strip_load, strip_middle
from fe_contact.types import FloatArray

SMALLEST_STRIP = 1e-4
"""Half length of the contact strip over the reference length below which the law is straight."""
LARGEST_STRIP = 0.66
"""Half length of the contact strip over the reference length above which the law goes on straight."""
_TOLERANCE = 1e-9
_STEPS = 100


class LocalLaw(NamedTuple):
    """The law of n contacts at one position.

    Attributes
    ----------
    width : ndarray, shape (n,)
        Length of contact line of each, m.
    gap : Gap
        About the touching points.
    free : ndarray, shape (n,)
        Half strip in m up to which that is a parabola alone; see `free_strips`.
    length : float
        Reference length, m.
    modulus : ndarray, shape (n,)
        Contact modulus E* in Pa: less where a tip corner yields.
    """

    width: FloatArray
    gap: Gap
    free: FloatArray
    length: float
    modulus: FloatArray


@njit(cache=True, error_model="numpy")
def approach(law: LocalLaw, i: int, force: float) -> tuple[float, float, bool]:
    """Local approach of contact `i` under `force` in N.

    Returns
    -------
    value, slope : float
        Approach in m and its derivative in m/N; both straight on below zero force.
    beyond : bool
        Whether the strip has outgrown the reference length.
    """
    p, width = force / law.width[i], law.width[i]
    k, least, most = _limits(law, i)
    half, rigid = half_strip(law.gap, i, p, law.modulus[i]) if p > 0.0 else (0.0, 0.0)
    if half <= least:
        load, rigid = strip_load(law.gap, i, least, law.modulus[i])
        slope = rigid / load + k * (-math.log(SMALLEST_STRIP) - 0.25)
        return slope * p, slope / width, False
    beyond = half > most
    if beyond:
        half, (_, rigid) = most, strip_load(law.gap, i, most, law.modulus[i])
    slope = k * (math.log(law.length / half) - 0.25)
    return rigid + slope * p, slope / width, beyond


@njit(cache=True, error_model="numpy")
def carrying_strip(law: LocalLaw, i: int, force: float) -> tuple[float, float]:
    """Return middle and half length in m of the strip over which contact `i` carries `force` in N, > 0."""
    _, least, most = _limits(law, i)
    half, _ = half_strip(law.gap, i, force / law.width[i], law.modulus[i])
    half = min(max(half, least), most)
    return (0.0 if half <= law.free[i] else strip_middle(law.gap, i, half)), half


@njit(cache=True, error_model="numpy")
def force_at(law: LocalLaw, i: int, value: float) -> tuple[float, float]:
    """Force of contact `i` in N at a local approach in m, and its derivative in N/m; zero where flanks part.

    The inverse of `approach`.
    """
    if value <= 0.0:
        return 0.0, 0.0
    half = plain_strip(law.gap.curvature[i], law.length, value)
    if half <= law.free[i]:
        load, slope = plain_load(law.gap.curvature[i], law.length, law.modulus[i], half, value)
    else:
        _, least, _ = _limits(law, i)
        half = _strip_at(law, i, value, max(half, least))
        carried, rigid = strip_load(law.gap, i, half, law.modulus[i])
        load, slope = _load_on(half, carried, rigid, law.length, law.modulus[i], value)
    return law.width[i] * load, law.width[i] * slope


@njit(cache=True, error_model="numpy")
def _load_on(
    half: float, carried: float, rigid: float, length: float, modulus: float, value: float
) -> tuple[float, float]:
    """Line load in N/m at an approach in m, and its derivative in N/m^2, from the strip that carries it.

    At a given strip the load follows from the approach, which is stationary in the strip, so that an error of
    the strip enters squared.
    """
    slope = 2.0 / (math.pi * modulus) * (math.log(length / half) - 0.25)
    if half <= SMALLEST_STRIP * length and value < rigid + slope * carried:
        secant = carried / (rigid + slope * carried)
        return secant * value, secant
    return (value - rigid) / slope, 1.0 / slope


@njit(cache=True, error_model="numpy")
def _limits(law: LocalLaw, i: int) -> tuple[float, float, float]:
    """Return k = 2/(pi E*) in 1/Pa, and the least and the largest half strip that the formulas take, m."""
    return 2.0 / (math.pi * law.modulus[i]), SMALLEST_STRIP * law.length, LARGEST_STRIP * law.length


@njit(cache=True, error_model="numpy")
def plain_strip(curvature: float, length: float, value: float) -> float:
    """Half strip in m of a parabola at an approach in m: y (1/4 - ln(y)/2) = 2 approach/(q l^2), y = (h/l)^2.

    Not above `LARGEST_STRIP` reference lengths.
    """
    scaled = 2.0 * value / (curvature * length * length)
    most = LARGEST_STRIP * LARGEST_STRIP
    if scaled >= most * (0.25 - 0.5 * math.log(most)):
        return LARGEST_STRIP * length
    y = scaled / (0.25 - 0.4 * math.log(0.5 * scaled))
    for _ in range(_STEPS):
        following = (scaled - 0.5 * y) / (-0.25 - 0.5 * math.log(y))  # Newton's step, written out
        following = min(max(following, 0.1 * y), most)
        if abs(following - y) <= 1e-9 * y:
            return length * math.sqrt(following)
        y = following
    return length * math.sqrt(y)


@njit(cache=True, error_model="numpy")
def plain_load(
    curvature: float, length: float, modulus: float, half: float, value: float
) -> tuple[float, float]:
    """Line load in N/m of a parabola at an approach in m, its derivative in N/m^2; `half` is its strip."""
    half = max(half, SMALLEST_STRIP * length)
    rise = 0.25 * curvature * half * half
    return _load_on(half, math.pi * modulus * rise, rise, length, modulus, value)


@njit(cache=True, error_model="numpy")
def free_strips(gap: Gap) -> FloatArray:
    """Half strips (n,) in m up to which gaps are parabolas."""
    return np.array([free_strip(gap, i) for i in range(gap.slope.size)])


@njit(cache=True, error_model="numpy")
def _strip_at(law: LocalLaw, i: int, value: float, half: float) -> float:
    """Half strip in m at an approach in m, from a guess on; at the limits where it would be beyond them."""
    k, low, high = _limits(law, i)
    high = min(high, 0.5 * (law.gap.high[i] - law.gap.low[i]))
    if high <= low:
        return float(high)
    half = min(half, high)
    below, above, power = low, high, 2.0
    last_half, last_error = 0.0, math.inf
    for _ in range(_STEPS):
        load, rigid = strip_load(law.gap, i, half, law.modulus[i])
        error = math.log((rigid + k * load * (math.log(law.length / half) - 0.25)) / value)
        if error < 0.0:
            below = half
        else:
            above = half
        if below >= above:
            return half
        if last_half > 0.0:
            power = max((error - last_error) / math.log(half / last_half), 0.3)
        following = half * math.exp(-error / power)
        if not below <= following <= above or abs(error) > 0.5 * abs(last_error):
            following = math.sqrt(below * above) if below < 0.01 * above else 0.5 * (below + above)
            if above == high and error < 0.0:
                following = high
            elif below == low and error > 0.0 and half < 10.0 * low:
                following = low
        if abs(following - half) <= _TOLERANCE * half:
            return following
        last_half, last_error, half = half, error, following
    return half
