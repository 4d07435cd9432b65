"""Expectations of normalized inputs: implausible values, and the predicted cost."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any

from pydantic import ValidationError

from fe_contact.analysis.request.model_choice import decide
from fe_contact.ste import PairGeometry
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.case_plausibility import case_warnings, unique
from lineofaction.gearbox.convert.plausibility import scene_warnings, within
from lineofaction.gearbox.convert.scene import check_scene
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.schemas.scene import SceneInput
from service.worker.preparations import CASES

Json = dict[str, Any]


@lru_cache(maxsize=256)
def input_warnings(inputs: str) -> tuple[Json, ...]:
    """Return the warnings of normalized inputs, JSON.

    Inputs without case and scene have none, nor have inputs of an older job that are refused today.
    """
    document = json.loads(inputs)
    try:
        if document.get("scene") is not None:
            return tuple(_of_scene(SceneInput.model_validate_json(json.dumps(document["scene"]))))
        return () if document.get("case") is None else tuple(warnings_of_case(document["case"]))
    except (BadInput, ValidationError):
        return ()


def warnings_of_case(case: Json) -> list[Json]:
    """Return the warnings of a normalized case."""
    return case_warnings(CASES.of_json(case))


def _of_scene(scene: SceneInput) -> list[Json]:
    """Return the warnings of the cases of all meshes, and of the scene if no mesh takes a stored table."""
    cases = {mesh.name: mesh.case for mesh in scene.meshes if mesh.case is not None}
    warnings = omission_warnings(scene.left_out) + [
        within(warning, f"meshes[{index}]")
        for index, mesh in enumerate(scene.meshes)
        if mesh.case is not None
        for warning in case_warnings(CASES.of(mesh.case))
    ]
    if len(cases) < len(scene.with_database):  # a mesh takes a stored table, whose pair is not read here
        return warnings
    moving = check_scene(scene, {name: PairGeometry.of(CASES.of(case).pair) for name, case in cases.items()})
    return unique([*warnings, *scene_warnings(scene, moving)])


def predicted_seconds(inputs: Json) -> float | None:
    """Return the predicted CPU seconds of the table of a case; None: no case, or the prediction fails.

    They weight the jobs in the progress of a batch; the cost of a study is taken as proportional to them.
    """
    if inputs.get("case") is None:
        return None
    case = CASES.of_json(inputs["case"])
    try:
        checked = case.checked
        with boundary_errors():
            return decide(checked).predicted(None).cpu_seconds
    except BadInput:  # no mesh meets the requested accuracy: the job itself will say so
        return None
