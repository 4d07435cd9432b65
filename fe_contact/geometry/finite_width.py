"""Deflection of a gear of finite width relative to its section in plane strain and plane stress."""

from __future__ import annotations

from fe_contact.geometry.parallel_axes import ParallelAxes

PLANE_STRESS_SHARE = 0.76
"""Excess of plane stress over plane strain, in parts of that of their moduli, nu^2/(1 - nu^2)."""
DECAY_WIDTH = 5.0
"""Face width in modules at which half of it is left."""


def finite_width_excess(pair: ParallelAxes) -> float:
    """Estimate the relative excess of the mean STE of a spur pair of finite width over plane strain.

    The ends of the face are free, so a narrow gear is in plane stress and a very wide one in plane strain;
    between them the excess falls as 1/(1 + (b/m)/5). It is right within about a half: good enough to say
    what plane strain leaves out before anything is computed. What a result is corrected by is computed
    (docs/effects/finite_width.md).
    """
    modules = pair.face_width / pair.pinion.normal_module
    return PLANE_STRESS_SHARE * _moduli(pair) / (1.0 + modules / DECAY_WIDTH)


def plane_stress_excess(pair: ParallelAxes) -> float:
    """Estimate the relative excess of STE in plane stress over that at the finite width.

    It is that of peak-to-peak, which the bodies make; of the mean, of which contact takes a part, it is three
    quarters.
    """
    return (1.0 + _moduli(pair)) / (1.0 + finite_width_excess(pair)) - 1.0


def _moduli(pair: ParallelAxes) -> float:
    """Return the relative excess of the modulus of plane strain over that of plane stress."""
    ratio = 0.5 * (pair.pinion.material.poissons_ratio + pair.wheel.material.poissons_ratio)
    return ratio**2 / (1.0 - ratio**2)
