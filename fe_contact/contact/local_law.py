"""Local approach of the contacts as the compiled solver uses it: increasing and concave in the load."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.strip import (
    CURVATURE,
    free_strip,
    half_strip,
    strip_at,
    strip_load,
    strip_middle,
    widest_strip,
)
from fe_contact.types import FloatArray
from host.loops import inner

SMALLEST_STRIP = 1e-4
"""Half length of the contact strip over the reference length below which the law is straight."""

LARGEST_STRIP = 0.66
"""Half length of the contact strip over the reference length above which the law goes on straight."""

_TOLERANCE, _PLAIN_TOLERANCE = 1e-9, 1e-6

_STEPS = 100

_WIDTH, _FREE, MODULUS, MIDDLE, HALF_STRIP, REFERENCE_LENGTH = range(6)
"""Columns of `LocalLaw.strip`."""


class LocalLaw(NamedTuple):
    """The law of m contacts at one position."""

    gap: FloatArray
    """Gaps about the touching points, a `gap_table`. Shape (m, 4 + 3 B)."""
    strip: FloatArray
    """Length of contact line of each in m; half strip in m up to which its gap is a parabola alone; contact
    modulus E* in Pa, less where a tip corner yields; middle and half length of the strip found last, from
    which the next one is searched, m: a half length of zero is none yet; reference length in m, greater near
    free ends. Shape (m, 6).
    """
    length: float
    """Reference length away from free ends, m."""


@inner(error_model="numpy")
def local_law(gap: FloatArray, width: FloatArray, modulus: FloatArray, length: float) -> LocalLaw:
    """Return the law of a table of gaps under which no strip is known yet."""
    strip = np.zeros((width.size, 6))
    for i in range(width.size):
        strip[i, _WIDTH], strip[i, _FREE], strip[i, MODULUS] = width[i], free_strip(gap, i), modulus[i]
        strip[i, REFERENCE_LENGTH] = length
    return LocalLaw(gap, strip, length)


@inner(error_model="numpy")
def approach(law: LocalLaw, i: int, force: float) -> tuple[float, float, bool]:
    """Local approach of contact `i` under `force` in N.

    Returns
    -------
    value, slope : float
        Approach in m and its derivative in m/N; both straight on below zero force.
    beyond : bool
        Whether the strip has outgrown the reference length.
    """
    width, modulus = law.strip[i, _WIDTH], law.strip[i, MODULUS]
    p, (k, minimum, widest) = force / width, _limits(law, i)
    half, rigid = 0.0, 0.0
    if p > 0.0:
        middle, half, rigid = half_strip(
            law.gap, i, p, modulus, law.strip[i, MIDDLE], law.strip[i, HALF_STRIP]
        )
        law.strip[i, MIDDLE], law.strip[i, HALF_STRIP] = middle, half
    if half <= minimum:
        load, rigid = strip_load(law.gap, i, minimum, modulus)
        slope = rigid / load + k * (-math.log(SMALLEST_STRIP) - 0.25)
        return slope * p, slope / width, False
    beyond = half > widest
    if beyond:
        half, (_, rigid) = widest, strip_load(law.gap, i, widest, modulus)
    slope = k * (math.log(law.strip[i, REFERENCE_LENGTH] / half) - 0.25)
    return rigid + slope * p, slope / width, beyond


@inner(error_model="numpy")
def plain_approach(law: LocalLaw, i: int, force: float) -> float:
    """Return the local approach in m of contact `i` under `force` in N, > 0, on a gap that is a parabola."""
    p, (k, minimum, widest) = force / law.strip[i, _WIDTH], _limits(law, i)
    curvature = float(law.gap[i, CURVATURE])
    half = min(max(math.sqrt(2.0 * k * p / curvature), minimum), widest)
    return float(
        0.25 * curvature * half * half + k * p * (math.log(law.strip[i, REFERENCE_LENGTH] / half) - 0.25)
    )


@inner(error_model="numpy")
def width_of(law: LocalLaw, i: int) -> float:
    """Return the length of contact line of contact `i`, m."""
    return float(law.strip[i, _WIDTH])


@inner(error_model="numpy")
def carrying_strip(law: LocalLaw, i: int, force: float) -> tuple[float, float]:
    """Return middle and half length in m of the strip over which contact `i` carries `force` in N, > 0."""
    _, minimum, widest = _limits(law, i)
    p, modulus = force / law.strip[i, _WIDTH], law.strip[i, MODULUS]
    _, half, _ = half_strip(law.gap, i, p, modulus, law.strip[i, MIDDLE], law.strip[i, HALF_STRIP])
    half = min(max(half, minimum), widest)
    return (0.0 if half <= law.strip[i, _FREE] else strip_middle(law.gap, i, half)), half


@inner(error_model="numpy")
def force_at(law: LocalLaw, i: int, value: float) -> tuple[float, float]:
    """Force of contact `i` in N at a local approach in m, and its derivative in N/m; zero where flanks part.

    The inverse of `approach`.
    """
    if value <= 0.0:
        return 0.0, 0.0
    width, free, modulus = law.strip[i, _WIDTH], law.strip[i, _FREE], law.strip[i, MODULUS]
    middle, half, curvature = 0.0, law.strip[i, HALF_STRIP], law.gap[i, CURVATURE]
    if half <= free:
        half = plain_strip(curvature, law.strip[i, REFERENCE_LENGTH], value, half)
    else:
        middle = law.strip[i, MIDDLE]
    if half <= free:
        load, slope = plain_load(curvature, law.strip[i, REFERENCE_LENGTH], modulus, half, value)
    else:
        _, minimum, widest = _limits(law, i)
        guess = max(half, minimum)
        middle, half, first, rigid = strip_at(
            law.gap, i, value, law.strip[i, REFERENCE_LENGTH], middle, guess
        )
        carried = 0.5 * math.pi * modulus * half * first
        if not minimum < half < widest:
            half, middle = half_strip_at(law, i, value, guess), 0.0
            carried, rigid = strip_load(law.gap, i, half, modulus)
        load, slope = _load_on(half, carried, rigid, law.strip[i, REFERENCE_LENGTH], modulus, value)
    law.strip[i, MIDDLE], law.strip[i, HALF_STRIP] = middle, half
    return width * load, width * slope


@inner(error_model="numpy")
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


@inner(error_model="numpy")
def _limits(law: LocalLaw, i: int) -> tuple[float, float, float]:
    """Return k = 2/(pi E*) in 1/Pa, and the least and the largest half strip that the formulas take, m."""
    length = law.strip[i, REFERENCE_LENGTH]
    return 2.0 / (math.pi * law.strip[i, MODULUS]), SMALLEST_STRIP * length, LARGEST_STRIP * length


@inner(error_model="numpy")
def plain_strip(curvature: float, length: float, value: float, guess: float) -> float:
    """Half strip in m of a parabola at an approach in m: y (1/4 - ln(y)/2) = 2 approach/(q l^2), y = (h/l)^2.

    Not above `LARGEST_STRIP` reference lengths. `guess`: half strip to begin with in m, or zero. The last
    step leaves its square.
    """
    scaled = 2.0 * value / (curvature * length * length)
    maximum = LARGEST_STRIP * LARGEST_STRIP
    if scaled >= maximum * (0.25 - 0.5 * math.log(maximum)):
        return LARGEST_STRIP * length
    y = min(guess * guess / (length * length), maximum)
    if y == 0.0:
        y = scaled / (0.25 - 0.4 * math.log(0.5 * scaled))
    for _ in range(_STEPS):
        following = (scaled - 0.5 * y) / (-0.25 - 0.5 * math.log(y))  # Newton's step, written out
        following = min(max(following, 0.1 * y), maximum)
        if abs(following - y) <= _PLAIN_TOLERANCE * y:
            return length * math.sqrt(following)
        y = following
    return length * math.sqrt(y)


@inner(error_model="numpy")
def plain_load(
    curvature: float, length: float, modulus: float, half: float, value: float
) -> tuple[float, float]:
    """Line load in N/m of a parabola at an approach in m, its derivative in N/m^2; `half` is its strip."""
    half = max(half, SMALLEST_STRIP * length)
    rise = 0.25 * curvature * half * half
    return _load_on(half, math.pi * modulus * rise, rise, length, modulus, value)


@inner(error_model="numpy")
def half_strip_at(law: LocalLaw, i: int, value: float, half: float) -> float:
    """Half strip in m at an approach in m, from a guess on; at the limits where it would be beyond them."""
    k, low, high = _limits(law, i)
    high = min(high, widest_strip(law.gap, i))
    if high <= low:
        return float(high)
    half = min(half, high)
    below, above, power = low, high, 2.0
    last_half, last_error = 0.0, math.inf
    for _ in range(_STEPS):
        load, rigid = strip_load(law.gap, i, half, law.strip[i, MODULUS])
        error = math.log(
            (rigid + k * load * (math.log(law.strip[i, REFERENCE_LENGTH] / half) - 0.25)) / value
        )
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
