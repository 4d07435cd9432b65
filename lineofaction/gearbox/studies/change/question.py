"""What is heard of flanks in a scene: refusals before anything is computed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from dynamics.settings.load_case import DRIVE
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.meshes import MeshInput
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.change import BEARING_FORCE, SOUND_PRESSURE, SURFACE_VELOCITY, HeardInput
from lineofaction.gearbox.studies.deflect import LoadCaseInput
from lineofaction.gearbox.studies.deflect.cases import check_cases
from lineofaction.gearbox.studies.housings import require_surface


class HeardQuestion(Protocol):
    """What is heard, and under what: the load cases, at speeds, up to so many orders of the mesh."""

    @property
    def load_cases(self) -> Sequence[LoadCaseInput]: ...  # noqa: D102
    @property
    def speed_rpm(self) -> Sequence[float]: ...  # noqa: D102
    @property
    def orders(self) -> int: ...  # noqa: D102
    @property
    def heard(self) -> HeardInput: ...  # noqa: D102


def check_heard(scene: SceneInput, heard: HeardInput) -> None:
    """Refuse what a scene does not let hear."""
    if heard.quantity not in (None, BEARING_FORCE) or heard.microphone_mm is not None:
        require_surface(scene)
    pressure = heard.quantity == SOUND_PRESSURE or (
        heard.quantity is None and heard.microphone_mm is not None
    )
    if pressure != (heard.microphone_mm is not None):
        bound = "given with sound_pressure" if pressure else f"left out with {heard.quantity}"
        raise BadInput.of("heard.microphone_mm", heard.microphone_mm, bound)
    if pressure or heard.quantity == SURFACE_VELOCITY:
        heard_housing(scene, heard)
    if heard.bearing is not None:
        known = [part.name for part in scene.bushings]
        known += [part.name for part in scene.rolling_bearings]
        known += [part.name for part in scene.planet_bearings]
        _require_named("heard.bearing", heard.bearing, known)


def check_driving(scene: SceneInput, load_cases: Sequence[LoadCaseInput]) -> None:
    """Refuse load cases that cannot be, and loads on other than the driving flanks."""
    for index, case in enumerate(check_cases(scene, load_cases)):
        if case.direction != DRIVE:
            bound = f'"{DRIVE}": the flanks that are heard are the driving ones'
            raise BadInput.of(f"load_cases[{index}].direction", case.direction, bound)


def heard_housing(scene: SceneInput, heard: HeardInput) -> str:
    """Return the housing whose surface is heard; raises `BadInput`."""
    known = [part.name for part in scene.housings if part.has_surface]
    if heard.housing is None and len(known) == 1:
        return known[0]
    if heard.housing is None:
        raise BadInput.of("heard.housing", None, f"one of {', '.join(known)}", "Name the housing.")
    _require_named("heard.housing", heard.housing, known)
    return heard.housing


def heard_mesh(scene: SceneInput, mesh: str | None) -> MeshInput:
    """Return the mesh whose flanks are heard; raises `BadInput`."""
    by_name = {each.name: each for each in scene.meshes if each.case or each.case_file}
    if mesh is None and len(by_name) == 1:
        return next(iter(by_name.values()))
    if not by_name:
        raise BadInput.of("scene.meshes", None, "at least one mesh with a case", "Give it case or case_file.")
    if mesh is None:
        raise BadInput.of("mesh", None, f"one of {', '.join(by_name)}", "Name the mesh of the flanks.")
    _require_named("mesh", mesh, list(by_name))
    return by_name[mesh]


def _require_named(field: str, name: str, known: list[str]) -> None:
    if name not in known:
        raise BadInput.of(field, name, f"one of {', '.join(known)}" if known else "left out: there is none")
