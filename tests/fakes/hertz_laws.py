"""Closed forms of contact that the compiled laws are held against: tip edges, patches, cylinders.

References
----------
.. [1] K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, sections 5.5 and 5.6.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.hertz import contact_modulus, half_width, relative_radius
from fe_contact.material import Material
from fe_contact.types import FloatArray


def edge_contact_length(
    line_load: ArrayLike, slope: ArrayLike, radius: ArrayLike, modulus: float
) -> FloatArray:
    """Contact length c in m from the edge; the flanks open away from it at `slope` rad."""
    p, phi, r = (np.asarray(v, dtype=float) for v in (line_load, slope, radius))
    root = np.sqrt(phi**2 + 12.0 * p / (math.pi * modulus * r)) + np.abs(phi)
    opening = phi > 0.0  # there root - phi would cancel
    flat = 8.0 * p / (math.pi * modulus * np.where(opening, root, 1.0))
    return np.asarray(np.where(opening, flat, 2.0 / 3.0 * r * root), dtype=float)


def edge_half_width(length: ArrayLike, slope: ArrayLike, radius: ArrayLike) -> FloatArray:
    """Equivalent Hertz half-width b_eff in m of an edge contact of length c > 0.

    ln b_eff = ln(c/2) + 1/2 + w, w the mean of the two parts of the pressure weighted by their resultants.
    """
    c, phi, r = (np.asarray(v, dtype=float) for v in (length, slope, radius))
    singular, regular = phi * r + 0.5 * c, 0.25 * c  # resultants of the two parts, up to a factor
    w = (-singular + 0.5 * regular) / (singular + regular)
    return np.asarray(0.5 * c * np.exp(0.5 + w), dtype=float)


def line_load_at_half_width(width: ArrayLike, radius: ArrayLike, modulus: float) -> FloatArray:
    """Line load p in N/m at which the half-width is `width` (inverse of `half_width`)."""
    return np.asarray(math.pi * modulus * np.asarray(width, dtype=float) ** 2 / (4.0 * np.asarray(radius)))


def local_approach(
    line_load: ArrayLike, patch: ArrayLike, width: ArrayLike, material: Material
) -> FloatArray:
    """Approach (m) that Hertz pressure causes in one body beyond the patch of the finite-element model.

    Two half-plane solutions with the same resultant are subtracted, so the far field cancels and no
    reference depth appears: k p [ln(a/b) + 1/4] with k = 2 (1 - nu^2)/(pi E). The surface under a
    semi-elliptic pressure of half-width a falls off as x^2/a^2, whose mean weighted by that pressure is the
    1/4; under the Hertz strip the center point counts.
    """
    p = np.asarray(line_load, dtype=float)
    k = 2.0 / (math.pi * material.plane_strain_modulus)
    safe = np.where(p > 0.0, width, 1.0)
    return np.where(p > 0.0, k * p * (np.log(np.asarray(patch) / safe) + 0.25), 0.0)


def two_cylinder_approach(
    line_load: float, radii: tuple[float, float], materials: tuple[Material, Material]
) -> float:
    """Approach in m of the centers of two solid cylinders pressed together [1]_.

    The sum over both of p (1 - nu^2)/(pi E) [2 ln(4 R_i/b) - 1].
    """
    b = float(half_width(line_load, relative_radius(*radii), contact_modulus(*materials)))
    return sum(
        line_load / (math.pi * m.plane_strain_modulus) * (2.0 * math.log(4.0 * r / b) - 1.0)
        for r, m in zip(radii, materials, strict=True)
    )
