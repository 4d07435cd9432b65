"""An opened gear unit as the answer of the service; a process of its own reads the file."""

from __future__ import annotations

import base64
import binascii
from dataclasses import asdict
from pathlib import Path
from typing import Any

from lineofaction.gearbox.convert.case import case_json
from lineofaction.gearbox.from_rexs.assumption import Assumption
from lineofaction.gearbox.from_rexs.files import report_lines
from lineofaction.gearbox.from_rexs.opened import OpenedUnit, opened
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.rexs import parsed

Json = dict[str, Any]


def unit_of_rexs(inputs: Json, _folder: Path) -> Json:
    """Return a gear unit as JSON; its scene has the cases of its meshes written out.

    Raises
    ------
    BadInput
        No base64, no REXS, no assumption, or as `opened`.
    """
    try:
        data = base64.b64decode(inputs["rexs_base64"], validate=True)
    except (binascii.Error, ValueError):
        raise BadInput.of("rexs_base64", inputs["rexs_base64"][:20], "base64 of the file's bytes") from None
    return unit_json(opened(parsed(data), [Assumption.of(text) for text in inputs.get("assume", ())]))


def unit_json(unit: OpenedUnit) -> Json:
    """Return an opened unit as JSON."""
    cases = {f"{case.name}.toml": case_json(case.case) for case in unit.cases}
    return {
        "left_out": list(unit.left_out),
        "cases": [
            {
                "name": case.name,
                "stage": case.stage,
                "equal": list(case.equal),
                "case": cases[f"{case.name}.toml"],
            }
            for case in unit.cases
        ],
        "scene": None if unit.scene is None else _whole(unit, cases),
        "load_cases": [{"forces": [], **case.table()} for case in unit.load_cases],
        "lines": [asdict(line) for line in unit.lines],
        "summary": list(report_lines(unit.lines)),
    }


def _whole(unit: OpenedUnit, cases: dict[str, Json]) -> Json:
    """Return the scene, its case files written out."""
    assert unit.scene is not None
    scene: Json = unit.scene.model_dump(mode="json", exclude_unset=True)
    for mesh in scene["meshes"]:
        mesh["case"] = cases[mesh.pop("case_file")]
    return scene
