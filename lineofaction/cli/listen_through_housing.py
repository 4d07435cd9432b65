"""What ``loa listen`` makes of runs through the housings of a scene: velocities, sound pressures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from bounds import engineering
from dynamics.results import RunResult
from host.directories import cache_home
from lineofaction.cli.assessed_case import assessed_scene
from lineofaction.cli.listen_sounds import RunSound
from lineofaction.cli.output import progress_bar
from lineofaction.cli.warned import warn
from lineofaction.gearbox.convert.housings import HousedScene, housings_in
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.listen.heard_run import Receiver, heard_run, sound_facts
from lineofaction.gearbox.studies.listen.sound_figures import SoundFigures
from lineofaction.gearbox.studies.listen.through_housing import SceneHousings
from lineofaction.report.drawing.figure import number
from lineofaction.report.runs.run_view import RunView


@dataclass(frozen=True)
class HousingReceiver:
    """A scene file, and where runs are heard through its housings."""

    scene: Path
    receiver: Receiver


def housing_receiver(scene: Path | None, point: str, microphone: str) -> HousingReceiver | None:
    """Return where runs are heard by the options of the verb; None: as what the runs hold.

    Raises
    ------
    BadInput
        A scene without one of point and microphone, one of these without a scene, or no position.
    """
    if scene is None and not point and not microphone:
        return None
    if scene is None or bool(point) == bool(microphone):
        given = [name for name, value in (("--point", point), ("--microphone", microphone)) if value]
        bound = "given with --scene, one of --point and --microphone"
        raise BadInput.of("--scene", None if scene is None else str(scene), bound, f"Given: {given}.")
    return HousingReceiver(scene, Receiver(_position(microphone) if microphone else (), point))


def _position(text: str) -> tuple[float, ...]:
    """Return the position that X,Y,Z says, mm."""
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        bound = "three numbers in mm, X,Y,Z"
        raise BadInput.of("--microphone", text, bound, "For example 1000,0,200.") from None
    return x, y, z


def housing_sounds(
    runs: Mapping[str, RunResult], through: HousingReceiver, view: RunView
) -> tuple[list[RunSound], str]:
    """Return runs through the housings of a scene, and what to say of all."""
    receiver = replace(through.receiver, direction=view.direction)
    _require_no_view(view, receiver)
    scene, folder = assessed_scene(through.scene)
    with progress_bar() as report:
        bodies = housings_in(scene, cache_home(), folder, report)
    housings = SceneHousings.of(HousedScene(scene, bodies))
    sounds: list[RunSound] = []
    remarks: list[str] = []
    for name, run in runs.items():
        try:
            heard = heard_run(name, run, housings, receiver)
        except BadInput as error:
            raise error.within(name) from None
        warn(heard.warnings)
        cells = {} if heard.figures is None else _figures_cells(heard.figures)
        sounds.append(RunSound(name, heard.recording, sound_facts(heard), cells))
        remarks += heard.remarks
    return sounds, "; ".join(dict.fromkeys(remarks))


def _require_no_view(view: RunView, receiver: Receiver) -> None:
    """Refuse options for what a run itself holds."""
    named = {"quantity": view.quantity, "bearing": view.bearing, "mesh": view.mesh}
    if not receiver.point:
        named["direction"] = view.direction
    for name, value in named.items():
        if value:
            raise BadInput.of(f"--{name}", value, "left out with --microphone or --point")


def _figures_cells(figures: SoundFigures) -> dict[str, str]:
    """Say what the ear makes of a sound."""
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
