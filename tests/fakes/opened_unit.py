"""A REXS document opened: its scene as dynamics takes it, its account, its deflection on straight tables."""

import tomllib
from typing import Any

import numpy as np

from dynamics.deflection import CaseDeflection, MeshAlignment, deflect
from dynamics.scene import Scene
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.from_rexs.gear_unit import GearUnit
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.unit_files import SCENE_FILE
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.schemas import validated
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.studies.deflect import Inputs
from lineofaction.gearbox.studies.deflect.cases import load_cases
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks, Outline
from lineofaction.gearbox.studies.deflect.run import scene_of as kept_scene

HALF_FACE = 0.01
POSITIONS = 3


def scene_in_si(unit: OpenedUnit) -> Scene:
    assert unit.scene is not None, [line for line in unit.lines if line.fate == "refused"]
    facts = {f"{case.name}.toml": PairGeometry.of(gear_pair(case.case)) for case in unit.cases}
    return check_scene(unit.scene, {mesh.name: facts[str(mesh.case_file)] for mesh in unit.scene.meshes})


def deflection_of_unit(unit: OpenedUnit) -> GearboxDeflection:
    """Return the result as `loa deflect` keeps it, under all load cases of the unit."""
    scene = scene_in_si(unit)
    inputs = validated(Inputs, {"load_cases": [case.table() for case in unit.load_cases]})
    found = deflect(scene, load_cases(inputs.load_cases), POSITIONS)
    flanks = tuple(_flanks(case, mesh) for case in found.cases for mesh in case.meshes)
    cases = {case.name: case.case.model_dump(mode="json") for case in unit.cases}
    by_mesh = {name: cases[part.case] for name, part in unit.parts.meshes.items()}
    outline = Outline.of(scene)
    kept = kept_scene(validated(SceneInput, tomllib.loads(unit.files()[SCENE_FILE])))
    return GearboxDeflection(found, flanks, 2, 1e-9, True, outline, by_mesh, 1.0, kept)


def _flanks(case: CaseDeflection, mesh: MeshAlignment) -> MeshFlanks:
    """Return flanks whose load falls towards positive face positions."""
    along, roll = np.linspace(-HALF_FACE, HALF_FACE, 41), np.linspace(0.005, 0.02, 40)
    load = mesh.force / (2.0 * HALF_FACE) * (1.0 - 0.5 * along / HALF_FACE)
    stress = 1e9 * (1.0 - 0.3 * along / HALF_FACE) * (1.0 + roll[:, None])
    numbers = (1e-5, float("nan"), 1e-6, float("nan"), np.full(5, 1e-7), np.full(5, 1e-9))
    factor, largest = 1.5, float(stress.max())
    name, torque = mesh.name, 0.02 * mesh.force
    return MeshFlanks(name, case.name, torque, *numbers, factor, 0.0, largest, along, load, roll, stress)


def scene_of(document: Document) -> SceneInput:
    unit = OpenedUnit.of(document)
    scene_in_si(unit)
    assert unit.scene is not None
    return unit.scene


def content(scene: SceneInput) -> dict[str, Any]:
    """Return a scene, numbers to nine digits."""

    def plain(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: plain(item) for key, item in value.items()}
        if isinstance(value, list):
            return [plain(item) for item in value]
        return round(float(f"{value:.9g}"), 9) + 0.0 if isinstance(value, float) else value

    return dict(plain(scene.model_dump(mode="json", exclude_unset=True)))


def said(unit: OpenedUnit | GearUnit, component: int, item: str) -> tuple[str, str]:
    lines = unit.lines if isinstance(unit, OpenedUnit) else unit.account.lines()
    (line,) = [line for line in lines if (line.component, line.item) == (component, item)]
    return line.fate, line.words
