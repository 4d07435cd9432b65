"""``loa listen``."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bounds import engineering
from dynamics.acoustics import Recording, wav_file
from dynamics.results import RunResult
from service.cli.output import check_writable, console, print_json, table
from service.comparison.compare import named_files
from service.drawing.figure import number, unit_of
from service.problems import BadInput
from service.report.inputs import read_result
from service.runs.loudest import Loudest, loudest
from service.runs.run_view import RunView
from service.runs.sound import Heard, full_scale_of, heard_runs

Json = dict[str, Any]
FAINT = 1e-3
"""Of the overall level: weaker orders are not printed."""


def run_listen(files: Sequence[Path], output: Path, view: RunView, *, as_json: bool) -> None:
    """Read the runs, write a WAV file of each on one full scale, print what they hold."""
    paths = _outputs(files, output)
    heard = heard_runs({name: _run(file) for name, file in named_files(files)}, view)
    recordings = [one.recording() for one in heard]
    scale = full_scale_of(recordings)
    if output.suffix != ".wav":
        output.mkdir(exist_ok=True)
    for path, recording in zip(paths, recordings, strict=True):
        path.write_bytes(wav_file(recording, scale))
    moments = [loudest(one.run, one.signal) for one in heard]
    if as_json:
        listed = zip(paths, recordings, moments, strict=True)
        print_json({"full_scale": scale, "files": [_facts(*one) for one in listed]})
        return
    _show(heard, recordings, moments, scale)
    for path in paths:
        console().print(f"written to {path}", highlight=False)


def _outputs(files: Sequence[Path], output: Path) -> list[Path]:
    """Return a file for every run.

    Raises
    ------
    BadInput
        Several runs would go to one file, to files of one name, or where nothing can be written.
    """
    if output.suffix == ".wav":
        if len(files) > 1:
            raise BadInput.of("output", str(output), "a folder for several runs", "It gets a file per run.")
        check_writable(output)
        return [output]
    if output.is_file() or not (output.is_dir() or output.parent.is_dir()):
        raise BadInput.of(
            "output", str(output), "a file ending in .wav, or a folder", "Make its parent first."
        )
    stems = [file.stem for file in files]
    if len(set(stems)) < len(stems):
        raise BadInput.of("files", ", ".join(map(str, files)), "runs of different file names", "Rename one.")
    return [output / f"{stem}.wav" for stem in stems]


def _run(file: Path) -> RunResult:
    """Read a run."""
    result = read_result(file)
    if not isinstance(result, RunResult):
        raise BadInput.of("runs", str(file), "a run", "It holds an STE database: loa simulate makes runs.")
    return result


def _rms(recording: Recording) -> float:
    """Return the root mean square of a recording."""
    return math.sqrt(float((recording.samples**2).mean()))


def _facts(path: Path, recording: Recording, moment: Loudest | None) -> Json:
    """Return what a file holds, in its unit."""
    facts: Json = {
        "file": str(path),
        "quantity": recording.quantity,
        "unit": recording.unit,
        "rms": _rms(recording),
        "duration_s": recording.samples.size / recording.sample_rate,
        "sample_rate_hz": recording.sample_rate,
        "loudest": None,
    }
    if moment is not None:
        orders = {str(order): value for order, value in moment.orders.items()}
        facts["loudest"] = {"time_s": moment.time, "rms": moment.overall, "orders_rms": orders}
    return facts


def _show(
    heard: Sequence[Heard], recordings: Sequence[Recording], moments: Sequence[Loudest | None], scale: float
) -> None:
    """Print the figures for people."""
    out, unit = console(), recordings[0].unit
    rows = [
        [
            one.name,
            engineering(_rms(made), 4),
            f"{made.samples.size / made.sample_rate:.3f}",
            *_moment(moment),
        ]
        for one, made, moment in zip(heard, recordings, moments, strict=True)
    ]
    columns = ["run", f"rms, {unit}", "s", "loudest at", f"orders there, dB re 1 {unit} rms"]
    out.print(table(columns, rows, words=("run", columns[-1])))
    for quantity in dict.fromkeys(one.quantity for one in recordings):
        out.print(quantity, highlight=False, soft_wrap=True)
    out.print(
        f"full scale: {number(scale)} {unit}; loudness is that of a sound pressure alone", highlight=False
    )


def _moment(moment: Loudest | None) -> tuple[str, str]:
    """Say where a run is loudest, and the levels of its orders there."""
    if moment is None:
        return "", "too short for orders"
    levels = [
        f"{order}x {20.0 * math.log10(value):.1f}"
        for order, value in moment.orders.items()
        if value > FAINT * moment.overall
    ]
    return f"{number(moment.where, 4)} {unit_of(moment.axis.label)}", ", ".join(levels)
