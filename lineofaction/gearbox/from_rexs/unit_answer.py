"""An opened gear unit as the answer of the service; a confined process reads the file."""

from __future__ import annotations

import base64
import binascii
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.from_rexs.assumptions import Assumption
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs.files import parsed
from lineofaction.gearbox.schemas.scene import SceneInput

Json = dict[str, Any]


def unit_of_rexs(inputs: Json, _folder: Path, _announce: Callable[[str], None]) -> Json:
    """Return a gear unit as JSON; its scene has the cases of its meshes written out.

    Raises `BadInput`: no base64, no REXS, no assumption, or as `OpenedUnit.of`.
    """
    try:
        data = base64.b64decode(inputs["rexs_base64"], validate=True)
    except (binascii.Error, ValueError):
        raise BadInput.of("rexs_base64", inputs["rexs_base64"][:20], "base64 of the file's bytes") from None
    return unit_json(OpenedUnit.of(parsed(data), [Assumption.of(text) for text in inputs.get("assume", ())]))


def unit_json(unit: OpenedUnit) -> Json:
    """Return an opened unit as JSON."""
    cases = [
        {"name": c.name, "stage": c.stage, "equal": list(c.equal), "case": case_json(c.case)}
        for c in unit.cases
    ]
    return {
        "left_out": list(unit.omitted),
        "cases": cases,
        "scene": None if unit.scene is None else _with_cases(unit.scene, cases),
        "load_cases": [{"forces": [], **case.table()} for case in unit.load_cases],
        "lines": [asdict(line) for line in unit.lines],
        "summary": list(unit.summary()),
    }


def _with_cases(scene: SceneInput, cases: list[Json]) -> Json:
    by_file = {f"{case['name']}.toml": case["case"] for case in cases}
    table: Json = scene.model_dump(mode="json", exclude_unset=True)
    for mesh in table["meshes"]:
        mesh["case"] = by_file[mesh.pop("case_file")]
    return table
