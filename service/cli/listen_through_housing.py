"""What ``loa listen`` makes of runs through the housings of a scene: velocities, sound pressures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bounds import engineering
from dynamics.results import RunResult
from service.cli.listen_sounds import NO_LOUDNESS, RunSound
from service.cli.output import progress_bar
from service.cli.warned import warn
from service.client.portable import scene_of
from service.convert.housings import modes_in_files, reduced_in
from service.directories import cache_home
from service.drawing.figure import number
from service.problems import BadInput
from service.runs.run_view import RunView
from service.runs.sound_figures import SoundFigures, sound_figures
from service.runs.through_housing import SceneHousings

Json = dict[str, Any]
FREE_FIELD = (
    "free field: no room, floor or attached parts; the air is at rest and does not act back. Panels as "
    "monopoles neither scatter nor shadow: at one place mostly 7 dB too low to 2 dB too high, and lower "
    "where the housing is larger than the wavelength"
)


@dataclass(frozen=True)
class HousingReceiver:
    """Where runs are heard through the housings of a scene: at a point, or at a microphone (mm)."""

    scene: Path
    point: str = ""
    microphone_mm: tuple[float, ...] = ()


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
    return HousingReceiver(scene, point, _position(microphone) if microphone else ())


def _position(text: str) -> tuple[float, ...]:
    """Return the position that X,Y,Z says, mm."""
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        bound = "three numbers in mm, X,Y,Z"
        raise BadInput.of("--microphone", text, bound, "For example 1000,0,200.") from None
    return x, y, z


def housing_sounds(
    runs: Mapping[str, RunResult], receiver: HousingReceiver, view: RunView
) -> tuple[list[RunSound], str]:
    """Return runs through the housings of a scene, and what to say of all."""
    _require_no_view(view, receiver)
    scene, folder = scene_of(receiver.scene)
    with progress_bar() as report:
        bodies = reduced_in(scene, cache_home(), report) | modes_in_files(scene, folder)
    housings = SceneHousings(bodies, {part.name: part.bushings for part in scene.housings})
    sounds = []
    for name, run in runs.items():
        warn(_strangers(name, housings.strangers(run)))
        try:
            sounds.append(_through(name, run, housings, receiver, view.direction))
        except BadInput as error:
            raise error.within(name) from None
    return sounds, NO_LOUDNESS if receiver.point else FREE_FIELD


def _through(
    name: str, run: RunResult, housings: SceneHousings, receiver: HousingReceiver, direction: str
) -> RunSound:
    """Return one run through the housings."""
    if receiver.point:
        return RunSound(name, housings.velocity(run, receiver.point, direction))
    recording = housings.pressure(run, receiver.microphone_mm)
    figures = sound_figures(recording, run)
    return RunSound(name, recording, {"sound": _figures_facts(figures)}, _figures_cells(figures))


def _require_no_view(view: RunView, receiver: HousingReceiver) -> None:
    """Refuse options for what a run itself holds."""
    heard = {"quantity": view.quantity, "bearing": view.bearing, "mesh": view.mesh}
    if not receiver.point:
        heard["direction"] = view.direction
    for name, value in heard.items():
        if value:
            raise BadInput.of(f"--{name}", value, "left out with --microphone or --point")


def _strangers(run: str, names: Sequence[str]) -> list[Json]:
    """Warn of housings that the scene of a run did not have."""
    message = 'run {}: it did not move in housing "{}" as the scene has it; its forces lack what that does'
    return [{"check": "other_housing", "message": message.format(run, name)} for name in names]


def _figures_facts(figures: SoundFigures) -> Json:
    """Return figures of a sound pressure as JSON."""
    return {
        "level_db": figures.level,
        "level_db_a": figures.weighted_level,
        "steady": figures.steady,
        "loudness_sone": figures.loudness,
        "sharpness_acum": figures.sharpness,
        "tones": [{"frequency_hz": hertz, "tone_to_noise_db": ratio} for hertz, ratio in figures.tones],
    }


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
