"""Runs as sounds, of files and of a service's store."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bounds.types import Json
from dynamics.acoustics import Recording, common_full_scale, wav_file
from dynamics.acoustics.recording import PASSED, SAMPLE_RATE
from dynamics.errors import InputError
from dynamics.orders import driving_shaft
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.listen.run import KIND, SCHEMA, HeardRun
from lineofaction.report.drawing.figure import Axis, Sound, Track, number, unit_of
from lineofaction.report.run.view import (
    QUANTITIES,
    RunView,
    Signal,
    same_view,
    selected_signal,
    signal_recording,
)
from model_studies.record_file import read_record

PAGE_RATE, PAGE_BYTES, SAMPLE_BYTES = 24_000, 2_000_000, 4
"""Sampling rate, Hz, of a sound in a page whose run holds higher frequencies; most bytes of the sounds of a
plot; bytes of a sample."""
POINTS = 200  # number of times at which the place of a sound on its axis is known
LONGEST = 300.0
"""Longest run in s of which the service makes a sound file: 58 MB."""


@dataclass(frozen=True)
class RunSignal:
    """The signal of a run that is drawn and heard, with the name of the run."""

    name: str
    run: RunResult
    signal: Signal

    def recording(self, sample_rate: int = SAMPLE_RATE) -> Recording:
        """Return it as a recording; raises as `signal_recording`."""
        return signal_recording(self.run, self.signal, sample_rate)

    @property
    def query(self) -> dict[str, str]:
        """Return the query by which the service knows the signal."""
        name = next(key for key, value in QUANTITIES.items() if value is self.signal.quantity)
        part: dict[str, str] = {self.signal.quantity.part: self.signal.part}
        along = {"direction": self.signal.direction} if self.signal.direction else {}
        return {"quantity": name, **part, **along}


def run_signals(runs: dict[str, RunResult], view: RunView) -> Iterator[RunSignal]:
    """Yield the signals of named runs; what the view leaves open is selected by the first run for all.

    Raises `BadInput`: a run does not hold what the view names.
    """
    for name, run in runs.items():
        try:
            signal = selected_signal(run, view)
        except BadInput as error:
            raise error.within(name) from None
        yield RunSignal(name, run, signal)
        view = same_view(view, signal)


def full_scale_of(recordings: list[Recording]) -> float:
    """Return the common full scale; raises `BadInput`: their units differ."""
    try:
        return common_full_scale(*recordings)
    except InputError as error:
        raise BadInput.of(
            "files", "runs of several units", "runs that hold one quantity", f"{error}"
        ) from None


def sound_of(signals: tuple[RunSignal, ...], axis: Axis) -> Sound | None:
    """Return the sound of runs for a plot over `axis`, their speed or time; None: a run is silent."""
    highest = max(_passed(source) for source in signals)
    rate = PAGE_RATE if highest <= PASSED * PAGE_RATE else SAMPLE_RATE
    try:
        recordings = [source.recording(rate) for source in signals]
    except BadInput:
        return None
    scale = full_scale_of(recordings)
    fits = SAMPLE_BYTES * sum(recording.samples.size for recording in recordings) <= PAGE_BYTES
    what = ". ".join(dict.fromkeys(recording.quantity for recording in recordings))
    together = " of all, which play at their true relative level" if len(signals) > 1 else ""
    return Sound(
        f"Sound: {what}. From 20 Hz to {number(min(map(_passed, signals)), 3)} Hz, which the run holds. Full "
        f"scale{together}: {number(scale, 2)} {recordings[0].unit}.",
        tuple(_track(source, axis) for source in signals),
        tuple(wav_file(recording, scale) for recording in recordings) if fits else (),
    )


def _passed(source: RunSignal) -> float:
    """Return the highest frequency that a run holds, Hz."""
    return float(source.run.receipt["sampling"]["pass_frequency"])


def _track(source: RunSignal, axis: Axis) -> Track:
    """Return the track of a run: its place on the axis as it plays."""
    run = source.run
    time = np.linspace(float(run.time[0]), float(run.time[-1]), POINTS)
    axis_values = time
    if unit_of(axis.label) == "rpm":
        speed = run.speed[run.shaft.index(driving_shaft(run, source.signal.mesh))]
        axis_values = np.interp(time, run.time, np.abs(speed)) * 30.0 / np.pi
    mesh_frequency = np.interp(time, run.time, np.abs(run.mesh_frequency[source.signal.mesh]))
    return Track(source.name, time - time[0], axis_values, source.query, mesh_frequency)


def stored_sound(inputs: Json) -> Json:
    """Return ``{"wav": base64}`` of the first of one or two files, on the full scale of both.

    `inputs` is ``{"files": [...], "kind": ..., "view": {...}}``. By their kind the files are runs, of which
    the view names the signal, or recordings, which take no view.

    Raises `BadInput`: the run does not hold what the view names, is silent or too long; a view of a
    recording.
    """
    files = [Path(file) for file in inputs["files"]]
    recordings = (_recordings if inputs["kind"] == KIND else _of_runs)(files, inputs["view"])
    wav = wav_file(recordings[0], full_scale_of(recordings))
    return {"wav": base64.b64encode(wav).decode("ascii")}


def _of_runs(files: Sequence[Path], view_fields: Mapping[str, Any]) -> list[Recording]:
    """Return the signals of runs as recordings; the second run takes the view of the first."""
    runs = [RunResult.from_netcdf(file) for file in files]
    for run in runs:
        _require_short(float(np.ptp(run.time)))
    view = RunView(**view_fields)
    first = RunSignal("", runs[0], selected_signal(runs[0], view))
    others = run_signals(dict(zip(("against",), runs[1:], strict=False)), same_view(view, first.signal))
    return [source.recording() for source in (first, *others)]


def _recordings(files: Sequence[Path], view_fields: Mapping[str, Any]) -> list[Recording]:
    for name, value in view_fields.items():
        if value:
            raise BadInput.of(name, value, "left out of a recording", "It holds one quantity.")
    recordings = [read_record(file, {SCHEMA: HeardRun}).recording for file in files]
    for recording in recordings:
        _require_short(recording.samples.size / recording.sample_rate)
    return recordings


def _require_short(lasting: float) -> None:
    """Refuse a run that lasts too long, s."""
    if lasting > LONGEST:
        remedy = "Fetch the file of the run and write it by loa listen."
        raise BadInput.of("duration_s", lasting, f"at most {LONGEST:g} s", remedy)
