"""A REXS document opened: its scene, checked as dynamics takes it, and what the account says."""

from __future__ import annotations

from typing import Any

from fe_contact.ste import PairFacts
from lineofaction.gearbox.convert.case import gear_pair
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.from_rexs.opened import OpenedUnit, opened
from lineofaction.gearbox.rexs.model import Document
from lineofaction.gearbox.schemas.scene import SceneInput


def scene_of(document: Document) -> SceneInput:
    unit = opened(document)
    assert unit.scene is not None, [line for line in unit.lines if line.fate == "refused"]
    facts = {f"{case.name}.toml": PairFacts.of(gear_pair(case.case)) for case in unit.cases}
    check_scene(unit.scene, {mesh.name: facts[str(mesh.case_file)] for mesh in unit.scene.meshes})
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


def said(unit: OpenedUnit, component: int, item: str) -> tuple[str, str]:
    (line,) = [line for line in unit.lines if (line.component, line.item) == (component, item)]
    return line.fate, line.words
