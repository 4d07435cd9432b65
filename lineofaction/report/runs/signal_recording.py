"""The shown quantity of a run along one direction: as orders are made of it, and as a recording."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.acoustics import Recording, principal_direction, series_recording
from dynamics.acoustics.recording import SAMPLE_RATE
from dynamics.errors import InputError
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.listen.through_housing import PRINCIPAL
from lineofaction.report.drawing.figure import FloatArray, number
from lineofaction.report.runs.run_view import Signal

ROUNDING = 1e-12  # of the largest value: what varies less is constant


def along_direction(run: RunResult, signal: Signal) -> RunResult:
    """Return the run with the quantity along the signal's direction alone, (rows, 1, T); whole without one.

    Raises
    ------
    BadInput
        The direction is the principal one of what does not vary.
    """
    if not signal.direction:
        return run
    values = getattr(run, signal.quantity.series)
    along = np.einsum("c,bct->bt", _axis(run, signal)[0], values)[:, None]
    return replace(run, **{signal.quantity.series: along})


def signal_recording(run: RunResult, signal: Signal, sample_rate: int = SAMPLE_RATE) -> Recording:
    """Return what is shown of a run as a recording in the signal's unit; of bearings along one direction.

    Raises
    ------
    BadInput
        It does not vary, or the run is shorter than 4 samples.
    """
    values, where = getattr(run, signal.quantity.series)[signal.row], ""
    if values.ndim == 2:
        axis, where = _axis(run, signal)
        values = axis @ values
    name, unit = f"{signal.name}{where}; no sound pressure", signal.quantity.unit
    try:
        recording = series_recording(
            signal.quantity.factor * values, run.sample_rate, name, unit, sample_rate
        )
    except InputError as error:
        raise _silent(signal, error) from None
    if not recording.peak > ROUNDING * np.abs(signal.quantity.factor * values).max():
        raise _silent(signal, "It is silent.")
    return recording


def _axis(run: RunResult, signal: Signal) -> tuple[FloatArray, str]:
    """Return the direction (3,) of a vector that is heard, and what to say of it beside the signal's name."""
    if signal.direction not in ("", PRINCIPAL):
        return np.eye(3)["xyz".index(signal.direction)], ""
    values = getattr(run, signal.quantity.series)[signal.row]
    try:
        axis, share = principal_direction(values, run.sample_rate)
    except InputError as error:
        raise _silent(signal, error) from None
    x, y, z = axis
    joint = "," if signal.direction else " along"
    return axis, f"{joint} ({x:.3f}, {y:.3f}, {z:.3f}), {number(100.0 * share, 3)} % of its variance"


def _silent(signal: Signal, reason: object) -> BadInput:
    return BadInput.of("quantity", signal.name, "one that varies over the run", f"{reason}")
