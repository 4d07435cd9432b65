"""The mean square of the motion of a surface, as a quadratic form of the reduced coordinates."""

from __future__ import annotations

import numpy as np

from dynamics.acoustics import outer_hull
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray
from dynamics.vibration.seat_forces import ComplexArray


def surface_weight(housing: ReducedHousing) -> FloatArray:
    """Return the mean over the outer hull of the products of normal motions, (r, r).

    Walls of cavities are left out and openings capped (`outer_hull`): with the hull's area and rho c of the
    air a mean square velocity gives the equivalent radiated power.

    Raises
    ------
    InputError
        The housing has no surface.
    """
    outer = outer_hull(housing)
    return outer.surface / outer.hull.area


def mean_square(motion: ComplexArray, weight: FloatArray) -> FloatArray:
    """Return the mean square over surface and time, (...), x^H W x / 2 of peak amplitudes (..., r)."""
    return np.asarray(0.5 * np.sum(motion.conj() * (motion @ weight), axis=-1).real)
