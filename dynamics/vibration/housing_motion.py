"""Motion of a housing by order and speed, and the power that flows into it."""

from __future__ import annotations

import math

import numpy as np

from dynamics.errors import InputError
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.types import ComplexArray, FloatArray

# Amplitudes of the modes of a reduced housing under harmonic forces.


ROUNDING = 1e-9
"""Of the damping of two modes: what couples them by less is rounding."""
BLOCK = 64
"""Frequencies whose matrices are held at a time, where modes are coupled by damping."""


def modal_amplitudes(housing: ReducedHousing, frequency: FloatArray, force: ComplexArray) -> ComplexArray:
    """Return amplitudes of `ReducedHousing.modes`, with damping between modes.

    Parameters
    ----------
    housing : ReducedHousing
        With mass.
    frequency : (N,) array
        Hz.
    force : (N, e, q) or (1, e, q) complex array
        On the first q reduced coordinates, e loads at each frequency.

    Returns
    -------
    (N, e, m) array
        Complex peak amplitudes; modes have unit modal mass.

    Raises
    ------
    InputError
        The housing has no mass, or it resonates there without damping.
    """
    if not np.any(housing.mass):
        raise InputError("mass", 0.0, "a housing with mass", "Reduce its mesh, or give its mass matrix.")
    natural, shape = housing.modes
    damping = shape.T @ housing.damping @ shape
    omega = 2.0 * math.pi * np.asarray(frequency, dtype=float)
    pushed = np.asarray(force) @ shape[: np.shape(force)[-1]]
    own = np.diag(damping)
    square = natural**2 - omega[:, None] ** 2
    try:
        if np.all(np.abs(damping - np.diag(own)) <= ROUNDING * np.sqrt(np.outer(own, own).clip(0.0))):
            return _uncoupled(square + 1j * omega[:, None] * own, pushed)
        return _coupled(square, omega, damping, pushed)
    except np.linalg.LinAlgError as error:
        advice = "The housing resonates there without damping, or moves freely."
        raise InputError("frequency", "singular", "off resonances without damping", advice) from error


def _uncoupled(dynamic: ComplexArray, pushed: ComplexArray) -> ComplexArray:
    """Divide by the dynamic stiffness of every mode, (N, m)."""
    if not np.all(dynamic):
        raise np.linalg.LinAlgError("a dynamic stiffness is zero")
    return np.asarray(pushed / dynamic[:, None, :])


def _coupled(
    square: FloatArray, omega: FloatArray, damping: FloatArray, pushed: ComplexArray
) -> ComplexArray:
    """Solve for all modes together, a block of frequencies at a time."""
    loads = np.broadcast_to(pushed, (omega.size, *pushed.shape[1:]))
    amplitude = np.empty(loads.shape, dtype=complex)
    for first in range(0, omega.size, BLOCK):
        part = slice(first, first + BLOCK)
        dynamic = 1j * omega[part, None, None] * damping + np.eye(len(damping)) * square[part, None, :]
        solved = np.linalg.solve(dynamic, np.swapaxes(loads[part], 1, 2))
        amplitude[part] = np.swapaxes(solved, 1, 2)
    return amplitude


# Motion of a reduced housing under harmonic forces on its seats.


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
