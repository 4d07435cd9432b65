"""Analytic contact of elastic half-planes and wedges: pure functions of load, curvature and modulus.

References
----------
.. [1] K. L. Johnson, Contact Mechanics, Cambridge University Press 1985, sections 4.2 and 5.6.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from fe_contact.material import Material
from fe_contact.types import FloatArray

STRIP_DISTANCE = 64.0 / (9.0 * math.pi**2)
"""Mean distance, 0.72 half-widths, of two points of a contact strip, one drawn by the pressure of a rigid
flat punch and the other by that of Hertz.
"""


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


def peak_pressure(line_load: ArrayLike, radius: ArrayLike, modulus: float) -> FloatArray:
    """Peak pressure p0 in Pa, p0^2 = p E* / (pi R) [1]_."""
    return np.sqrt(np.asarray(line_load, dtype=float) * modulus / (math.pi * np.asarray(radius)))


def wedge_softness(angle: float) -> float:
    """Return how much more a wedge yields to a force at its edge than a half plane does; 1 at an angle of pi.

    A force p at the apex, normal to a face, moves what is r away by -k_w p ln(r) plus a constant. This is
    k_w/k, k = 2 (1 - nu^2)/(pi E) that of the half plane, by the radial stresses in a wedge. `angle`: of the
    material between the faces, rad.
    """
    half = 0.5 * angle
    along, across = half + 0.5 * math.sin(angle), half - 0.5 * math.sin(angle)
    return 0.5 * math.pi * (math.sin(half) ** 2 / along + math.cos(half) ** 2 / across)


def lateral_share(poissons_ratio: float) -> float:
    """Return the part of k p theta by which a flank gives way to a load whose normal is turned by theta.

    A normal load draws the surface beside it towards itself by (1 - 2 nu)(1 + nu) p/(2 E). Where normals
    turn, that has a part along the other normal. k = 2 (1 - nu^2)/(pi E), in plane strain; exact for a disc
    (docs/theory/hertz.md).
    """
    return 0.25 * math.pi * (1.0 - 2.0 * poissons_ratio) / (1.0 - poissons_ratio)
