"""Motion of a reduced housing under harmonic forces on its seats."""

from __future__ import annotations

import math

import numpy as np

from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray
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
    if not np.any(housing.mass):
        raise InputError("mass", 0.0, "a housing with mass", "Reduce its mesh, or give its mass matrix.")
    natural, shape = housing.modes
    damping = shape.T @ housing.damping @ shape
    omega = 2.0 * math.pi * hertz.reshape(-1, 1)
    pushed = np.reshape(force, (omega.size, -1)) @ shape[: housing.motions]
    dynamic = 1j * omega[:, :, None] * damping + np.eye(natural.size) * (natural**2 - omega**2)[:, None, :]
    try:
        amplitude = np.linalg.solve(dynamic, pushed[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError as error:
        advice = "The housing resonates there without damping, or moves freely."
        raise InputError("frequency", "singular", "off resonances without damping", advice) from error
    return np.asarray((amplitude @ shape.T).reshape(*hertz.shape, -1))
