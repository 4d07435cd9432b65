"""Sound power and sound pressure of the lines that a linear response leaves out."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.acoustics import ModalResistance
from dynamics.housings.reduced_housing import ReducedHousing
from dynamics.linearize.line_floor import FloorPower, LineFloor
from dynamics.types import ComplexArray
from dynamics.vibration import seat_forces
from dynamics.vibration.housing_motion import modal_amplitudes


def radiated_floor(
    floor: LineFloor, housing: ReducedHousing, bearings: Sequence[str] | None, radiation: ModalResistance
) -> FloorPower:
    """Return the sound power of a housing in the lines left out, W.

    Raises `InputError` as `seat_forces`, `modal_amplitudes` and `ModalResistance.reaction` do.
    """
    force, hertz = seat_forces(floor, housing, bearings), floor.frequency
    amplitude = modal_amplitudes(housing, hertz, force)
    velocity = 2j * np.pi * hertz[:, None, None] * (amplitude @ housing.modes[1].T)
    flat = velocity.reshape(-1, velocity.shape[2])
    reaction = radiation.reaction(np.repeat(hertz, velocity.shape[1]), flat).reshape(velocity.shape)
    matrix = 0.5 * velocity.conj() @ np.swapaxes(reaction, 1, 2)
    return floor.power(0.5 * (matrix + np.swapaxes(matrix, 1, 2).conj()))


def mean_square_floor(floor: LineFloor, signal: ComplexArray) -> FloorPower:
    """Return the mean square in the lines left out of a signal per input, (G, e) peak amplitudes."""
    return floor.power(0.5 * signal[:, :, None].conj() * signal[:, None, :])
