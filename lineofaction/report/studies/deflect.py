"""A deflection as people see it: the gearbox drawn, its meshes, flanks and bearings."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from bounds import leftover
from dynamics.deflection import CAUSES
from lineofaction.gearbox.studies.deflect.figures import mesh_names
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing.figure import Figure, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation
from lineofaction.report.studies.deflect_gearbox_drawing import gearbox_drawing
from lineofaction.report.studies.deflect_plots import causes_figure, face_load_figure, pattern_figure
from lineofaction.report.studies.deflect_tables import (
    bearing_table,
    drawn_case,
    force_table,
    largest_motion,
    life_table,
    mesh_of,
    mesh_table,
    meshes_worst_first,
)


def headlines(result: GearboxDeflection) -> tuple[Headline, ...]:
    """Return the worst mesh and the most uneven load; without meshes how far the axes move."""
    case = drawn_case(result)
    if not case.meshes:
        size = f"{number(largest_motion(case) / UM, 3)} µm"
        return (Headline("largest displacement of an axis", size, case.name),)
    name = meshes_worst_first(result)[0]
    mesh = mesh_of(case, name)
    most = f"; most by the {CAUSES[int(np.argmax(np.abs(mesh.causes)))]}" if np.any(mesh.causes) else ""
    size = f"{number(mesh.misalignment / UM, 3)} µm"
    lines = [Headline("largest misalignment", size, f"mesh {name}, {case.name}{most}")]
    factors = [part for part in result.flanks if np.isfinite(part.face_load_factor)]
    if factors:
        worst = max(factors, key=lambda part: part.face_load_factor)
        lines.append(
            Headline("largest K_Hbeta", number(worst.face_load_factor, 3), f"mesh {worst.mesh}, {worst.case}")
        )
    return tuple(lines)


def page(result: GearboxDeflection) -> Page:
    """Return the report: the gearbox under the worst load case, then its meshes and bearings."""
    contact = tuple(figure for figure in (face_load_figure(result), pattern_figure(result)) if figure)
    sections = [
        Section("Gearbox", figures=(figure(result),)),
        *(
            [Section("Meshes", figures=(causes_figure(result),), tables=(mesh_table(result),))]
            if mesh_names(result)
            else []
        ),
        *([Section("Flanks", figures=contact)] if contact else []),
        Section("Bearings", tables=(bearing_table(result), life_table(result))),
        *([Section("Forces", tables=(forces,))] if (forces := force_table(result)) else []),
    ]
    count = len(result.deflection.cases)
    lead = f"{count} load case{'s' * (count > 1)} on {result.deflection.leading_shaft}. {agreement(result)}"
    return Page("Deflection of the gearbox", lead, headlines(result), tuple(sections), _alarms(result))


def agreement(result: GearboxDeflection) -> str:
    """Say how well mesh loads and deflections agree."""
    if not mesh_names(result):
        return "Nothing meshes."
    if not any(np.isfinite(part.face_load_factor) for part in result.flanks):
        return "The meshes press evenly over their faces: no table in three dimensions."
    change = leftover(result.change)
    return f"Mesh loads and deflections agree to {change} of the misalignments after {result.passes} passes."


def _alarms(result: GearboxDeflection) -> tuple[str, ...]:
    """Say what was not found."""
    lost = [case for case in result.deflection.cases if case.status != "converged"]
    alarms = [f'No equilibrium was found under the load case "{case.name}".' for case in lost]
    if not lost and not result.agreed:
        alarms.append("Mesh loads and deflections do not agree yet: the misalignments still change.")
    outside = sorted({m.name for case in result.deflection.cases for m in case.meshes if not m.in_table})
    alarms += [
        f'Mesh "{name}" runs beyond the misalignments of its table, whose ends are held.' for name in outside
    ]
    return tuple(alarms)


def text(result: GearboxDeflection) -> Iterator[Table | str]:
    """Tables for the terminal, the worst mesh first."""
    yield from _alarms(result)
    yield agreement(result)
    if mesh_names(result):
        yield mesh_table(result)
        yield ""
    yield bearing_table(result)
    yield ""
    yield life_table(result)


def figure(result: GearboxDeflection) -> Figure:
    """Return the gearbox under the load case of the largest misalignment, else of the largest motion."""
    return gearbox_drawing(result, drawn_case(result))


PAGE = Presentation(figure, page, text)
