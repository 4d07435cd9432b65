"""Limits of rounding in a compliance: its share in residual and energy, and the thinnest disc.

Rounding changes an entry of K by eps times its size. Where the body moves far more than it is strained, the
terms K_ii u_i^2 of the strain energy u' K u all but cancel, and what they leave is changed by

    eps sum_i K_ii u_i^2 / u' K u,

the condition number of that sum; f - K u likewise keeps eps |K| |u| / |f|. Neither is the fault of a wrong
matrix, which misses both by far more.

A disc of depth D (bore to root) and width w, in n layers, is the worst of bodies. Its elements resist
stretching over a layer with (lambda + 2 mu) n / w per area. In its plane it gives way by D / w: the quotient
is n^2 M (D/w)^2, M = (lambda + 2 mu) / E. The axial part of the force on a helical tooth bends it as a plate,
whose compliance is as (D/w)^3 tan^2 beta: n^2 M (D/w)^4 once that prevails.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from fe_contact.geometry import Toothing
from fe_contact.material import Material
from fe_contact.types import FloatArray

LARGEST_ROUNDING = 1e-6
"""Largest part of the strain energy that rounding may change: a thousandth of what fine meshes leave."""
NORM = 4.0
"""Norm of K over its largest diagonal entry, at most; by the entry alone residuals reach 0.6 of the bound."""
PLATE = 0.13
"""Strain energy of the plate over that in its plane, per (D/w)^2 tan^2 beta: measured."""

EPSILON = float(np.finfo(float).eps)


def left_by_rounding(
    stiffness: FloatArray, displacement: FloatArray, load: FloatArray, work: float
) -> tuple[float, float]:
    """Return what rounding may leave of residual and energy, both relative.

    Parameters
    ----------
    stiffness : (n,) array
        Of each freedom alone, the diagonal of K, N/m.
    displacement : (n,) array
        Under the load, m.
    load : array
        Nodal forces, N.
    work : float
        u' K u, J.
    """
    residual = NORM * stiffness.max() * np.linalg.norm(displacement) / np.linalg.norm(load)
    energy = np.sum(stiffness * np.square(displacement)) / work
    return EPSILON * float(residual), EPSILON * float(energy)


def disc_rounding(slenderness: float, helix_angle: float, layers: int, material: Material) -> float:
    """Return about what rounding leaves of the energy of a solid disc, to a factor of 3.

    Parameters
    ----------
    slenderness : float
        Depth from bore to root over width, D/w.
    helix_angle : float
        rad.
    layers : int
        Of elements across the face.
    material : Material
    """
    nu = material.poissons_ratio
    stretching = (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu))
    x = slenderness**2
    plate = PLATE * math.tan(helix_angle) ** 2
    return EPSILON * layers**2 * stretching * x * (1.0 + plate * x**2) / (1.0 + plate * x)


def least_face_width(gear: Toothing, layers: int) -> float:
    """Return the face width in m below which rounding changes a solid gear too much."""

    def beyond(power: float) -> float:
        return math.log(
            disc_rounding(10.0**power, gear.helix_angle, layers, gear.material) / LARGEST_ROUNDING
        )

    return abs(gear.root_radius - gear.held_radius) / float(10.0 ** brentq(beyond, -3.0, 9.0))
