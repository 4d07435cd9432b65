"""Forced vibration of a reduced housing."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.checks import not_negative
from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray


def receptance(
    housing: ReducedHousing, frequency: Sequence[float] | FloatArray, *, residual: bool = True
) -> FloatArray:
    """Return the motion under unit harmonic forces on the seats.

    Parameters
    ----------
    housing : ReducedHousing
    frequency : (n,) array
        Hz.
    residual : bool
        Whether the flexibility of the modes that are not kept is in it; without it, the sum over the kept
        modes alone, for comparison: seats are too stiff then.

    Returns
    -------
    (n, r, s) complex array
        Reduced coordinates per force (m/N) or moment on the seats; the first s rows are the seats' motions.
        `SurfaceMotion.motion @` it and `PointMotion.motion @` it are displacements.

    Raises
    ------
    InputError
        A frequency is negative or no number.
    """
    hertz = np.asarray(frequency, dtype=float)
    for index, value in enumerate(hertz):
        not_negative(f"frequency[{index}]", float(value))
    omega = 2.0 * math.pi * hertz[:, None, None]
    matrices = housing.mass, housing.damping, housing.stiffness
    basis = _scaled(housing) if residual else housing.modes[1][:, : len(housing.frequency)]
    mass, damping, stiffness = (basis.T @ matrix @ basis for matrix in matrices)
    forces = basis[: housing.motions].T
    try:
        amplitude = np.linalg.solve(stiffness + 1j * omega * damping - omega**2 * mass, forces[None])
    except np.linalg.LinAlgError as error:
        advice = "The housing moves freely there, or resonates without damping."
        raise InputError(
            "frequency", "singular", "off frequencies at which the motion is infinite", advice
        ) from error
    return np.asarray(basis @ amplitude)


def _scaled(housing: ReducedHousing) -> FloatArray:
    """Return coordinates of like size, (r, r): they are meters, radians and modal amplitudes."""
    diagonal = np.diag(housing.stiffness)
    return np.diag(1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0)))
