"""``loa listen``: runs of a simulation as sounds, in WAV files.

A sound is the force on a bearing or another signal that the run holds; with a scene it is the sound pressure
or the motion that the housings of the scene make of it at a receiver. The full scale is the value
that a sample of 1.0 stands for; it is the same for all files, so that their loudness can be compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bounds import engineering
from dynamics.acoustics import wav_file
from lineofaction.cli.housing_sounds import housing_sounds, receiver_of
from lineofaction.cli.output import check_writable, console, output_of, print_json, table
from lineofaction.cli.run_sounds import RunSound, bearing_sounds
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import SOUND, run_in
from lineofaction.gearbox.studies.listen.run import recording_metadata
from lineofaction.report.comparison.compare import named_files
from lineofaction.report.document import read_run
from lineofaction.report.drawing.figure import number
from lineofaction.report.run.sound import full_scale_of
from lineofaction.report.run.view import RunView


def run_listen(
    run_paths: Sequence[Path],
    target: Path | None,
    view: RunView,
    *,
    scene: Path | None,
    point: str,
    microphone: str,
    as_json: bool,
) -> None:
    """Read the runs, write a WAV file of each with one full scale, and print a table of the sounds.

    `run_paths` are files or project folders; without a `target`, the first folder gets the output.
    """
    receiver = receiver_of(scene, point, microphone)
    project = next((path for path in run_paths if path.is_dir()), None)
    output = output_of(target, project, SOUND)
    files = [run_in(path) for path in run_paths]
    paths = _outputs(files, output)
    runs = {name: read_run(file, "runs") for name, file in named_files(files)}
    if scene is None or receiver is None:
        sounds, remark = bearing_sounds(runs, view)
    else:
        sounds, remark = housing_sounds(runs, scene, receiver, view, announced=not as_json)
    scale = full_scale_of([sound.recording for sound in sounds])
    if output.suffix != ".wav":
        output.mkdir(exist_ok=True)
    for path, sound in zip(paths, sounds, strict=True):
        path.write_bytes(wav_file(sound.recording, scale))
    if as_json:
        entries = [
            {"file": str(path), **recording_metadata(sound.recording), **sound.figures}
            for path, sound in zip(paths, sounds, strict=True)
        ]
        print_json({"full_scale": scale, "remark": remark, "files": entries})
        return
    _show(sounds, scale, remark)
    for path in paths:
        console().print(f"written to {path}", soft_wrap=True)


def _outputs(files: Sequence[Path], output: Path) -> list[Path]:
    """Return the WAV file for every run.

    Raises `BadInput`: several runs would go to one file, or to files of the same name, or the output cannot
    be written.
    """
    if output.suffix == ".wav":
        if len(files) > 1:
            raise BadInput.of("output", str(output), "a folder for several runs", "It gets a file per run.")
        check_writable(output)
        return [output]
    if output.is_file() or not (output.is_dir() or output.parent.is_dir()):  # a new folder needs a parent
        raise BadInput.of(
            "output", str(output), "a file ending in .wav, or a folder", "Make its parent first."
        )
    stems = [file.stem for file in files]
    if len(set(stems)) < len(stems):
        raise BadInput.of("files", ", ".join(map(str, files)), "runs of different file names", "Rename one.")
    return [output / f"{stem}.wav" for stem in stems]


def _show(sounds: Sequence[RunSound], scale: float, remark: str) -> None:
    """Print a table of the sounds, the quantities, the full scale and a remark on all sounds."""
    out = console()
    unit = sounds[0].recording.unit  # one full scale: one unit
    # columns that only some sounds have, in order, each once
    optional_columns = list(dict.fromkeys(name for sound in sounds for name in sound.cells))
    rows = [
        [
            sound.name,
            engineering(sound.recording.rms, 4),
            f"{sound.recording.samples.size / sound.recording.sample_rate:.3f}",
            *(sound.cells.get(name, "") for name in optional_columns),
        ]
        for sound in sounds
    ]
    columns = ["run", f"rms, {unit}", "s", *optional_columns]
    # the last optional column is text, if there is one
    out.print(table(columns, rows, text_columns=("run", *optional_columns[-1:])))
    for quantity in dict.fromkeys(sound.recording.quantity for sound in sounds):
        out.print(quantity, soft_wrap=True)
    out.print(f"full scale: {number(scale)} {unit}; {remark}", soft_wrap=True)
