"""A deflection as people see it: the gearbox drawn, its meshes, flanks and bearings."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from bounds.error_digits import with_error
from bounds.types import BoolArray, Json
from dynamics.deflection import CAUSES, CaseDeflection, MeshAlignment
from lineofaction.gearbox.studies.deflect.figures import mesh_names
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, MeshFlanks
from lineofaction.gearbox.studies.deflect.run import RUN
from lineofaction.gearbox.units import MM, UM
from lineofaction.report.deflection.gearbox_drawing import gearbox_drawing, largest_motion, micrometers
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Dash, Figure, HeatMap, Line, Panel, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation

CAUSE_LABELS = ("of shafts", "bearings", "clearance", "housing", "couplings", "set")
COLORS = (palette.BLUE, palette.VERMILLION, palette.GREEN, palette.PURPLE, palette.MUTED, palette.INK)
_DASHES: tuple[Dash, ...] = ("solid", "dash")
LOADED = 1e-3  # share of the largest pressure below which a pattern is blank


def _meshes_worst_first(result: GearboxDeflection) -> list[str]:
    def largest(name: str) -> float:
        return max(abs(_mesh_of(case, name).misalignment) for case in result.deflection.cases)

    return sorted(mesh_names(result), key=largest, reverse=True)


def _worst_case(result: GearboxDeflection, mesh: str) -> CaseDeflection:
    return max(result.deflection.cases, key=lambda case: abs(_mesh_of(case, mesh).misalignment))


def _drawn_case(result: GearboxDeflection) -> CaseDeflection:
    """Return the load case that misaligns a mesh most; without meshes, the one that moves the axes most."""
    names = _meshes_worst_first(result)
    return _worst_case(result, names[0]) if names else max(result.deflection.cases, key=largest_motion)


def _mesh_of(case: CaseDeflection, name: str) -> MeshAlignment:
    return next(mesh for mesh in case.meshes if mesh.name == name)


def _case(result: GearboxDeflection, name: str) -> CaseDeflection:
    return next(case for case in result.deflection.cases if case.name == name)


def _under(case: CaseDeflection) -> str:
    """Return a load case with its torque, in words."""
    return f'under the load case "{case.name}", {number(case.torque)} N m'


def _mesh_table(result: GearboxDeflection) -> Table:
    """List every mesh under every load case, the worst mesh first, with the causes that act."""
    acting = np.any([mesh.causes for case in result.deflection.cases for mesh in case.meshes], axis=0)
    flanks = {(flanks.mesh, flanks.case): flanks for flanks in result.flanks}
    head = (
        *("mesh", "load case", "torque, N m", "misalignment, µm"),
        *(label for label, acts in zip(CAUSE_LABELS, acting, strict=True) if acts),
        *("K_Hbeta", "STE peak-to-peak, µm", "largest pressure, MPa"),
    )
    rows = tuple(
        _row(name, case, flanks.get((name, case.name)), acting)
        for name in _meshes_worst_first(result)
        for case in result.deflection.cases
    )
    return Table("Meshes under the load cases: misalignment over the face by cause", head, rows)


def _force_table(result: GearboxDeflection) -> Table | None:
    """List the forces of the scene under the load cases; None without forces."""
    axes = (*(f"{axis}, N" for axis in "xyz"), *(f"about {axis}, N m" for axis in "xyz"))
    rows = []
    for case in result.deflection.cases:
        for force in case.forces:
            values = (*force.force, *force.moment)
            texts = ("0" if value == 0.0 else number(value, 4) for value in values)
            rows.append((force.name, force.shaft, _titled(case), *texts))
    caption = "Forces under the load cases, before the factor of their course"
    return Table(caption, ("force", "shaft", "load case", *axes), tuple(rows)) if rows else None


def _row(name: str, case: CaseDeflection, flanks: MeshFlanks | None, acting: BoolArray) -> tuple[str, ...]:
    mesh = _mesh_of(case, name)
    columns = (name, _titled(case), number(case.torque), micrometers(mesh.misalignment))
    parts = tuple(micrometers(float(part)) for part in mesh.causes[acting])
    if flanks is None:
        return (*columns, *parts, "none", "none", "none")
    ripple = with_error(flanks.peak_to_peak / UM, flanks.peak_to_peak_error / UM)
    pressure = number(1e-6 * flanks.largest_pressure, 4)
    return (*columns, *parts, number(flanks.face_load_factor, 3), ripple, pressure)


def _titled(case: CaseDeflection) -> str:
    side = "" if case.direction == "drive" else f" ({case.direction})"
    return f"{case.name}{side}" + ("" if case.status == "converged" else f", {case.status.replace('_', ' ')}")


def _bearing_table(result: GearboxDeflection) -> Table:
    loads = [case["bearings"] for case in RUN.figures(result)["load_cases"]]
    listed = []
    for index in range(len(result.outline.bearings)):
        for case, bearings in zip(result.deflection.cases, loads, strict=True):
            listed.append({"case": _titled(case), **bearings[index]})
    columns = {
        "bearing": lambda bearing: bearing["name"],
        "load case": lambda bearing: bearing["case"],
        "speed, rpm": lambda bearing: number(bearing["speed_rpm"]),
        "radial, N": lambda bearing: number(bearing["radial_force_n"]),
        "axial, N": lambda bearing: number(bearing["axial_force_n"]),
        "radial: elastic, µm": lambda bearing: _displacement_text(bearing["elastic_um"]),
        "clearance, µm": lambda bearing: _displacement_text(bearing["clearance_um"]),
        "seat, µm": lambda bearing: _displacement_text(bearing["seat_um"]),
        "life, h": _life_text,
    }
    return Table.of("Bearings under the load cases, means over the mesh cycle", listed, columns)


def _displacement_text(vector: list[float]) -> str:
    return number(np.hypot(vector[0], vector[1]), 3)


def _life_text(bearing: Json) -> str:
    hours = bearing["rating_life_hours"]
    return str(bearing["rating_life"]) if hours is None else number(float(f"{hours:.3g}"), 3)


def _life_table(result: GearboxDeflection) -> Table:
    def equivalent(way: str, kind: str) -> Callable[[Json], str]:
        return lambda part: number(part[f"equivalent_{way}_force_n"][kind])

    columns: dict[str, Callable[[Json], str]] = {
        "bearing": lambda part: part["name"],
        "mean speed, rpm": lambda part: number(part["mean_speed_rpm"]),
        "life, h": _life_text,
    }
    for way in ("radial", "axial"):
        for kind in ("ball", "roller"):
            columns[f"{way}, {kind}, N"] = equivalent(way, kind)
    caption = "Basic reference rating life over all load cases (ISO/TS 16281)"
    caption += ", and loads of equal life (ISO 281)"
    return Table.of(caption, RUN.figures(result)["bearings"], columns)


def _causes_figure(result: GearboxDeflection) -> Figure:
    names, cases = _meshes_worst_first(result), result.deflection.cases
    worst = _worst_case(result, names[0])
    largest = micrometers(_mesh_of(worst, names[0]).misalignment).replace("< ", "less than ")
    return Figure(
        key="misalignment_by_cause",
        title="Misalignment of each mesh by cause",
        caption="Growth of the gap over the common face in the plane of action, positive along z of the "
        "pinion. Parts of either sign are stacked from zero, points are their sum.",
        alternative=f"Mesh {names[0]} is misaligned most, by {largest} µm, {_under(worst)}.",
        content=tuple(_causes_panel(name, cases) for name in names),
    )


def _causes_panel(name: str, cases: tuple[CaseDeflection, ...]) -> Panel:
    x = np.arange(len(cases), dtype=float)
    parts = np.array([_mesh_of(case, name).causes for case in cases]) / UM
    above, below = np.zeros(len(cases)), np.zeros(len(cases))
    bars = []
    for cause, color, part in zip(CAUSES, COLORS, parts.T, strict=True):
        if not np.any(part):
            continue
        base = np.where(part > 0.0, above, below)
        bars.append(Bars(cause, x, base + part, base, width=0.5, color=color))
        above = above + np.maximum(part, 0.0)
        below = below + np.minimum(part, 0.0)
    total = Line("sum", x, parts.sum(axis=1), palette.INK, width=0.0, markers=True)
    names = Axis.of_names([case.name for case in cases])
    return Panel(names, Axis("misalignment, µm"), (total,), title=name, bars=tuple(bars))


def _face_load_figure(result: GearboxDeflection) -> Figure | None:
    """Draw the load along the face of every mesh; None where no model has it."""
    panels = []
    for name in _meshes_worst_first(result):
        flanks = [part for part in result.flanks if part.mesh == name]
        if not any(np.isfinite(part.face_load_factor) for part in flanks):
            continue
        lines = []
        for k, part in enumerate(flanks):
            color, dash = COLORS[k % 4], _DASHES[k // 4 % 2]  # four colors, then the same four dashed
            lines.append(Line(part.case, part.face_position / MM, part.face_load * MM, color, dash))
        panels.append(Panel(Axis("face position, mm"), Axis("load, N/mm"), tuple(lines), title=name))
    if not panels:
        return None
    largest = max(result.flanks, key=lambda part: np.nan_to_num(part.face_load_factor))
    return Figure(
        key="mesh_face_load",
        title="Load along the face",
        caption="Force of all pairs per width of face, mean over the mesh cycle; 0: mid-face of the pinion.",
        alternative=f"The most uneven is mesh {largest.mesh} {_under(_case(result, largest.case))}: K_Hbeta "
        f"{number(largest.face_load_factor, 3)}.",
        content=tuple(panels),
    )


def _pattern_figure(result: GearboxDeflection) -> Figure | None:
    """Draw the contact pattern of every mesh under its worst load case; None without flanks."""
    panels, texts = [], []
    for name in _meshes_worst_first(result):
        case = _worst_case(result, name)
        flanks = next((p for p in result.flanks if (p.mesh, p.case) == (name, case.name)), None)
        if flanks is None or not np.isfinite(flanks.face_load_factor):
            continue
        pattern = np.where(flanks.pattern > LOADED * flanks.pattern.max(), flanks.pattern, np.nan) / 1e6
        top = float(np.nanmax(pattern))
        face, roll = flanks.face_position / MM, flanks.roll_length / MM
        shade = HeatMap(face, roll, pattern, "largest pressure, MPa", top)
        axes = Axis("face position, mm"), Axis("roll length of the pinion, mm")
        panels.append(Panel(*axes, title=f"{name}, {case.name}", shade=shade))
        texts.append(f"{name}: {number(1e-6 * flanks.largest_pressure, 4)} MPa.")
    if not panels:
        return None
    return Figure(
        key="contact_patterns",
        title="Contact patterns under the worst load case of each mesh",
        caption="Largest pressure that each point of the pinion's flank meets over the mesh cycle.",
        alternative=" ".join(texts),
        content=tuple(panels),
    )


def _headlines(result: GearboxDeflection) -> tuple[Headline, ...]:
    """Return the worst mesh and the most uneven load; without meshes how far the axes move."""
    case = _drawn_case(result)
    if not case.meshes:
        size = f"{micrometers(largest_motion(case))} µm"
        return (Headline("largest displacement of an axis", size, _under(case)),)
    name = _meshes_worst_first(result)[0]
    mesh = _mesh_of(case, name)
    maximum = f"; most by the {CAUSES[int(np.argmax(np.abs(mesh.causes)))]}" if np.any(mesh.causes) else ""
    size = f"{micrometers(mesh.misalignment)} µm"
    lines = [Headline("largest misalignment", size, f"mesh {name}, {_under(case)}{maximum}")]
    factors = [part for part in result.flanks if np.isfinite(part.face_load_factor)]
    if factors:
        worst = max(factors, key=lambda part: part.face_load_factor)
        where = f"mesh {worst.mesh}, {_under(_case(result, worst.case))}"
        remark = f"{where}; error not estimated: flanks of a case are solved once"
        lines.append(Headline("largest K_Hbeta", number(worst.face_load_factor, 3), remark))
    return tuple(lines)


def _page(result: GearboxDeflection) -> Page:
    sections = [Section("Gearbox", figures=(_figure(result),))]
    if mesh_names(result):
        sections.append(Section("Meshes", figures=(_causes_figure(result),), tables=(_mesh_table(result),)))
    if contact := tuple(filter(None, (_face_load_figure(result), _pattern_figure(result)))):
        sections.append(Section("Flanks", figures=contact))
    sections.append(Section("Bearings", tables=(_bearing_table(result), _life_table(result))))
    if forces := _force_table(result):
        sections.append(Section("Forces", tables=(forces,)))
    count = len(result.deflection.cases)
    lead = f"{count} load case{'s' * (count > 1)} on {result.deflection.leading_shaft}. {agreement(result)}"
    return Page("Deflection of the gearbox", lead, _headlines(result), tuple(sections), _alarms(result))


def agreement(result: GearboxDeflection) -> str:
    """Return a sentence on the agreement of mesh loads and deflections."""
    if not mesh_names(result):
        return "Nothing meshes."
    if not any(np.isfinite(part.face_load_factor) for part in result.flanks):
        return "The meshes press evenly over their faces: no table in three dimensions."
    passes = f"{result.passes} pass{'es' if result.passes > 1 else ''}"
    return f"{'Converged' if result.agreed else 'Not converged'} in {passes}."


def _alarms(result: GearboxDeflection) -> tuple[str, ...]:
    unsolved = [case for case in result.deflection.cases if case.status != "converged"]
    alarms = [f'No equilibrium was found under the load case "{case.name}".' for case in unsolved]
    if not unsolved and not result.agreed:
        alarms.append("Mesh loads and deflections do not agree yet: the misalignments still change.")
    outside = sorted({m.name for case in result.deflection.cases for m in case.meshes if not m.in_table})
    beyond = "runs beyond the misalignments of its table, whose ends are held"
    alarms += [f'Mesh "{name}" {beyond}.' for name in outside]
    return tuple(alarms)


def _text(result: GearboxDeflection) -> Iterator[Table | str]:
    yield from _alarms(result)
    yield agreement(result)
    if mesh_names(result):
        yield _mesh_table(result)
        yield ""
    yield _bearing_table(result)
    yield ""
    yield _life_table(result)


def _figure(result: GearboxDeflection) -> Figure:
    return gearbox_drawing(result, _drawn_case(result))


PAGE = Presentation(_figure, _page, _text)
