"""Deflection of a gear of finite width relative to its section in plane strain and plane stress."""

from __future__ import annotations

from fe_contact.geometry.parallel_axes import ParallelAxes

BENDING_SHARE = 0.72
"""Excess of the mean STE in plane stress over plane strain, over the excess of the moduli, nu^2/(1 - nu^2).
It is below 1 since the local contact has no such excess.
"""

TOOTH_DECAY = 3.2
"""Face width in modules at which half of the excess of teeth is left."""
BODY_DECAY = 0.42
"""The same of teeth with bodies, over z^0.75 with the geometric mean z of the numbers of teeth."""

CORRECTION_ERROR = 0.03
"""Error of the computed correction of STE for a finite width, over the correction, of external pairs. The
largest of mean, peak-to-peak and harmonics (docs/lab/index.md, "Constants") is 0.033, of peak-to-peak at a
face of 1.2 modules; the error of the mesh covers part of it.
"""
INTERNAL_CORRECTION_ERROR = 0.05
"""The same of internal pairs: a coarse mesh and the even load cost 0.02 to 0.042 at a face of 5 modules."""


def correction_error(pair: ParallelAxes) -> float:
    """Return the error of the correction of a pair for its finite width, over the correction."""
    return INTERNAL_CORRECTION_ERROR if pair.internal else CORRECTION_ERROR


def finite_width_excess(pair: ParallelAxes) -> tuple[float, float]:
    """Estimate the relative excess of mean and peak-to-peak STE of a spur pair over those in plane strain.

    The ends of the face are free, so a narrow gear is in plane stress and a very wide one in plane strain.
    Teeth and bodies make the mean; the teeth alone make peak-to-peak, on usual flanks. The estimates are
    within 15 and 20 % of finite elements on 30 external and internal pairs with faces of 1.25 to 30 modules.
    The correction of a result is not this estimate but computed (docs/effects.md#finite_width).
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
