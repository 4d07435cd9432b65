"""Sound pressure of the orders at a microphone, beside the sound power."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from bounds.types import Json
from dynamics.acoustics import (
    a_weighting,
)
from dynamics.acoustics.levels import FLOOR, REFERENCE_PRESSURE
from dynamics.housings import ReducedHousing
from dynamics.linearize.line_floor import LineFloor
from dynamics.noise import (
    EstimatedRadiation,
    HousingRadiation,
    pressure_transfer,
)
from dynamics.noise.floor_sound import mean_square_floor
from dynamics.types import ComplexArray, FloatArray
from dynamics.vibration import BearingHarmonics, seat_forces


class SoundSource(NamedTuple):
    """A housing, the bearings in its seats, and its radiation."""

    body: ReducedHousing
    bearings: tuple[str, ...]
    radiation: HousingRadiation


def pressure_at(
    response: BearingHarmonics, sources: Iterable[SoundSource], microphone: FloatArray, band: Json | None
) -> Json:
    """Return the sound pressure levels at a microphone (3,), m: by order, then by speed, dB(A) re 20 uPa.

    Housings add up by their phases, in the free field. Where an order is loudest it has the band of its sound
    power, as what is guessed moves both alike; what a single direction may add to it is not known.

    Raises `InputError`: the microphone is not in the air.
    """
    hertz = response.frequency
    pressure, floors = np.zeros(hertz.shape, dtype=complex), list[ComplexArray]()
    for source in sources:
        estimate = source.radiation if isinstance(source.radiation, EstimatedRadiation) else None
        path = pressure_transfer(source.body, microphone, hertz.ravel(), estimate=estimate)
        force = seat_forces(response, source.body, source.bearings)
        pressure += np.sum(force * path.reshape(force.shape), axis=-1)
        if response.floor is not None:
            floors.append(_pressure_floor(response.floor, source, microphone))
    weighted = 0.5 * np.abs(pressure) ** 2 * 10.0 ** (a_weighting(hertz) / 10.0)
    level = _decibels(weighted)
    at = np.argmax(level, axis=0)
    rows = []
    for h, s in enumerate(at):
        of_power = None if band is None else band["orders"][h]["largest"]
        own: Json = {"order": float(response.order[h]), "speed": float(response.speed[s])}
        own["level_db_a"] = float(level[s, h])
        for end in ("low_db_a", "high_db_a"):
            off = None if of_power is None else of_power[end] - of_power["level_db_a"]
            own[end] = None if off is None else own["level_db_a"] + off
        rows.append(own)
    whole = np.sum(weighted, axis=1)
    if response.floor is not None:
        left_out = mean_square_floor(response.floor, np.sum(floors, axis=0))
        whole = whole + np.sum(left_out.power * 10.0 ** (a_weighting(left_out.frequency) / 10.0), axis=1)
    total = _decibels(whole)
    return {"microphone": microphone.tolist(), "level": level.T, "total_level": total, "orders": rows}


def _pressure_floor(floor: LineFloor, source: SoundSource, microphone: FloatArray) -> ComplexArray:
    """Return the sound pressure of a source per input of the lines left out, (G, e)."""
    estimate = source.radiation if isinstance(source.radiation, EstimatedRadiation) else None
    path = pressure_transfer(source.body, microphone, floor.frequency, estimate=estimate)
    force = seat_forces(floor, source.body, source.bearings)
    return np.asarray(np.sum(force * path.reshape(len(force), 1, -1), axis=-1))


def _decibels(square: FloatArray) -> FloatArray:
    """Return the level of mean squares, Pa^2, at least `FLOOR`."""
    least = 10.0 ** (FLOOR / 10.0)
    return np.asarray(10.0 * np.log10(np.maximum(square / REFERENCE_PRESSURE**2, least)))
