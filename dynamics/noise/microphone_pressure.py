"""Sound pressure of the orders of all housings at a microphone in the free field."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.acoustics import LevelBand, a_weighting
from dynamics.acoustics.levels import mean_square_level
from dynamics.linearize.line_floor import LineFloor
from dynamics.noise.estimated_radiation import EstimatedRadiation
from dynamics.noise.floor_sound import mean_square_floor
from dynamics.noise.housing_recordings import pressure_transfer
from dynamics.noise.sounding_housing import SoundingHousing
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration import BearingHarmonics, seat_forces


@dataclass(frozen=True)
class OrderPressure:
    """The largest sound pressure level of an order over the speeds, and its band."""

    order: float
    speed: float
    """Speed at which the order is loudest, rad/s."""
    level: float
    """Sound pressure level at that speed, dB(A) re 20 uPa."""
    low: float | None
    high: float | None
    """`low`, `high`: Ends of the band, dB(A); None: the sound power has no band."""


@dataclass(frozen=True)
class MicrophonePressure:
    """Sound pressure levels at a microphone, dB(A) re 20 uPa."""

    microphone: FloatArray
    """Position of the microphone in the frame of the scene, m. Shape (3,)."""
    level: FloatArray
    """Level by order, then by speed. Shape (H, S)."""
    total_level: FloatArray
    """Level of all orders together, the unlisted ones included. Shape (S,)."""
    orders: tuple[OrderPressure, ...]
    """Each order at the speed where it is loudest."""


def microphone_pressure(
    response: BearingHarmonics,
    housings: Iterable[SoundingHousing],
    microphone: FloatArray,
    power_bands: Sequence[LevelBand] | None = None,
) -> MicrophonePressure:
    """Return the sound pressure levels of housings at a microphone.

    The pressures of the housings add up with their phases. The exact computation of single lines corrects the
    power of a housing, not the phase of its pressure; it is not used here. Raises `InputError`: the
    microphone is not in the air.

    Parameters
    ----------
    response : BearingHarmonics
        Response as in `radiated_sound`.
    microphone : (3,) array
        Position in the frame of the scene, m.
    power_bands : sequence of LevelBand, optional
        Bands of the largest sound power of each order. The pressure gets the same deviations in dB, because
        an uncertain input changes both alike; the further error of a single direction is not known.
    """
    hertz = response.frequency
    pressure, floors = np.zeros(hertz.shape, dtype=complex), list[ComplexArray]()
    for housing in housings:
        pressure += np.sum(_pressures(response, housing, microphone), axis=-1)
        if response.floor is not None:
            floors.append(_floor_pressure(response.floor, housing, microphone))
    weighted = 0.5 * np.abs(pressure) ** 2 * 10.0 ** (a_weighting(hertz) / 10.0)
    total = np.sum(weighted, axis=1)
    if response.floor is not None:
        omitted = mean_square_floor(response.floor, np.sum(floors, axis=0))
        total = total + np.sum(omitted.power * 10.0 ** (a_weighting(omitted.frequency) / 10.0), axis=1)
    level = mean_square_level(weighted)
    orders = _loudest_of_orders(response, level, power_bands)
    return MicrophonePressure(microphone, level.T, mean_square_level(total), orders)


def _loudest_of_orders(
    response: BearingHarmonics, level: FloatArray, power_bands: Sequence[LevelBand] | None
) -> tuple[OrderPressure, ...]:
    """Return each order where its level (S, H) is largest over the speeds."""
    orders = []
    for h, s in enumerate(np.argmax(level, axis=0)):
        largest, low, high = float(level[s, h]), None, None
        if power_bands is not None:
            band = power_bands[h]
            low, high = (largest + (end - band.nominal) for end in (band.low, band.high))
        orders.append(OrderPressure(float(response.order[h]), float(response.speed[s]), largest, low, high))
    return tuple(orders)


def _pressures(response: BearingHarmonics, housing: SoundingHousing, microphone: FloatArray) -> ComplexArray:
    """Return the pressure by the force on each of s seat motions, Pa, (S, H, s)."""
    path = _path(housing, microphone, response.frequency.ravel())
    force = seat_forces(response, housing.body, housing.bearings)
    return np.asarray(force * path.reshape(force.shape))


def _floor_pressure(floor: LineFloor, housing: SoundingHousing, microphone: FloatArray) -> ComplexArray:
    """Return the pressure of a housing by the lines that are not listed, per input of these, Pa, (G, e)."""
    path = _path(housing, microphone, floor.frequency)
    force = seat_forces(floor, housing.body, housing.bearings)
    return np.asarray(np.sum(force * path.reshape(len(force), 1, -1), axis=-1))


def _path(housing: SoundingHousing, microphone: FloatArray, hertz: FloatArray) -> ComplexArray:
    estimate = housing.plain if isinstance(housing.plain, EstimatedRadiation) else None
    return pressure_transfer(housing.body, microphone, hertz, estimate=estimate)
