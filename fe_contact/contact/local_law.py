"""Local approach of the contacts as the compiled solver uses it: increasing and concave in the load."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_contact.contact.kernel import kernel
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
"""Half length of the contact strip over the reference length below which approach is linear in load."""

LARGEST_STRIP = 0.66
"""Half length of the contact strip over the reference length above which approach grows linearly with load.
"""

_TOLERANCE, _PLAIN_TOLERANCE = 1e-9, 1e-6
"""Relative steps at which the searches of `half_strip_at` and `plain_strip` end."""

_STEPS = 100
"""Most steps of either search."""

_WIDTH, _FREE, MODULUS, MIDDLE, HALF_STRIP, REFERENCE_LENGTH = range(6)
"""Columns of `LocalLaw.strip`."""


class LocalLaw(NamedTuple):
    """The law of m contacts at one position."""

    gap: FloatArray
    """Gaps about the touching points, a `gap_table`. Shape (m, 4 + 3 B)."""
    strip: FloatArray
    """One row a contact. Shape (m, 6), with the columns

    0. length of its contact line, m,
    1. half strip up to which its gap is a parabola, without break or edge, m,
    2. contact modulus E* in Pa, less where a tip corner yields,
    3. and 4. middle and half length in m of the strip at its last load, from which the next search begins; a
       half length of zero before the first,
    5. reference length in m, greater near free ends.
    """
    length: float
    """Reference length away from free ends, m."""


@inner(error_model="numpy")
def local_law(gap: FloatArray, width: FloatArray, modulus: FloatArray, length: float) -> LocalLaw:
    """Return the law of contacts (m,) from the table of their gaps, before any strip is known."""
    strip = np.zeros((width.size, 6))
    for i in range(width.size):
        strip[i, _WIDTH], strip[i, _FREE], strip[i, MODULUS] = width[i], free_strip(gap, i), modulus[i]
        strip[i, REFERENCE_LENGTH] = length
    return LocalLaw(gap, strip, length)


@kernel
def approach(law: LocalLaw, i: int, force: float) -> tuple[float, float, bool]:
    """Return the local approach of contact `i` under `force` in N.

    Returns
    -------
    value, slope : float
        Approach in m and its derivative in m/N. Below zero force the approach goes on linearly.
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


@kernel
def plain_approach(law: LocalLaw, i: int, force: float) -> float:
    """Return the local approach in m of contact `i` under `force` in N, > 0, on a gap that is a parabola."""
    p, (k, minimum, widest) = force / law.strip[i, _WIDTH], _limits(law, i)
    curvature = float(law.gap[i, CURVATURE])
    half = min(max(math.sqrt(2.0 * k * p / curvature), minimum), widest)
    return float(
        0.25 * curvature * half * half + k * p * (math.log(law.strip[i, REFERENCE_LENGTH] / half) - 0.25)
    )


@kernel
def width_of(law: LocalLaw, i: int) -> float:
    """Return the length of contact line of contact `i`, m."""
    return float(law.strip[i, _WIDTH])


@kernel
def carrying_strip(law: LocalLaw, i: int, force: float) -> tuple[float, float]:
    """Return middle and half length in m of the strip over which contact `i` carries `force` in N, > 0."""
    _, minimum, widest = _limits(law, i)
    p, modulus = force / law.strip[i, _WIDTH], law.strip[i, MODULUS]
    _, half, _ = half_strip(law.gap, i, p, modulus, law.strip[i, MIDDLE], law.strip[i, HALF_STRIP])
    half = min(max(half, minimum), widest)
    return (0.0 if half <= law.strip[i, _FREE] else strip_middle(law.gap, i, half)), half


@kernel
def force_at(law: LocalLaw, i: int, value: float) -> tuple[float, float]:
    """Return the force of contact `i` in N at a local approach in m, and its derivative in N/m.

    It is the inverse of `approach`, and zero where the flanks part.
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


@kernel
def _load_on(
    half: float, carried: float, rigid: float, length: float, modulus: float, value: float
) -> tuple[float, float]:
    """Return the line load in N/m at an approach in m, and its derivative in N/m^2, from its strip.

    The approach is stationary in the strip, so that an error of the strip changes the load by its square.
    """
    slope = 2.0 / (math.pi * modulus) * (math.log(length / half) - 0.25)
    if half <= SMALLEST_STRIP * length and value < rigid + slope * carried:
        secant = carried / (rigid + slope * carried)
        return secant * value, secant
    return (value - rigid) / slope, 1.0 / slope


@kernel
def _limits(law: LocalLaw, i: int) -> tuple[float, float, float]:
    """Return k = 2/(pi E*) in 1/Pa, and the least and the largest half strip that the formulas take, m."""
    length = law.strip[i, REFERENCE_LENGTH]
    return 2.0 / (math.pi * law.strip[i, MODULUS]), SMALLEST_STRIP * length, LARGEST_STRIP * length


@kernel
def plain_strip(curvature: float, length: float, value: float, guess: float) -> float:
    """Return the half strip h in m of a parabola at an approach `value` in m, at most `LARGEST_STRIP` l.

    It solves y (1/4 - ln(y)/2) = 2 approach/(q l^2) for y = (h/l)^2, with the curvature q and the reference
    length l. `guess`: Half strip in m from which Newton's method begins, or zero. The remaining error is of
    the order of the square of the last step.
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


@kernel
def plain_load(
    curvature: float, length: float, modulus: float, half: float, value: float
) -> tuple[float, float]:
    """Return the line load in N/m of a parabola at an approach in m, and its derivative in N/m^2.

    `half`: Half strip at that approach, m.
    """
    half = max(half, SMALLEST_STRIP * length)
    rise = 0.25 * curvature * half * half
    return _load_on(half, math.pi * modulus * rise, rise, length, modulus, value)


@kernel
def half_strip_at(law: LocalLaw, i: int, value: float, half: float) -> float:
    """Return the half strip in m at an approach `value` in m, searched from the guess `half` on.

    Where it would be outside the limits of the law, or longer than the flank, that limit is returned.
    """
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
