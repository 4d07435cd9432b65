"""Contributions of bearings and modes to the motion of a housing at one frequency."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.types import FloatArray
from dynamics.vibration.housing_motion import housing_motion
from dynamics.vibration.modal_amplitudes import modal_amplitudes
from dynamics.vibration.seat_forces import ComplexArray

RESIDUAL = "residual"
"""Name of what the modes that are not kept contribute: static flexibility of the seats."""


@dataclass(frozen=True)
class Parts:
    """A motion as a coherent sum.

    Attributes
    ----------
    name : tuple of str
        Bearing seats, or modes by their number from 1; `RESIDUAL` is what is left.
    frequency : (p,) array
        Natural frequencies in Hz; NaN of what is no mode.
    motion : (p, r) complex array
        Of the reduced coordinates, m and rad; their sum is the whole motion.
    """

    name: tuple[str, ...]
    frequency: FloatArray
    motion: ComplexArray

    def shares(self, weight: FloatArray) -> FloatArray:
        """Return contributions to a mean square, (p,): they add up to 1, and some may be negative.

        Each is the part of its motion that is in phase and in shape with the sum: Re(x^H W x_p)/(x^H W x).

        Parameters
        ----------
        weight : (r, r) array
            Symmetric: `surface_weight`, or m^T m of the rows m of a point's motion.

        Raises
        ------
        InputError
            Nothing moves.
        """
        whole = self.motion.sum(axis=0)
        felt = (whole.conj() @ weight) @ self.motion.T
        size = float(felt.sum().real)
        if not size > 0.0:
            raise InputError(
                "motion", size, "a motion", "No force acts on the seats at this order and speed."
            )
        return np.asarray(felt.real / size)


def bearing_parts(housing: ReducedHousing, frequency: float, force: ComplexArray) -> Parts:
    """Return the motion under the force of each bearing.

    Parameters
    ----------
    housing : ReducedHousing
    frequency : float
        Hz.
    force : (s,) complex array
        On the motions of the seats (`seat_forces`).
    """
    owner = np.repeat(np.arange(len(housing.seats)), [len(seat.motions) for seat in housing.seats])
    apart = np.where(owner == np.arange(len(housing.seats))[:, None], force, 0.0)
    motion = housing_motion(housing, np.full(len(apart), float(frequency)), apart)
    return Parts(tuple(seat.name for seat in housing.seats), np.full(len(apart), np.nan), motion)


def mode_parts(housing: ReducedHousing, frequency: float, force: ComplexArray) -> Parts:
    """Return the motion in each mode kept, and in the rest together; parameters as `bearing_parts`."""
    amplitude = modal_amplitudes(housing, np.array([float(frequency)]), np.asarray(force)[None, None])[0, 0]
    every = amplitude[:, None] * housing.modes[1].T
    kept = len(housing.frequency)
    names = tuple(f"mode {number + 1}" for number in range(kept))
    if kept == len(every):
        return Parts(names, housing.frequency, every)
    motion = np.vstack([every[:kept], every[kept:].sum(axis=0, keepdims=True)])
    return Parts((*names, RESIDUAL), np.append(housing.frequency, np.nan), motion)
