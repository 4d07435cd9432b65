"""How much more a gear of finite width deflects than its transverse section in plane strain."""

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
    ratio = 0.5 * (pair.pinion.material.poissons_ratio + pair.wheel.material.poissons_ratio)
    thin = PLANE_STRESS_SHARE * ratio**2 / (1.0 - ratio**2)
    return thin / (1.0 + pair.face_width / pair.pinion.normal_module / DECAY_WIDTH)
