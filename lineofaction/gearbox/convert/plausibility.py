"""Plausibility of scenes: findings of the library in the fields and units of the file."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from types import MappingProxyType

from bounds.types import Json
from dynamics.plausibility import scene_findings
from dynamics.scene import Scene
from lineofaction.gearbox.convert.boundary_errors import named
from lineofaction.gearbox.convert.boundary_names import scene_field
from lineofaction.gearbox.convert.case_plausibility import in_boundary_terms, unique
from lineofaction.gearbox.schemas.plan import omission_warnings
from lineofaction.gearbox.schemas.scene import SceneInput


def scene_warnings(
    inputs: SceneInput, scene: Scene, tables: Mapping[str, Iterable[Json]] = MappingProxyType({})
) -> list[Json]:
    """Return warnings about implausible values of a scene and of the tables of its meshes.

    Raises `BadInput`: the parts of the scene do not fit each other.

    Parameters
    ----------
    inputs : SceneInput
        The scene file.
    scene : Scene
        The same with all its planets.
    tables : mapping of str to list of dict
        Warnings of the table of each mesh, by the name of the mesh.
    """
    with named(""):
        findings = [finding.to_json() for finding in scene_findings(scene)]
    of_file = [finding for finding in findings if _in_file(inputs, finding["field"])]
    warnings = omission_warnings(inputs.left_out) + measured_warnings(inputs)
    warnings += in_boundary_terms(of_file, scene_field)
    for index, mesh in enumerate(inputs.meshes):
        warnings += [within(warning, f"meshes[{index}]") for warning in tables.get(mesh.name, ())]
    return unique(warnings)


def measured_warnings(inputs: SceneInput) -> list[Json]:
    """Return a warning for each measured housing of a scene: it does not act back on the shafts."""
    nothing = {"value": None, "unit": "", "low": None, "high": None, "reason": "", "source": "", "whole": ""}
    return [
        {
            "check": "measured_housing",
            "field": f"housings[{index}].frf_file",
            **nothing,
            "message": f"housing {part.name} is measured: it moves under the forces of bearings "
            "(loa vibration) and does not act back on the shafts: "
            "seats have the stiffness that their bearings state",
        }
        for index, part in enumerate(inputs.housings)
        if part.is_measured
    ]


def _in_file(inputs: SceneInput, field: str) -> bool:
    """Whether a field is of a part in the file; those of further planets, its copies, are not."""
    part = re.match(r"(\w+)\[(\d+)\]", field)
    return part is None or int(part.group(2)) < len(getattr(inputs, part.group(1)))


def within(warning: Json, owner: str) -> Json:
    """Return a warning of a case as a warning of its owner, a scene or a request."""
    field = f"{owner}.case.{warning['field']}"
    return warning | {"field": field, "message": warning["message"].replace(warning["field"], field, 1)}
