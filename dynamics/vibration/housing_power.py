"""Power that bearings put into a housing: lost in it, or through its mounts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray
from dynamics.vibration.housing_motion import housing_motion
from dynamics.vibration.seat_forces import ComplexArray


@dataclass(frozen=True)
class HousingPower:
    """Mean powers by harmonics, (...,) each, W.

    Attributes
    ----------
    input : array
        Of the bearings, at the seats.
    own : array
        Lost by the damping of the housing's modes.
    mounts : array
        Lost in the dampers of the mounts: structure-borne power. Fixed feet take none.
    """

    input: FloatArray
    own: FloatArray
    mounts: FloatArray

    @property
    def residual(self) -> float:
        """Power that is put in and lost nowhere, of the largest input."""
        missing = np.abs(self.input - self.own - self.mounts)
        return float(np.max(missing, initial=0.0) / max(np.max(np.abs(self.input), initial=0.0), 1e-300))


def housing_power(housing: ReducedHousing, frequency: FloatArray, force: ComplexArray) -> HousingPower:
    """Return where the power goes that bearings put into a housing.

    Parameters
    ----------
    housing : ReducedHousing
        With mass. Where `mount_damping` is None all its losses are its own.
    frequency : (...,) array
        Hz, any shape.
    force : (..., s) array
        Complex peak amplitudes on the motions of the seats, N and N m (`seat_forces`).

    Raises
    ------
    InputError
        As `housing_motion`.
    """
    motion = housing_motion(housing, frequency, force)
    rate = 2.0j * math.pi * np.asarray(frequency, dtype=float)[..., None] * motion
    put_in = 0.5 * np.real(np.sum(force * rate[..., : housing.motions].conj(), axis=-1))
    mounts = np.zeros_like(housing.damping) if housing.mount_damping is None else housing.mount_damping
    own, through = (_dissipated(matrix, rate) for matrix in (housing.damping - mounts, mounts))
    return HousingPower(np.asarray(put_in), own, through)


def _dissipated(damping: FloatArray, rate: ComplexArray) -> FloatArray:
    """Return the mean power of a damping matrix at velocities (..., r) of the coordinates, (...,) W."""
    return np.asarray(0.5 * np.real(np.einsum("...i,ij,...j->...", rate.conj(), damping, rate)))
