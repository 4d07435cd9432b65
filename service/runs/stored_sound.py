"""The sound of a stored run as a WAV file; work of the live worker."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

import numpy as np

from dynamics.acoustics import wav_file
from dynamics.results import RunResult
from service.problems import BadInput
from service.runs.run_view import RunView, same_view, shown_signal
from service.runs.sound import Heard, full_scale_of, heard_runs

Json = dict[str, Any]
LONGEST = 300.0
"""s of a run that the service makes a file of: 58 MB."""


def stored_sound(inputs: Json) -> Json:
    """Return ``{"wav": base64}`` of the first of ``{"files": [...], "view": {...}}``, on one full scale.

    Raises
    ------
    BadInput
        The run does not hold what the view names, is silent or too long.
    """
    runs = [RunResult.from_netcdf(Path(file)) for file in inputs["files"]]
    for run in runs:
        lasting = float(np.ptp(run.time))
        if lasting > LONGEST:
            advice = "Fetch the file and write it by loa listen."
            raise BadInput.of("duration_s", lasting, f"at most {LONGEST:g} s", advice)
    view = RunView(**inputs["view"])
    first = Heard("", runs[0], shown_signal(runs[0], view))
    others = heard_runs(dict(zip(("against",), runs[1:], strict=False)), same_view(view, first.signal))
    recordings = [one.recording() for one in (first, *others)]
    wav = wav_file(recordings[0], full_scale_of(recordings))
    return {"wav": base64.b64encode(wav).decode("ascii")}
