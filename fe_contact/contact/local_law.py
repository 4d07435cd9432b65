r"""Local approach of the contacts as the compiled solver uses it: increasing and concave in the load.

The formulas are those of `fe_contact.hertz`. Two guards make Newton's method safe, both fixed by the contact
strip alone, so that the law is one and the same for every load and scales with the lengths:

- k p ln(1/p) has infinite slope at zero; below a strip of `SMALLEST_STRIP` patches the law is its secant.
- Where the strip outgrows the patch the slope would fall below zero; from `LARGEST_STRIP` patches on the law
  goes on straight with the slope it has there, and the contact is flagged, because a wider patch is then the
  right answer.

The slope needs no derivative of the edge law. A contact that grows adds the pressure of a rigid punch as wide
as itself, whose mean logarithm is the same at every point of the strip: at an edge or not,

    d(approach)/dp = sum_i k_i [ln(a_i/h) - 1/4],    h = half the length of the strip.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from fe_contact.types import FloatArray

SMALLEST_STRIP = 1e-4
"""Half length of the contact strip over patch half-width below which the law is straight."""
LARGEST_STRIP = 0.66
"""Half length of the contact strip over patch half-width above which the law goes on straight."""


class LocalLaw(NamedTuple):
    """The law of n contacts at one position; arrays of shape (n,).

    Attributes
    ----------
    width, radius : ndarray
        Slice width and relative radius of curvature, m.
    edge_slope : ndarray
        Angle phi between the flanks at a tip edge in rad; NaN = no edge near. On the line of action -t/R,
        with t the arc distance to the edge.
    log_patch : ndarray
        Logarithm of the patch half-width in m, the mean of both gears weighted by their k.
    low, low_slope : ndarray
        Line load in N/m up to which the law is its secant, and the secant's slope in m/(N/m).
    high, high_value : ndarray
        Line load above which the law goes on straight, and the approach in m there.
    modulus, half_plane : float
        Contact modulus E* in Pa; k_1 + k_2 in 1/Pa.
    """

    width: FloatArray
    radius: FloatArray
    edge_slope: FloatArray
    log_patch: FloatArray
    low: FloatArray
    low_slope: FloatArray
    high: FloatArray
    high_value: FloatArray
    modulus: float
    half_plane: float


@njit(cache=True)
def local_law(
    radius: FloatArray,
    edge_slope: FloatArray,
    width: FloatArray,
    patch_1: FloatArray,
    patch_2: FloatArray,
    modulus: float,
    k1: float,
    k2: float,
) -> LocalLaw:
    """Prepare the law of the contacts of one position.

    Parameters
    ----------
    radius, edge_slope, width : ndarray, shape (n,)
        See `LocalLaw`.
    patch_1, patch_2 : ndarray, shape (n,)
        Patch half-widths of both gears, m.
    modulus, k1, k2 : float
        E* in Pa; 2 (1 - nu^2)/(pi E) of the gears in 1/Pa.
    """
    half_plane = k1 + k2
    log_patch = (k1 * np.log(patch_1) + k2 * np.log(patch_2)) / half_plane
    low, low_slope, high, high_value = np.empty((4, radius.size))
    for i in range(radius.size):
        patch = math.exp(log_patch[i])
        low[i] = _line_load(SMALLEST_STRIP * patch, radius[i], edge_slope[i], modulus)
        high[i] = _line_load(LARGEST_STRIP * patch, radius[i], edge_slope[i], modulus)
        value, _ = _unguarded(low[i], radius[i], edge_slope[i], log_patch[i], modulus, half_plane)
        low_slope[i] = value / low[i]
        high_value[i], _ = _unguarded(high[i], radius[i], edge_slope[i], log_patch[i], modulus, half_plane)
    return LocalLaw(
        width, radius, edge_slope, log_patch, low, low_slope, high, high_value, modulus, half_plane
    )


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
        slope = law.half_plane * (-math.log(LARGEST_STRIP) - 0.25)
        return law.high_value[i] + slope * (p - law.high[i]), slope / width, True
    value, slope = _unguarded(
        p, law.radius[i], law.edge_slope[i], law.log_patch[i], law.modulus, law.half_plane
    )
    return value, slope / width, False


@njit(cache=True)
def _line_load(half_length: float, radius: float, edge_slope: float, modulus: float) -> float:
    """Line load whose strip has the given half length."""
    if math.isnan(edge_slope) or half_length <= -edge_slope * radius:
        return math.pi * modulus * half_length * half_length / (4.0 * radius)
    return 0.5 * math.pi * modulus * half_length * (edge_slope + 1.5 * half_length / radius)


@njit(cache=True)
def _edge_length(hertz: float, offset: float) -> float:
    """Contact length from the edge; `offset` is phi R, `hertz` the half-width without an edge."""
    root = math.sqrt(offset * offset + 3.0 * hertz * hertz)
    if offset > 0.0:  # the same without cancellation
        return 2.0 * hertz * hertz / (root + offset)
    return 2.0 / 3.0 * (root - offset)


@njit(cache=True)
def _unguarded(
    p: float, radius: float, edge_slope: float, log_patch: float, modulus: float, half_plane: float
) -> tuple[float, float]:
    """Approach of both bodies in m and its slope in the line load."""
    hertz = math.sqrt(4.0 * p * radius / (math.pi * modulus))
    if math.isnan(edge_slope) or hertz <= -edge_slope * radius:
        logarithm = log_patch - math.log(hertz)
        return half_plane * p * (logarithm + 0.25), half_plane * (logarithm - 0.25)
    length = _edge_length(hertz, edge_slope * radius)
    singular, regular = edge_slope * radius + 0.5 * length, 0.25 * length
    logarithm = log_patch - math.log(0.5 * length)
    value = half_plane * p * (logarithm - 0.25 - (0.5 * regular - singular) / (singular + regular))
    if edge_slope < 0.0:
        value += 0.5 * edge_slope * edge_slope * radius  # rigid gap t^2/(2R) at the edge
    return value, half_plane * (logarithm - 0.25)
