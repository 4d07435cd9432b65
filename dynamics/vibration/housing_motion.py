"""Motion of a reduced housing under harmonic forces on its seats."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray
from dynamics.vibration.modal_amplitudes import modal_amplitudes
from dynamics.vibration.seat_forces import ComplexArray


def housing_motion(housing: ReducedHousing, frequency: FloatArray, force: ComplexArray) -> ComplexArray:
    """Return the displacements of a housing by harmonics.

    Parameters
    ----------
    housing : ReducedHousing
        With mass.
    frequency : (...,) array
        Hz, any shape.
    force : (..., s) array
        Complex peak amplitudes on the motions of the seats, N and N m (`seat_forces`).

    Returns
    -------
    (..., r) array
        Complex peak amplitudes of the reduced coordinates, m, rad; times 2 pi i frequency: velocities.
        `SurfaceMotion.motion @` and `PointMotion.motion @` them move the surface and points.

    Raises
    ------
    InputError
        The shapes differ, the housing has no mass, or it resonates there without damping.
    """
    hertz = np.asarray(frequency, dtype=float)
    if np.shape(force) != (*hertz.shape, housing.motions):
        raise InputError("force", np.shape(force), f"shape {(*hertz.shape, housing.motions)}")
    loads = np.reshape(force, (hertz.size, 1, housing.motions))
    amplitude = modal_amplitudes(housing, hertz.ravel(), loads)[:, 0]
    return np.asarray((amplitude @ housing.modes[1].T).reshape(*hertz.shape, -1))
