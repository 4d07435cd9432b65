r"""Local approach of the contacts as the compiled solver uses it: increasing and concave in the load.

The formulas are those of `fe_contact.contact.strip`. Two guards make Newton's method safe, both fixed by the
contact strip alone, so that the law is one and the same for every load and scales with the lengths:

- k p ln(1/p) has infinite slope at zero; below a strip of `SMALLEST_STRIP` patches the law is its secant.
- Where the strip outgrows the patch the slope would fall below zero; from `LARGEST_STRIP` patches on the law
  goes on straight with the slope it has there, and the contact is flagged, because a wider patch is then the
  right answer.

A contact that grows adds the pressure of a rigid punch as wide as itself, whose mean logarithm is the same at
every point of the strip, whatever the gap:

    d(approach)/dp = sum_i k_i [ln(a_i/h) - 1/4],    h = half the length of the strip.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from fe_contact.contact.strip import Gap, half_strip, strip_load
from fe_contact.types import FloatArray

SMALLEST_STRIP = 1e-4
"""Half length of the contact strip over patch half-width below which the law is straight."""
LARGEST_STRIP = 0.66
"""Half length of the contact strip over patch half-width above which the law goes on straight."""


class LocalLaw(NamedTuple):
    """The law of n contacts at one position; arrays of shape (n,).

    Attributes
    ----------
    width : ndarray
        Slice width, m.
    gap : Gap
        About the touching points.
    log_patch : ndarray
        Logarithm of the patch half-width in m, the mean of both gears weighted by their k.
    low, low_slope : ndarray
        Line load in N/m up to which the law is its secant, and the secant's slope in m/(N/m).
    high, high_value : ndarray
        Line load above which the law goes on straight, and the approach in m there.
    modulus, half_plane : ndarray
        Contact modulus E* in Pa; k_1 + k_2 in 1/Pa.
    """

    width: FloatArray
    gap: Gap
    log_patch: FloatArray
    low: FloatArray
    low_slope: FloatArray
    high: FloatArray
    high_value: FloatArray
    modulus: FloatArray
    half_plane: FloatArray


@njit(cache=True)
def local_law(
    gap: Gap,
    width: FloatArray,
    patch_1: FloatArray,
    patch_2: FloatArray,
    modulus: FloatArray | float,
    k1: FloatArray | float,
    k2: FloatArray | float,
) -> LocalLaw:
    """Prepare the law of the contacts of one position.

    Parameters
    ----------
    gap, width
        See `LocalLaw`.
    patch_1, patch_2 : ndarray, shape (n,)
        Patch half-widths of both gears, m.
    modulus, k1, k2 : float, or ndarray of shape (n,)
        E* in Pa; 2 (1 - nu^2)/(pi E) of the gears in 1/Pa.
    """
    moduli, half_plane = np.zeros(width.size) + modulus, np.zeros(width.size) + k1 + k2
    log_patch = (k1 * np.log(patch_1) + k2 * np.log(patch_2)) / half_plane
    low, low_slope, high, high_value = np.empty((4, width.size))
    for i in range(width.size):
        patch = math.exp(log_patch[i])
        low[i], rigid = strip_load(gap, i, SMALLEST_STRIP * patch, moduli[i])
        low_slope[i] = rigid / low[i] + half_plane[i] * (-math.log(SMALLEST_STRIP) - 0.25)
        if 0.5 * (gap.high[i] - gap.low[i]) <= LARGEST_STRIP * patch:  # the edges keep the strip narrow
            high[i], high_value[i] = math.inf, math.inf
            continue
        high[i], rigid = strip_load(gap, i, LARGEST_STRIP * patch, moduli[i])
        high_value[i] = rigid + half_plane[i] * high[i] * (-math.log(LARGEST_STRIP) - 0.25)
    return LocalLaw(width, gap, log_patch, low, low_slope, high, high_value, moduli, half_plane)


@njit(cache=True)
def approach(law: LocalLaw, i: int, force: float) -> tuple[float, float, bool]:
    """Local approach of contact `i` under `force` in N.

    Returns
    -------
    value, slope : float
        Approach in m and its derivative in m/N; both straight on below zero force.
    beyond : bool
        Whether the strip has outgrown its patch.
    """
    width = law.width[i]
    p = force / width
    if p <= law.low[i]:
        return law.low_slope[i] * p, law.low_slope[i] / width, False
    if p > law.high[i]:
        slope = law.half_plane[i] * (-math.log(LARGEST_STRIP) - 0.25)
        return law.high_value[i] + slope * (p - law.high[i]), slope / width, True
    half, rigid = half_strip(law.gap, i, p, law.modulus[i])
    slope = law.half_plane[i] * (law.log_patch[i] - math.log(half) - 0.25)
    return rigid + slope * p, slope / width, False
