"""Velocity of a point of a housing over a run as a recording: structure-borne, no sound pressure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.acoustics import Recording, principal_direction, series_recording
from dynamics.acoustics.recording import SAMPLE_RATE
from dynamics.acoustics.run_recording import unit_vector
from dynamics.housing_modes.reduced_housing import ReducedHousing
from dynamics.orders.resampling import interpolated
from dynamics.results import RunResult
from dynamics.types import FloatArray
from dynamics.vibration import point_signal, run_seat_forces

FINER, HALF_LENGTH = 4, 24
"""Times the run's rate, at which the force is a cubic spline; of the filter, in samples of the run."""


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
    force, rate = run_seat_forces(run, housing, bearings), FINER * run.sample_rate
    finer = np.stack([interpolated(row, FINER, HALF_LENGTH) for row in force.T], axis=1)
    time = run.time[0] + np.arange(len(finer)) / rate
    velocity = point_signal(housing, time, finer, [point])[:, 0].T
    axis = principal_direction(velocity, rate)[0] if direction is None else unit_vector(direction)
    x, y, z = axis
    quantity = f"velocity of point {point} along ({x:.3f}, {y:.3f}, {z:.3f}); no sound pressure"
    return series_recording(np.asarray(axis @ velocity), rate, quantity, "m/s", to_rate)
