"""The mean square of the motion of a surface, as a quadratic form of the reduced coordinates."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.identity_cache import identity_cached
from dynamics.types import FloatArray
from dynamics.vibration.seat_forces import ComplexArray


@identity_cached
def surface_weight(housing: ReducedHousing) -> FloatArray:
    """Return the weight of the normal motion of the whole surface, (r, r), as `normal_weight` has it.

    The walls of cavities and bores are part of it.

    Raises
    ------
    InputError
        The housing has no surface.
    """
    if housing.surface is None:
        advice = "Reduce its mesh or STEP file: matrices alone have no surface."
        raise InputError("surface", "none", "a housing with a surface", advice)
    return normal_weight(*housing.surface.normal_displacement())


def normal_weight(normal: FloatArray, area: FloatArray) -> FloatArray:
    """Return the mean over the area of the products of normal motions, (r, r).

    Parameters
    ----------
    normal : (t, r) array
        Mean normal displacement of faces per reduced coordinate.
    area : (t,) array
    """
    return np.asarray(normal.T @ (area[:, None] * normal) / area.sum())


def mean_square(motion: ComplexArray, weight: FloatArray) -> FloatArray:
    """Return the mean square over surface and time, (...), x^H W x / 2 of peak amplitudes (..., r)."""
    return np.asarray(0.5 * np.sum(motion.conj() * (motion @ weight), axis=-1).real)
