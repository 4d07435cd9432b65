"""Compliance of a plain annular disc between its rigid inner and outer edges, in closed form.

Thin discs are in plane stress. Timoshenko and Goodier, Theory of Elasticity, art. 37 (torsion of a ring) and
Muskhelishvili's complex potentials of a force at the hole of an annulus, both edges rigid.
"""

from __future__ import annotations

import math

from fe_contact.geometry.toothing import Toothing
from fe_contact.material import Material


def torsion_compliance(inner: float, outer: float, material: Material) -> float:
    """Return the angle per moment between the edges of a disc, times its thickness: m rad / (N m).

    The disc shears only: (1/r_i^2 - 1/r_o^2) / (4 pi G); radii in m.
    """
    return (inner**-2 - outer**-2) / (4.0 * math.pi * shear_modulus(material))


def shift_compliance(inner: float, outer: float, material: Material) -> float:
    """Return the shift per force in the plane of a disc between its edges, times its thickness: m^2 / N.

    It is (kappa ln(r_o/r_i) - (r_o^2 - r_i^2) / (kappa (r_o^2 + r_i^2))) / (2 pi G (1 + kappa)), with
    kappa = (3 - nu) / (1 + nu); radii in m.
    """
    kappa = (3.0 - material.poissons_ratio) / (1.0 + material.poissons_ratio)
    ratio = (outer**2 - inner**2) / (outer**2 + inner**2)
    shape = kappa * math.log(outer / inner) - ratio / kappa
    return shape / (2.0 * math.pi * shear_modulus(material) * (1.0 + kappa))


def web_compliance(gear: Toothing) -> float:
    """Return the compliance of a web beyond that of a solid body, along the line of action, m/N.

    It is a lower bound for the blank: rim and hub are rigid here, and the force enters the web evenly.
    """
    web = gear.web
    if web is None:
        return 0.0
    disc = (web.inner_radius, web.outer_radius, gear.material)
    rotation = gear.base_radius**2 * torsion_compliance(*disc) + shift_compliance(*disc)
    return rotation * (1.0 / web.thickness - 1.0 / gear.face_width)


def shear_modulus(material: Material) -> float:
    """Return the shear modulus G in Pa."""
    return 0.5 * material.youngs_modulus / (1.0 + material.poissons_ratio)
