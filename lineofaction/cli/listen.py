"""``loa listen``: runs as sounds, by what they hold or through the housings of a scene."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from bounds import engineering
from bounds.types import Json
from dynamics.acoustics import Recording, wav_file
from dynamics.results import RunResult
from host.directories import cache_home
from lineofaction.cli.guard import warn
from lineofaction.cli.output import check_writable, console, output_of, print_json, progress_bar, table
from lineofaction.cli.subjects import announce_cost, assessed_scene, listening_cost
from lineofaction.gearbox.convert.housings import HousedScene, housings_in
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import SOUND, run_in
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.listen import SoundPressure
from lineofaction.gearbox.studies.listen.run import (
    NO_LOUDNESS,
    HeardRun,
    Receiver,
    SceneHousings,
    SoundFigures,
    heard_run,
    recording_facts,
    rms,
)
from lineofaction.report.comparison.compare import named_files
from lineofaction.report.document import read_run
from lineofaction.report.drawing.figure import number, unit_of
from lineofaction.report.run.levels import Loudest, loudest
from lineofaction.report.run.sound import full_scale_of, heard_runs
from lineofaction.report.run.view import RunView

FAINT = 1e-3
"""Of the overall level: weaker orders are not printed."""


@dataclass(frozen=True)
class _RunSound:
    """A run as it is heard."""

    name: str
    recording: Recording
    facts: Json = field(default_factory=dict)
    """Plain JSON beside the recording's own."""
    cells: dict[str, str] = field(default_factory=dict)
    """What is printed in the columns of these names."""


def _bearing_sounds(runs: Mapping[str, RunResult], view: RunView) -> tuple[list[_RunSound], str]:
    """Return runs by what they hold, e.g. forces on a bearing, and what to say of all."""
    sounds = []
    for one in tuple(heard_runs(dict(runs), view)):
        recording, moment = one.recording(), loudest(one.run, one.signal)
        facts: Json = {"loudest": None}
        if moment is not None:
            orders = {str(order): value for order, value in moment.orders.items()}
            facts = {"loudest": {"time_s": moment.time, "rms": moment.overall, "orders_rms": orders}}
        sounds.append(_RunSound(one.name, recording, facts, _moment_cells(moment, recording.unit)))
    return sounds, NO_LOUDNESS


def _moment_cells(moment: Loudest | None, unit: str) -> dict[str, str]:
    """Say where a run is loudest, and the levels of its orders there."""
    where, text = "", "too short for orders"
    if moment is not None:
        levels = [
            f"{order}x {20.0 * math.log10(value):.1f}"
            for order, value in moment.orders.items()
            if value > FAINT * moment.overall
        ]
        where, text = f"{number(moment.where, 4)} {unit_of(moment.axis.label)}", ", ".join(levels)
    return {"loudest at": where, f"orders there, dB re 1 {unit} rms": text}


# What ``loa listen`` makes of runs through the housings of a scene: velocities, sound pressures.


def _receiver(scene: Path | None, point: str, microphone: str) -> Receiver | None:
    """Return where runs are heard by the options of the verb; None: as what the runs hold.

    Without both it is the microphone of the scene's complaint. Raises `BadInput`: both, one of these without
    a scene, or no position.
    """
    if scene is None and not point and not microphone:
        return None
    if scene is None or (point and microphone):
        given = [name for name, value in (("--point", point), ("--microphone", microphone)) if value]
        bound = "given with --scene, one of --point and --microphone"
        raise BadInput.of("--scene", None if scene is None else str(scene), bound, f"Given: {given}.")
    return Receiver(_position(microphone) if microphone else (), point)


def _position(text: str) -> tuple[float, ...]:
    """Return the position that X,Y,Z says, mm."""
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        bound = "three numbers in mm, X,Y,Z"
        raise BadInput.of("--microphone", text, bound, "For example 1000,0,200.") from None
    return x, y, z


def _housing_sounds(
    runs: Mapping[str, RunResult], file: Path, receiver: Receiver, view: RunView, *, announced: bool
) -> tuple[list[_RunSound], str]:
    """Return runs through the housings of a scene, and what to say of all."""
    receiver = replace(receiver, direction=view.direction)
    _require_no_view(view, receiver)
    scene, folder = assessed_scene(file)
    receiver = receiver.in_scene(scene)
    if receiver.microphone_mm and announced:
        sounding = sum(part.has_surface for part in scene.housings)
        durations = (float(run.time[-1] - run.time[0]) for run in runs.values())
        announce_cost("listen", [listening_cost(each, housings=sounding) for each in durations])
    sounds: list[_RunSound] = []
    remarks: list[str] = []
    with progress_bar() as report:
        bodies = housings_in(scene, cache_home(), folder, report)
        housings = SceneHousings.of(HousedScene(scene, bodies), Means(cache_home(), report))
        by_name = {name: _heard(name, run, housings, receiver) for name, run in runs.items()}
    for name, heard in by_name.items():
        warn(heard.warnings)
        sound = _RunSound(name, heard.recording)
        if heard.figures is not None:  # of a sound pressure, not of a velocity
            facts = {"sound": figures_of(SoundPressure, heard.figures)}
            sound = replace(sound, facts=facts, cells=_cells(heard.figures))
        sounds.append(sound)
        remarks += heard.remarks
    return sounds, "; ".join(dict.fromkeys(remarks))


def _heard(name: str, run: RunResult, housings: SceneHousings, receiver: Receiver) -> HeardRun:
    try:
        return heard_run(name, run, housings, receiver)
    except BadInput as error:
        raise error.within(name) from None


def _require_no_view(view: RunView, receiver: Receiver) -> None:
    named = {"quantity": view.quantity, "bearing": view.bearing, "mesh": view.mesh}
    if not receiver.point:
        named["direction"] = view.direction
    for name, value in named.items():
        if value:
            raise BadInput.of(f"--{name}", value, "left out with --microphone or --point")


def _cells(figures: SoundFigures) -> dict[str, str]:
    """Return what the ear makes of a sound pressure, as printed."""
    loudness = "without extra" if figures.loudness is None else engineering(figures.loudness, 3)
    sharpness = "" if figures.sharpness is None else engineering(figures.sharpness, 3)
    tones = ", ".join(number(hertz, 4) for hertz, _ in figures.tones)
    return {
        "dB": f"{figures.level:.1f}",
        "dB(A)": f"{figures.weighted_level:.1f}",
        "sone" if figures.steady else "sone (N5)": loudness,
        "acum": sharpness,
        "tones, Hz": tones if figures.steady else "not steady",
    }


# ``loa listen``.


def run_listen(
    named: Sequence[Path],
    target: Path | None,
    view: RunView,
    *,
    scene: Path | None,
    point: str,
    microphone: str,
    as_json: bool,
) -> None:
    """Read the runs, write a WAV file of each on one full scale, print what they hold."""
    receiver = _receiver(scene, point, microphone)
    output = output_of(target, next((name for name in named if name.is_dir()), None), SOUND)
    files = [run_in(name) for name in named]
    paths = _outputs(files, output)
    runs = {name: read_run(file, "runs") for name, file in named_files(files)}
    if scene is None or receiver is None:
        sounds, remark = _bearing_sounds(runs, view)
    else:
        sounds, remark = _housing_sounds(runs, scene, receiver, view, announced=not as_json)
    scale = full_scale_of([sound.recording for sound in sounds])
    if output.suffix != ".wav":
        output.mkdir(exist_ok=True)
    for path, sound in zip(paths, sounds, strict=True):
        path.write_bytes(wav_file(sound.recording, scale))
    if as_json:
        listed = [
            {"file": str(path), **recording_facts(sound.recording), **sound.facts}
            for path, sound in zip(paths, sounds, strict=True)
        ]
        print_json({"full_scale": scale, "remark": remark, "files": listed})
        return
    _show(sounds, scale, remark)
    for path in paths:
        console().print(f"written to {path}", soft_wrap=True)


def _outputs(files: Sequence[Path], output: Path) -> list[Path]:
    """Return a file for every run.

    Raises `BadInput`: several runs would go to one file, to files of one name, or where nothing can be
    written.
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


def _show(sounds: Sequence[_RunSound], scale: float, remark: str) -> None:
    out, unit = console(), sounds[0].recording.unit
    more = list(dict.fromkeys(name for sound in sounds for name in sound.cells))
    rows = [
        [
            sound.name,
            engineering(rms(sound.recording), 4),
            f"{sound.recording.samples.size / sound.recording.sample_rate:.3f}",
            *(sound.cells.get(name, "") for name in more),
        ]
        for sound in sounds
    ]
    columns = ["run", f"rms, {unit}", "s", *more]
    out.print(table(columns, rows, words=("run", *more[-1:])))
    for quantity in dict.fromkeys(sound.recording.quantity for sound in sounds):
        out.print(quantity, soft_wrap=True)
    out.print(f"full scale: {number(scale)} {unit}; {remark}", soft_wrap=True)
