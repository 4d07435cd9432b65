"""Plausibility at the boundary: findings of the libraries in its fields and units."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType

from bounds import Unit, finding_of
from bounds.types import Json
from dynamics.plausibility import scene_findings
from dynamics.scene import Scene
from fe_contact.plausibility import pair_findings
from lineofaction.gearbox.convert.boundary_names import case_field, scene_field
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.complaint import complaint_of_case
from lineofaction.gearbox.convert.errors import named
from lineofaction.gearbox.schemas import Case
from lineofaction.gearbox.schemas.plan import left_out_warnings
from lineofaction.gearbox.schemas.scene import SceneInput
from lineofaction.gearbox.units import factor, unit_name


def case_warnings(checked: CheckedCase) -> list[Json]:
    """Return warnings about implausible values of a case, before anything is computed.

    Raises `BadInput`: no such pair, or nothing passes where it complains.
    """
    if checked.case.complaint is not None:
        complaint_of_case(checked.case)
    pair, axes = checked.pair, checked.axes
    alignments = axes.misalignment, axes.center_distance_change
    findings = pair_findings(pair, axes.load(pair), *alignments, loads_as=axes.loads_as)
    return phrased_for(checked.case, [finding.to_json() for finding in findings])


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
    warnings = left_out_warnings(inputs.left_out) + measured_warnings(inputs)
    warnings += _in_boundary_terms(of_file, scene_field)
    for index, mesh in enumerate(inputs.meshes):
        warnings += [within(warning, f"meshes[{index}]") for warning in tables.get(mesh.name, ())]
    return unique(warnings)


def measured_warnings(inputs: SceneInput) -> list[Json]:
    """Return which housings of a scene no shaft feels, because they were measured."""
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
    """Whether a field is of a part in the file, and not of a further planet, which is its copy."""
    part = re.match(r"(\w+)\[(\d+)\]", field)
    return part is None or int(part.group(2)) < len(getattr(inputs, part.group(1)))


def within(warning: Json, owner: str) -> Json:
    """Return a warning of a case as one of what the case is part of."""
    field = f"{owner}.case.{warning['field']}"
    return warning | {"field": field, "message": warning["message"].replace(warning["field"], field, 1)}


def phrased_for(case: Case, findings: Iterable[Json]) -> list[Json]:
    """Return findings of a library about a case in its fields and units."""
    return _in_boundary_terms(findings, _field_in(case))


def _in_boundary_terms(findings: Iterable[Json], name: Callable[[str], str]) -> list[Json]:
    """Return findings of a library, as plain JSON in SI, in the fields and units of the boundary."""
    return unique(_phrased(content, name) for content in findings)


def unique(warnings: Iterable[Json]) -> list[Json]:
    """Return warnings without repetitions, as of two gears of the case's one material."""
    return list({warning["message"]: warning for warning in warnings}.values())


def _phrased(content: Json, name: Callable[[str], str]) -> Json:
    finding, field = finding_of(content), name(content["field"])
    unit = Unit(unit_name(field) or finding.unit, factor(field))
    scaled = {
        key: None if content[key] is None else float(f"{content[key] / unit.factor:.12g}")
        for key in ("value", "low", "high")
    }
    return {**content, **scaled, "field": field, "unit": unit.plain, "message": finding.message(field, unit)}


def _field_in(case: Case) -> Callable[[str], str]:
    """Return a function to the field as the case has it: a material may be that of both gears."""

    def field(name: str) -> str:
        boundary = case_field(name)
        for gear in ("pinion", "wheel"):
            of_gear, shared = f"pair.{gear}.material.", "material."
            if boundary.startswith(of_gear) and getattr(case.pair, gear).material is None:
                return shared + boundary.removeprefix(of_gear)
        return boundary

    return field
