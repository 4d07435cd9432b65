"""Compliance of a plain annular disc between a held inner and a rigid outer edge, in closed form.

Thin discs are in plane stress. Timoshenko and Goodier, Theory of Elasticity, art. 37 (torsion of a ring) and
Muskhelishvili's complex potentials of a force at the hole of an annulus, both edges rigid.
"""

from __future__ import annotations

import math

from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.geometry.toothing import Toothing
from fe_contact.material import Material

# Deflection of a gear of finite width relative to its section in plane strain and plane stress.

BENDING_SHARE = 0.72
"""Excess of the mean in plane stress over plane strain, in parts of that of the moduli, nu^2/(1 - nu^2):
contact has none."""
TOOTH_DECAY, BODY_DECAY = 3.2, 0.42
"""Face width in modules at which half is left: of teeth; of teeth with bodies over z^0.75, z the geometric
mean of the teeth."""


def finite_width_excess(pair: ParallelAxes) -> tuple[float, float]:
    """Estimate the relative excess of mean and peak-to-peak STE of a spur pair over those in plane strain.

    The ends of the face are free, so a narrow gear is in plane stress and a very wide one in plane strain.
    The mean has the bodies, too, which are larger than the teeth; peak-to-peak, that of usual flanks, has the
    teeth alone. Within 15 and 20 % of finite elements on 30 pairs, faces of 1.25 to 30 modules, internal
    ones included; what a result is corrected by is computed (docs/effects.md#finite_width).
    """
    modules, moduli = pair.face_width / pair.pinion.normal_module, _moduli(pair)
    body = BODY_DECAY * (pair.pinion.teeth * abs(pair.wheel.teeth)) ** 0.375
    return BENDING_SHARE * moduli / (1.0 + modules / body), moduli / (1.0 + modules / TOOTH_DECAY)


def plane_stress_excess(pair: ParallelAxes) -> tuple[float, float]:
    """Estimate the relative excess of mean and peak-to-peak STE in plane stress over the finite width."""
    (mean, ripple), moduli = finite_width_excess(pair), _moduli(pair)
    return (1.0 + BENDING_SHARE * moduli) / (1.0 + mean) - 1.0, (1.0 + moduli) / (1.0 + ripple) - 1.0


def _moduli(pair: ParallelAxes) -> float:
    """Return the relative excess of the modulus of plane strain over that of plane stress."""
    ratio = 0.5 * (pair.pinion.material.poissons_ratio + pair.wheel.material.poissons_ratio)
    return ratio**2 / (1.0 - ratio**2)


def torsion_compliance(inner: float, outer: float, material: Material) -> float:
    """Angle per moment between the edges of a disc, times its thickness: m rad / (N m).

    Shear alone: (1/r_i^2 - 1/r_o^2) / (4 pi G); radii in m.
    """
    return (inner**-2 - outer**-2) / (4.0 * math.pi * shear_modulus(material))


def shift_compliance(inner: float, outer: float, material: Material) -> float:
    """In-plane shift per force between the rigid edges of a disc, times its thickness: m^2 / N.

    (kappa ln(r_o/r_i) - (r_o^2 - r_i^2) / (kappa (r_o^2 + r_i^2))) / (2 pi G (1 + kappa)), with
    kappa = (3 - nu) / (1 + nu); radii in m.
    """
    kappa = (3.0 - material.poissons_ratio) / (1.0 + material.poissons_ratio)
    ratio = (outer**2 - inner**2) / (outer**2 + inner**2)
    shape = kappa * math.log(outer / inner) - ratio / kappa
    return shape / (2.0 * math.pi * shear_modulus(material) * (1.0 + kappa))


def web_compliance(gear: Toothing) -> float:
    """Compliance of the web of a gear beyond that of a solid body, along the line of action, m/N.

    A lower bound of what the blank adds: rim and hub are rigid here, and the force enters the web evenly.
    """
    web = gear.web
    if web is None:
        return 0.0
    radii = (web.inner_radius, web.outer_radius, gear.material)
    each = gear.base_radius**2 * torsion_compliance(*radii) + shift_compliance(*radii)
    return each * (1.0 / web.thickness - 1.0 / gear.face_width)


def shear_modulus(material: Material) -> float:
    """G in Pa."""
    return 0.5 * material.youngs_modulus / (1.0 + material.poissons_ratio)
