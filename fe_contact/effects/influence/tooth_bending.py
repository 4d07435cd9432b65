"""Compliance of a tooth under a line load, in closed form.

References
----------
C. Weber, K. Banaschek: Formaenderung und Profilruecknahme bei gerad- und schraegverzahnten Raedern, 1953.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from fe_contact.effects.influence.axial_compliance import SAMPLES
from fe_contact.geometry import Toothing, tooth_profile
from fe_contact.types import FloatArray


@dataclass(frozen=True)
class _ToothBending:
    """Compliance of one tooth in the transverse section, by flank coordinate."""

    s: FloatArray
    """Flank coordinates from root to tip, m. Shape (n,)."""
    tooth: FloatArray
    foundation: FloatArray
    """`tooth`, `foundation`: Displacement along the normal per line load, by the tooth itself and by its
    foundation, m/(N/m). Shape (n,) each.
    """
    depth: FloatArray
    """Distance in m along the normal from the flank to the tooth's center line. Shape (n,)."""

    def at(self, values: FloatArray, s: FloatArray) -> FloatArray:
        """Interpolate one of the attributes at flank coordinates `s` of any shape."""
        return np.asarray(np.interp(s, self.s, values))


@lru_cache(maxsize=64)
def tooth_bending(gear: Toothing) -> _ToothBending:
    """Return the compliance of a tooth of `gear` in plane strain, by Weber's and Banaschek's integrals.

    A helical tooth bends in its normal section: there it is thinner, and longer by the same factor.
    """
    profile = tooth_profile(gear)
    s = np.linspace(profile.s_root, profile.s_tip, SAMPLES)
    half, height = profile.flank(s).T
    height = np.abs(height - height[0])
    normal = profile.normal(s)
    narrow = math.cos(gear.helix_angle)
    half = narrow * half
    slope = narrow * gear.sign * normal[:, 1] / np.abs(normal[:, 0])
    cosine = 1.0 / np.sqrt(1.0 + slope**2)
    # where the line of action crosses the center line, above the root
    lever = np.maximum(height - half * slope, 0.0)
    per_modulus = narrow * cosine**2 * (1.0 - gear.material.poissons_ratio**2) / gear.material.youngs_modulus
    root = 2.0 * half[0]
    foundation = 5.2 * (lever / root) ** 2 + lever / root + 1.4 * (1.0 + 0.294 * slope**2)
    tooth = _energy(height, 2.0 * half, lever, slope, gear.material.poissons_ratio)
    return _ToothBending(s, per_modulus * tooth, per_modulus * foundation, half / cosine)


def _energy(
    height: FloatArray, thickness: FloatArray, lever: FloatArray, slope: FloatArray, ratio: float
) -> FloatArray:
    """Return 12 int (h - y)^2/t^3 dy + (2.4/(1 - nu) + tan^2) int dy/t up to the lever h of every load.

    The terms are bending, shear and compression.
    """
    zeroth, first, second = (_up_to(lever, height, height**k / thickness**3) for k in range(3))
    bending = lever**2 * zeroth - 2.0 * lever * first + second
    return np.asarray(
        12.0 * bending + (2.4 / (1.0 - ratio) + slope**2) * _up_to(lever, height, 1.0 / thickness)
    )


def _up_to(lever: FloatArray, height: FloatArray, values: FloatArray) -> FloatArray:
    steps = 0.5 * (values[1:] + values[:-1]) * np.diff(height)
    return np.asarray(np.interp(lever, height, np.concatenate([[0.0], np.cumsum(steps)])))


def half_plane(gear: Toothing) -> float:
    """Return the compliance 2 (1 - nu^2)/(pi E) of a half plane, 1/Pa."""
    return 2.0 * (1.0 - gear.material.poissons_ratio**2) / (math.pi * gear.material.youngs_modulus)
