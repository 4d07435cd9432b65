"""Questions about the sound of flanks in a scene, and their refusals before anything is computed."""

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
    """The request of a study of sound: load cases, speeds, highest order of the mesh, and the quantity."""

    @property
    def load_cases(self) -> Sequence[LoadCaseInput]: ...  # noqa: D102
    @property
    def speed_rpm(self) -> Sequence[float]: ...  # noqa: D102
    @property
    def orders(self) -> int: ...  # noqa: D102
    @property
    def heard(self) -> HeardInput: ...  # noqa: D102


def check_receiver(scene: SceneInput, receiver: HeardInput) -> None:
    """Refuse a quantity or a place that a scene does not offer."""
    if receiver.quantity not in (None, BEARING_FORCE) or receiver.microphone_mm is not None:
        require_surface(scene)
    pressure = receiver.quantity == SOUND_PRESSURE or (
        receiver.quantity is None and receiver.microphone_mm is not None
    )
    if pressure != (receiver.microphone_mm is not None):
        bound = "given with sound_pressure" if pressure else f"left out with {receiver.quantity}"
        raise BadInput.of("heard.microphone_mm", receiver.microphone_mm, bound)
    if pressure or receiver.quantity == SURFACE_VELOCITY:
        housing_of(scene, receiver)
    known = [part.name for part in scene.bushings]
    known += [part.name for part in scene.rolling_bearings]
    known += [part.name for part in scene.planet_bearings]
    if not known:
        bound = "at least one bearing: what is heard passes through bearings"
        raise BadInput.of("scene.bushings", None, bound, "Give it bushings or rolling bearings.")
    if receiver.bearing is not None:
        _require_named("heard.bearing", receiver.bearing, known)


def check_driving(scene: SceneInput, load_cases: Sequence[LoadCaseInput]) -> None:
    """Refuse load cases that do not fit the scene, and loads on the coast flanks."""
    for index, case in enumerate(check_cases(scene, load_cases)):
        if case.direction != DRIVE:
            bound = f'"{DRIVE}": the flanks that are heard are the driving ones'
            raise BadInput.of(f"load_cases[{index}].direction", case.direction, bound)


def housing_of(scene: SceneInput, receiver: HeardInput) -> str:
    """Return the housing of the surface or microphone; raises `BadInput`."""
    known = [part.name for part in scene.housings if part.has_surface]
    if receiver.housing is None and len(known) == 1:
        return known[0]
    if receiver.housing is None:
        raise BadInput.of("heard.housing", None, f"one of {', '.join(known)}", "Name the housing.")
    _require_named("heard.housing", receiver.housing, known)
    return receiver.housing


def flank_mesh(scene: SceneInput, mesh: str | None) -> MeshInput:
    """Return the mesh whose flanks change; raises `BadInput`."""
    by_name = {part.name: part for part in scene.meshes if part.case or part.case_file}
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
        raise BadInput.of(field, name, f"one of {', '.join(known)}")
