"""What a housing makes of a run, as recordings: velocity of a point, sound pressure at a microphone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.acoustics import Air, ElementalRadiators, Recording, principal_direction, series_recording
from dynamics.acoustics.recording import SAMPLE_RATE
from dynamics.acoustics.run_recording import unit_vector
from dynamics.checks import positive
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.noise.sound_pressure import MONOPOLES, pressure_signal, sound_limit
from dynamics.orders.resampling import low_passed
from dynamics.results import RunResult
from dynamics.types import FloatArray
from dynamics.vibration import finer_seat_forces, point_signal

FINER = 4
"""Times the run's rate, at which the force is a cubic spline."""


def velocity_recording(
    housing: ReducedHousing,
    run: RunResult,
    point: str,
    direction: FloatArray | None = None,
    bearings: Sequence[str] | None = None,
    to_rate: int = SAMPLE_RATE,
) -> Recording:
    """Return the velocity of a point of a housing under the bearing forces of a run, in m/s.

    Its orders are those of the forces through the transfer functions within 0.1 dB, up to the pass frequency
    of the run's output. The housing may be one that the scene of the run does not have; the forces of its
    bearings then lack what it does to them.

    Parameters
    ----------
    housing : ReducedHousing
        With mass.
    point : str
        Name of one of its points.
    direction : (3,) array, optional
        In the frame of the housing's mesh, of any length above zero; by default the `principal_direction`.
    bearings : sequence of str, optional
        In the order of the seats; by default those with the names of the seats.

    Raises
    ------
    InputError
        As `run_seat_forces`, `point_signal` and `series_recording`; or the direction is zero.
    """
    rate = FINER * run.sample_rate
    time, force = finer_seat_forces(run, housing, bearings, FINER)
    velocity = point_signal(housing, time, force, [point])[:, 0].T
    axis = principal_direction(velocity, rate)[0] if direction is None else unit_vector(direction)
    x, y, z = axis
    quantity = f"velocity of point {point} along ({x:.3f}, {y:.3f}, {z:.3f}); no sound pressure"
    return series_recording(np.asarray(axis @ velocity), rate, quantity, "m/s", to_rate)


def pressure_recording(
    housing: ReducedHousing,
    run: RunResult,
    microphone: FloatArray,
    bearings: Sequence[str] | None = None,
    model: ElementalRadiators = MONOPOLES,
    air: Air | None = None,
    to_rate: int = SAMPLE_RATE,
) -> Recording:
    """Return the sound pressure at a microphone in the free field over a run, in Pa.

    Its orders are those of the forces through `pressure_transfer` within 0.1 dB, delayed by the way through
    the air. It holds nothing above `sound_limit`, where modes or panels are missing, nor above the pass
    frequency of the run's output; its quantity states the lower. As in `velocity_recording`, the run may
    have moved in another housing.

    Parameters
    ----------
    housing : ReducedHousing
        With mass and a surface.
    microphone : (3,) array
        In the frame of the housing's mesh, m.
    bearings : sequence of str, optional
        In the order of the seats; by default those with the names of the seats.
    model : ElementalRadiators
    air : Air, optional

    Raises
    ------
    InputError
        As `run_seat_forces`, `pressure_signal` and `series_recording`; or the housing has no modes.
    """
    rate, valid = FINER * run.sample_rate, positive("valid_frequency", sound_limit(housing, air))
    limit = min(valid, float(run.receipt["sampling"]["pass_frequency"]))
    time, force = finer_seat_forces(run, housing, bearings, FINER)
    pressure = pressure_signal(housing, time, force, microphone, model, air)
    x, y, z = np.asarray(microphone, dtype=float)
    where = f"({x:.3f}, {y:.3f}, {z:.3f}) m in the free field"
    quantity = f"sound pressure at {where}, panels as {model.model_name}, up to {limit:.0f} Hz"
    return series_recording(low_passed(pressure, limit / rate), rate, quantity, "Pa", to_rate)
