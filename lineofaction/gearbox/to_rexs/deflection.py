"""A REXS document with the results of a deflection as calculated."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from dynamics.deflection import CaseDeflection
from lineofaction.gearbox.from_rexs.opened import OpenedUnit
from lineofaction.gearbox.from_rexs.scene_parts import SceneParts
from lineofaction.gearbox.rexs.model import Attribute, Document
from lineofaction.gearbox.rexs.upgrade import upgrade
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.to_rexs.attributes import with_case_results
from lineofaction.gearbox.to_rexs.bearing import bearing_results
from lineofaction.gearbox.to_rexs.mesh import alignment_results, flank_results
from lineofaction.gearbox.to_rexs.same_scene import check_same_scene
from lineofaction.gearbox.to_rexs.shaft import shaft_results

_Part = tuple[int, tuple[Attribute, ...]]


def deflected(document: Document, unit: OpenedUnit, result: GearboxDeflection) -> Document:
    """Return the document, in the newest version of REXS, with the results of a deflection as calculated.

    Results stand in the load cases of the document's first spectrum. In a document without a spectrum they
    stand at the components themselves. Raises `BadInput`: the result is of another scene or of other load
    cases, or a case was not found.

    Parameters
    ----------
    document : Document
        Document as read, in any version.
    unit : OpenedUnit
        Unit opened from the document.
    result : GearboxDeflection
        Deflection of the unit's scene under all or some of its load cases.
    """
    check_same_scene(unit, result)
    numbers = {case.name: case.number for case in unit.load_cases}
    written = replace(document, model=upgrade(document.model)[0])
    for case in result.deflection.cases:
        results = {
            **dict(_shafts(unit.parts, result.outline.shafts, case)),
            **dict(_bearings(unit.parts, case)),
            **dict(_meshes(unit.parts, result, case)),
        }
        written = with_case_results(written, numbers[case.name], results)
    return written


def omissions(unit: OpenedUnit, result: GearboxDeflection) -> list[str]:
    """Return the names of shafts, bearings and meshes of the result that are no component of the document."""
    parts = unit.parts
    meshes = (mesh.name for case in result.deflection.cases[:1] for mesh in case.meshes)
    return [
        *(name for name in result.outline.shafts if name not in parts.shafts),
        *(name for name in result.outline.bearings if name not in parts.bearings),
        *(name for name in meshes if name not in parts.meshes),
    ]


def _shafts(parts: SceneParts, names: tuple[str, ...], case: CaseDeflection) -> Iterator[_Part]:
    lines = case.shafts
    for index, name in enumerate(names):
        if name in parts.shafts:
            rows = np.flatnonzero(lines.shaft == index)
            part = parts.shafts[name]
            yield part.component, shaft_results(part, lines.position[rows], lines.motion[rows])


def _bearings(parts: SceneParts, case: CaseDeflection) -> Iterator[_Part]:
    for load in case.bearings:
        if load.name in parts.bearings:
            part = parts.bearings[load.name]
            yield part.component, bearing_results(part, load)


def _meshes(parts: SceneParts, result: GearboxDeflection, case: CaseDeflection) -> Iterator[_Part]:
    """Yield the attributes of the stages; a load case on the coast side turns the train the other way."""
    flanks = {entry.mesh: entry for entry in result.flanks if entry.case == case.name}
    direction = 1 if case.direction == "drive" else -1
    for mesh in case.meshes:
        if mesh.name in parts.meshes:
            part = parts.meshes[mesh.name]
            sense = direction * part.sense
            of_flanks = flank_results(flanks[mesh.name], sense) if mesh.name in flanks else ()
            yield part.component, (*alignment_results(mesh, sense), *of_flanks)
