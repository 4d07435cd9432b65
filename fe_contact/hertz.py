"""Analytic contact of elastic half-planes and wedges: pure functions of load, curvature and modulus."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.material import Material
from fe_contact.types import FloatArray

# Contact of a smooth flank with the tip edge of its partner.


def edge_contact_length(
    line_load: ArrayLike, slope: ArrayLike, radius: ArrayLike, modulus: float
) -> FloatArray:
    """Contact length c in m from the edge.

    Parameters
    ----------
    line_load : array_like
        p in N/m, >= 0.
    slope : array_like
        phi in rad, angle between the two flanks at the edge, positive = they open away from the edge.
    radius : array_like
        Relative radius R in m.
    modulus : float
        Contact modulus E* in Pa.
    """
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


def wedge_softness(angle: float) -> float:
    """Return how much more a wedge yields to a force at its edge than a half plane does; 1 at an angle of pi.

    A force p at the apex, normal to a face, moves what is r away by -k_w p ln(r) plus a constant.
    This is k_w/k, k = 2 (1 - nu^2)/(pi E) that of the half plane, by the radial stresses in a wedge.

    Parameters
    ----------
    angle : float
        Of the material between the faces, rad.
    """
    half = 0.5 * angle
    along, across = half + 0.5 * math.sin(angle), half - 0.5 * math.sin(angle)
    return 0.5 * math.pi * (math.sin(half) ** 2 / along + math.cos(half) ** 2 / across)


def contact_modulus(first: Material, second: Material) -> float:
    """Contact modulus E* in Pa, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 [1]_."""
    return 1.0 / (1.0 / first.plane_strain_modulus + 1.0 / second.plane_strain_modulus)


def relative_radius(first: ArrayLike, second: ArrayLike) -> FloatArray:
    """Relative radius of curvature R in m, 1/R = 1/R1 + 1/R2 (R2 infinite: a plane; R2 < 0: concave)."""
    # a radius of zero has infinite curvature, conforming bodies have an infinite R
    with np.errstate(divide="ignore"):
        curvature = 1.0 / np.asarray(first, dtype=float) + 1.0 / np.asarray(second, dtype=float)
        return np.asarray(1.0 / curvature, dtype=float)


def half_width(line_load: ArrayLike, radius: ArrayLike, modulus: float) -> FloatArray:
    """Half-width b in m of the contact strip, b^2 = 4 p R / (pi E*) [1]_."""
    p, r = np.asarray(line_load, dtype=float), np.asarray(radius, dtype=float)
    return np.asarray(np.sqrt(4.0 * p * r / (math.pi * modulus)), dtype=float)


def line_load_at_half_width(width: ArrayLike, radius: ArrayLike, modulus: float) -> FloatArray:
    """Line load p in N/m at which the half-width is `width` (inverse of `half_width`)."""
    return np.asarray(math.pi * modulus * np.asarray(width, dtype=float) ** 2 / (4.0 * np.asarray(radius)))


def peak_pressure(line_load: ArrayLike, radius: ArrayLike, modulus: float) -> FloatArray:
    """Peak pressure p0 in Pa, p0^2 = p E* / (pi R) [1]_."""
    return np.sqrt(np.asarray(line_load, dtype=float) * modulus / (math.pi * np.asarray(radius)))


def local_approach(
    line_load: ArrayLike, patch: ArrayLike, width: ArrayLike, material: Material
) -> FloatArray:
    """Approach that Hertz pressure causes in one body beyond the patch of the finite-element model.

    Two half-plane solutions with the same resultant are subtracted, so the far field cancels and no
    reference depth appears: k p [ln(a/b) + 1/4] with k = 2 (1 - nu^2)/(pi E). The surface under a
    semi-elliptic pressure of half-width a falls off as x^2/a^2, whose mean weighted by that pressure is the
    1/4; under the Hertz strip the center point counts.

    Parameters
    ----------
    line_load : array_like
        p in N/m.
    patch : array_like
        Half-width a in m of the semi-elliptic load and displacement weight in the finite-element model.
    width : array_like
        Hertz half-width b in m (or the equivalent half-width of an edge contact).
    material : Material
        The body.

    Returns
    -------
    ndarray
        Approach in m, positive = bodies come closer; zero where p = 0.
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
