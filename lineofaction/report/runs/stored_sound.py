"""The sound of a stored run or recording as a WAV file; work of the live worker."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dynamics.acoustics import Recording, wav_file
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.listen.heard_run import KIND, SCHEMA, HeardRun
from lineofaction.report.runs.run_view import RunView, same_view, shown_signal
from lineofaction.report.runs.sound import Heard, full_scale_of, heard_runs
from model_studies.record_file import read_record

Json = dict[str, Any]
LONGEST = 300.0
"""s of a run that the service makes a file of: 58 MB."""


def stored_sound(inputs: Json) -> Json:
    """Return ``{"wav": base64}`` of the first of ``{"files": [...], "view": {...}}``, on one full scale.

    Files are those of runs, seen by the view, or of recordings: ``"kind"``.

    Raises
    ------
    BadInput
        The run does not hold what the view names, is silent or too long; a view of a recording.
    """
    files = [Path(file) for file in inputs["files"]]
    recordings = (_recordings if inputs["kind"] == KIND else _of_runs)(files, inputs["view"])
    wav = wav_file(recordings[0], full_scale_of(recordings))
    return {"wav": base64.b64encode(wav).decode("ascii")}


def _of_runs(files: Sequence[Path], named: Mapping[str, Any]) -> list[Recording]:
    """Return what is shown of runs, all as of the first."""
    runs = [RunResult.from_netcdf(file) for file in files]
    for run in runs:
        _require_short(float(np.ptp(run.time)))
    view = RunView(**named)
    first = Heard("", runs[0], shown_signal(runs[0], view))
    others = heard_runs(dict(zip(("against",), runs[1:], strict=False)), same_view(view, first.signal))
    return [one.recording() for one in (first, *others)]


def _recordings(files: Sequence[Path], named: Mapping[str, Any]) -> list[Recording]:
    for name, value in named.items():
        if value:
            raise BadInput.of(name, value, "left out of a recording", "It holds one quantity.")
    recordings = [read_record(file, {SCHEMA: HeardRun}).recording for file in files]
    for recording in recordings:
        _require_short(recording.samples.size / recording.sample_rate)
    return recordings


def _require_short(lasting: float) -> None:
    """Refuse what lasts too long, s."""
    if lasting > LONGEST:
        advice = "Fetch the file of the run and write it by loa listen."
        raise BadInput.of("duration_s", lasting, f"at most {LONGEST:g} s", advice)
