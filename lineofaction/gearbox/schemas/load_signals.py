"""Speeds of drives and torques of loads from channels of recordings, written out in the scene."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.faults import faults_of
from lineofaction.gearbox.schemas.model import BoundaryModel, Number
from lineofaction.gearbox.signals.units import SPEED, TORQUE
from lineofaction.gearbox.units import RPM

FIELD = "signal"
MAX = 100_000
"""Times that a course of a scene may have."""
_REMEDY = "Give average_s, the length of time over which the channel is averaged, or start_s and end_s."
_BY_CLIENT = "Run the scene by loa or the Python client: they read the recording and send its numbers."

FloatArray = NDArray[np.float64]
Find: TypeAlias = Callable[[str, str], Path]
Table = dict[str, Any]


class LoadSignalInput(BoundaryModel):
    """A channel of a recording as the course of a speed or a torque."""

    file: str = Field(
        min_length=1,
        max_length=255,
        description="The recording, relative to the scene file",
        examples=["a.mf4"],
    )
    channel: str = Field(
        default="",
        max_length=255,
        description="Channel of the recording; left out: the only one of a speed or of a torque",
        examples=["Speed"],
    )
    unit: str = Field(
        default="",
        max_length=20,
        description="Unit of the channel; left out: the unit in the file",
        examples=["rpm"],
    )
    scale: Number = Field(default=1.0, description="Factor of the values", examples=[-1.0])
    start_s: Number | None = Field(
        default=None,
        description="Time of the recording that is 0 in the run; left out: its first",
        examples=[12.5],
    )
    end_s: Number | None = Field(
        default=None,
        description="Time of the recording at which it ends; left out: its last",
        examples=[20.0],
    )
    average_s: float | None = Field(
        default=None, gt=0.0, le=1e3, description="Length of the means that are taken", examples=[0.02]
    )


class _Course(NamedTuple):
    """Field of a part that takes a channel: its name, the quantity, and the SI value of one unit."""

    field: str
    quantity: str
    si: float
    others: tuple[str, ...]


_COURSES = {
    "drives": _Course("speed_rpm", SPEED, RPM, ("time_s", "speed_rpm", "angle_deg")),
    "loads": _Course("torque_n_m", TORQUE, 1.0, ("time_s", "torque_n_m")),
}


def with_load_signals(table: Table, find: Find, *, read: bool) -> Table:
    """Return the table of a scene with times and values in place of the recordings that it names.

    Raises `BadInput`: a recording is named beside the values, is not to be read here, or cannot be; has no
    such channel, another unit, or too many samples.
    """
    changed = dict(table)
    for kind, course in _COURSES.items():
        if isinstance(parts := table.get(kind), list):
            changed[kind] = [
                _written_out(part, course, find, f"{kind}[{index}]", read=read)
                for index, part in enumerate(parts)
            ]
    return changed


def _written_out(part: object, course: _Course, find: Find, path: str, *, read: bool) -> object:
    if not isinstance(part, dict) or FIELD not in part:
        return part
    field = f"{path}.{FIELD}"
    others = [name for name in course.others if name in part]
    if others:
        raise BadInput.of(f"{path}.{others[0]}", part[others[0]], f"left out beside {FIELD}", "Keep one.")
    try:
        signal = LoadSignalInput.model_validate(part[FIELD])
    except ValidationError as error:
        raise BadInput(faults_of(error, LoadSignalInput)).within(field) from None
    if not read:
        raise BadInput.of(
            field, signal.file, "left out: a service opens no recordings of its callers", _BY_CLIENT
        )
    time, values = _series(signal, course, find, field)
    fields = {name: value for name, value in part.items() if name != FIELD}
    return fields | {"time_s": time.tolist(), course.field: values.tolist()}


def _series(
    signal: LoadSignalInput, course: _Course, find: Find, field: str
) -> tuple[FloatArray, FloatArray]:
    """Return times (n,) in s from 0, and values (n,) in the unit of the scene's field."""
    names = (signal.channel,) if signal.channel else ()
    from lineofaction.gearbox.signals.recording import read_recording  # noqa: PLC0415 (a client reads no files)

    recording = read_recording(find(signal.file, f"{field}.file"), f"{field}.file", names)
    channel = recording.channel(f"{field}.channel", signal.channel, (course.quantity,))
    time, values = channel.measured(f"{field}.channel", course.quantity, signal.unit)
    start = time[0] if signal.start_s is None else signal.start_s
    end = time[-1] if signal.end_s is None else signal.end_s
    if not time[0] <= start < end <= time[-1]:
        bound = f"a stretch of the recording, {time[0]:.6g} to {time[-1]:.6g} s"
        raise BadInput.of(f"{field}.start_s", f"{start:.6g} to {end:.6g} s", bound)
    time, values = _stretch(time, values, start, end)
    if signal.average_s is not None:
        time, values = _averaged(time, values, signal.average_s, f"{field}.average_s")
    if time.size > MAX:
        raise BadInput.of(field, f"{channel.name}: {time.size} samples", f"at most {MAX} samples", _REMEDY)
    return time - start, signal.scale / course.si * values


def _stretch(time: FloatArray, values: FloatArray, start: float, end: float) -> tuple[FloatArray, FloatArray]:
    """Return the samples between two times, with values at both."""
    inside = time[(time > start) & (time < end)]
    cut = np.concatenate([[start], inside, [end]])
    return cut, np.interp(cut, time, values)


def _averaged(
    time: FloatArray, values: FloatArray, length: float, field: str
) -> tuple[FloatArray, FloatArray]:
    """Return the means over lengths of time at their middles: the integral, as the turns of a speed, stays.

    Raises `BadInput`: there are fewer than two of them, or more than the samples.
    """
    count = int((time[-1] - time[0]) / length + 1e-9)
    if not 2 <= count <= time.size:
        low, high = (time[-1] - time[0]) / time.size, 0.5 * (time[-1] - time[0])
        raise BadInput.of(field, length, f"from {low:.3g} s, a sample, to {high:.3g} s, half the stretch")
    edges = time[0] + length * np.arange(count + 1)
    integral = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(time) * (values[1:] + values[:-1]))])
    piece = np.clip(np.searchsorted(time, edges, side="right") - 1, 0, time.size - 2)
    into = edges - time[piece]
    slope = (values[piece + 1] - values[piece]) / (time[piece + 1] - time[piece])
    upto = integral[piece] + into * (values[piece] + 0.5 * slope * into)
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(upto) / length
