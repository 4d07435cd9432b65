"""Limits of rounding in a compliance: its share in residual and energy, and the thinnest disc."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.geometry import Toothing
from fe_contact.material import Material
from fe_contact.types import FloatArray
from host.optional_modules import scipy

LARGEST_ROUNDING = 1e-6
"""Largest part of the strain energy that rounding may change: a thousandth of the discretization error of
fine meshes.
"""


NORM = 4.0
"""Norm of K over its largest diagonal entry, at most; by the entry alone residuals reach 0.6 of the bound."""


PLATE = 0.13
"""Strain energy of the plate over that in its plane, per (D/w)^2 tan^2 beta: measured."""


EPSILON = float(np.finfo(float).eps)


def left_by_rounding(
    stiffness: FloatArray, displacement: FloatArray, load: FloatArray, work: float
) -> tuple[float, float]:
    """Return bounds of the rounding errors in residual and energy, both relative.

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

    `slenderness` is the depth from bore to root over the width, D/w; the helix angle is in rad.
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

    return abs(gear.root_radius - gear.seat_radius) / float(10.0 ** scipy.optimize.brentq(beyond, -3.0, 9.0))
