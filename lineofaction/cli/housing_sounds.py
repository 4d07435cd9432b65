"""Runs as sounds through the housings of a scene: velocities, sound pressures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from bounds import engineering
from dynamics.acoustics import SoundFigures
from dynamics.results import RunResult
from host.directories import cache_home
from lineofaction.cli.costs import announce_cost, listening_cost
from lineofaction.cli.run_sounds import RunSound
from lineofaction.cli.subjects import assessed_scene
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.housings import HousedScene, housings_in
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.gearbox.studies.computation import Means
from lineofaction.gearbox.studies.figures import figures_of
from lineofaction.gearbox.studies.listen import SoundPressure
from lineofaction.gearbox.studies.listen.run import HeardRun, Receiver, SceneHousings, received_run
from lineofaction.report.drawing.figure import number
from lineofaction.report.run.view import RunView


def receiver_of(scene: Path | None, point: str, microphone: str) -> Receiver | None:
    """Return the receiver that the options name; None: without options, sounds are of forces and motions.

    A scene without point and microphone gives the microphone of its complaint. Raises `BadInput`: point and
    microphone are both given, one of them is given without a scene, or the microphone is no position.
    """
    if scene is None and not point and not microphone:
        return None
    if scene is None or (point and microphone):
        options = [name for name, value in (("--point", point), ("--microphone", microphone)) if value]
        bound = "given with --scene, one of --point and --microphone"
        raise BadInput.of("--scene", None if scene is None else str(scene), bound, f"Given: {options}.")
    return Receiver(_position(microphone) if microphone else (), point)


def _position(text: str) -> tuple[float, ...]:
    """Return the position that X,Y,Z says, mm."""
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        bound = "three numbers in mm, X,Y,Z"
        raise BadInput.of("--microphone", text, bound, "For example 1000,0,200.") from None
    return x, y, z


def housing_sounds(
    runs: Mapping[str, RunResult], file: Path, receiver: Receiver, view: RunView, *, announced: bool
) -> tuple[list[RunSound], str]:
    """Return runs through the housings of a scene, and a remark on all of them."""
    receiver = replace(receiver, direction=view.direction)
    _require_no_view(view, receiver)
    scene, folder = assessed_scene(file)
    receiver = receiver.in_scene(scene)
    if receiver.microphone_mm and announced:
        sounding = sum(part.has_surface for part in scene.housings)
        durations = (float(run.time[-1] - run.time[0]) for run in runs.values())
        announce_cost("listen", [listening_cost(duration, housings=sounding) for duration in durations])
    sounds: list[RunSound] = []
    remarks: list[str] = []
    with progress_bar() as report:
        bodies = housings_in(scene, cache_home(), folder, report)
        housings = SceneHousings.of(HousedScene(scene, bodies), Means(cache_home(), report))
        by_name = {name: _run_sound(name, run, housings, receiver) for name, run in runs.items()}
    for name, audio in by_name.items():
        warn(audio.warnings)
        sound = RunSound(name, audio.recording)
        if audio.figures is not None:  # of a sound pressure, not of a velocity
            figures = {"sound": figures_of(SoundPressure, audio.figures)}
            sound = replace(sound, figures=figures, cells=_cells(audio.figures))
        sounds.append(sound)
        remarks += audio.remarks
    return sounds, "; ".join(dict.fromkeys(remarks))


def _run_sound(name: str, run: RunResult, housings: SceneHousings, receiver: Receiver) -> HeardRun:
    try:
        return received_run(name, run, housings, receiver)
    except BadInput as error:
        raise error.within(name) from None


def _require_no_view(view: RunView, receiver: Receiver) -> None:
    """Refuse options that choose a force or a motion of the run, which a receiver does not have."""
    named = {"quantity": view.quantity, "bearing": view.bearing, "mesh": view.mesh}
    if not receiver.point:
        named["direction"] = view.direction
    for name, value in named.items():
        if value:
            raise BadInput.of(f"--{name}", value, "left out with --microphone or --point")


def _cells(figures: SoundFigures) -> dict[str, str]:
    """Return the hearing figures of a sound pressure as printed cells."""
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
