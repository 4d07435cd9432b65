"""Compliance of a gear under the axial part of the force of a helical tooth, in closed form."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.geometry.web_compliance import shear_modulus
from fe_contact.types import FloatArray

BENDING_HARMONICS = 12
"""Highest harmonic of the load around a gear. The bending of the body falls with the third power of the
harmonic.
"""


SAMPLES = 101


@lru_cache(maxsize=64)
def plate_bending(gear: Toothing) -> FloatArray:
    """Return the axial displacement (z,) per axial force, m/N, at the load and 1, 2, ... teeth from it."""
    material, radius = gear.material, gear.root_radius
    rigidity = material.youngs_modulus * gear.face_width**3 / (12.0 * (1.0 - material.poissons_ratio**2))
    ratio, above = gear.seat_radius / radius, abs(gear.reference_radius / radius - 1.0)
    orders = range(BENDING_HARMONICS + 1)
    amplitudes = np.array([_bent(n, ratio, above, material.poissons_ratio) for n in orders])
    return _around(gear, amplitudes * radius**2 / (math.pi * rigidity))


@lru_cache(maxsize=64)
def antiplane_shear(gear: Toothing) -> FloatArray:
    """Return the axial displacement (z,) of the body's edge per line load, m/(N/m), as in `plate_bending`.

    A load is spread over half a pitch, the thickness of its tooth.
    """
    order = np.arange(1, 4 * gear.teeth + 1)
    ratio = gear.seat_radius / gear.root_radius
    inner = min(ratio, 1.0 / ratio) ** (2 * order)
    spread = np.sinc(0.5 * order / gear.teeth) ** 2
    amplitudes = np.concatenate([[abs(math.log(ratio))], (1.0 - inner) / (1.0 + inner) / order * spread])
    return _around(gear, amplitudes / (math.pi * shear_modulus(gear.material)))


def _around(gear: Toothing, amplitudes: FloatArray) -> FloatArray:
    """Return the sum (z,) of the harmonics of a force at tooth 0 at all teeth; harmonic 0 counts half."""
    amplitudes = amplitudes * np.where(np.arange(amplitudes.size) == 0, 0.5, 1.0)
    angle = 2.0 * math.pi * np.arange(gear.teeth) / gear.teeth
    return np.asarray(np.cos(angle[:, None] * np.arange(amplitudes.size)) @ amplitudes)


def _bent(n: int, ratio: float, above: float, poisson: float) -> float:
    """Return the axial displacement at a distance `above` the edge, for harmonic `n` of a unit force there.

    The plate has the radius 1 at its edge, the rigidity 1, and is held at the radius `ratio`: inside, or
    outside as a ring gear is. Its shapes are r^n, r^-n, r^(n + 2), r^(2 - n), with ln r where two coincide.
    """
    powers = [(n, 0), (-n, 0), (n + 2, 0), (2 - n, int(n == 1))] if n else [(0, 0), (0, 1), (2, 0), (2, 1)]
    inner_edge, edge = (np.array([_derivatives(*power, r) for power in powers]).T for r in (ratio, 1.0))
    value, slope, second, third = edge
    outwards = math.copysign(1.0, 1.0 - ratio)
    # radial bending moment and effective shear force of each shape at the edge, by Kirchhoff's plate theory
    moment = second + poisson * (slope - n**2 * value)
    force = third + second - (1 + n**2) * slope + 2 * n**2 * value - (1.0 - poisson) * n**2 * (slope - value)
    factors = np.linalg.solve(
        np.stack([inner_edge[0], inner_edge[1], moment, -outwards * force]), [0.0, 0.0, above, 1.0]
    )
    return float(factors @ (value + outwards * above * slope))


def _derivatives(power: int, logarithm: int, r: float) -> list[float]:
    """Return r^power, times ln r if `logarithm` is 1, and its first three derivatives."""
    derivatives, slope, rest = [], float(logarithm), 1.0 - logarithm
    for k in range(power, power - 4, -1):
        derivatives.append((slope * math.log(r) + rest) * r**k)
        slope, rest = k * slope, k * rest + slope
    return derivatives
