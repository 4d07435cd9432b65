"""Plots of a deflection: misalignment by cause, load along the face, contact patterns."""

from __future__ import annotations

import numpy as np

from dynamics.deflection import CAUSES, CaseDeflection
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection
from lineofaction.gearbox.units import MM, UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, HeatMap, Line, Panel, number
from lineofaction.report.studies.deflect_tables import mesh_of, meshes_worst_first, worst_case

COLORS = (palette.BLUE, palette.VERMILLION, palette.GREEN, palette.PURPLE, palette.MUTED, palette.INK)
LOADED = 1e-3  # of the largest pressure: less is blank


def causes_figure(result: GearboxDeflection) -> Figure:
    """Draw the parts of the misalignments as stacked bars, a panel a mesh."""
    names, cases = meshes_worst_first(result), result.deflection.cases
    worst = worst_case(result, names[0])
    largest = number(mesh_of(worst, names[0]).misalignment / UM, 3)
    return Figure(
        key="misalignment_by_cause",
        title="Misalignment of each mesh by cause",
        caption="Growth of the gap over the common face in the plane of action, positive along z of the "
        "pinion. Parts of either sign are stacked from zero, points are their sum.",
        alternative=f'Mesh {names[0]} runs at up to {largest} µm, under the load case "{worst.name}".',
        content=tuple(_causes_panel(name, cases) for name in names),
    )


def _causes_panel(name: str, cases: tuple[CaseDeflection, ...]) -> Panel:
    """Stack the parts of one mesh over the load cases."""
    x = np.arange(len(cases), dtype=float)
    parts = np.array([mesh_of(case, name).causes for case in cases]) / UM
    above, below, bars = np.zeros(len(cases)), np.zeros(len(cases)), []
    for cause, color, part in zip(CAUSES, COLORS, parts.T, strict=True):
        if not np.any(part):
            continue
        base = np.where(part > 0.0, above, below)
        bars.append(Bars(cause, x, base + part, base, 0.5, color))
        above, below = above + np.maximum(part, 0.0), below + np.minimum(part, 0.0)
    total = Line("sum", x, parts.sum(axis=1), palette.INK, width=0.0, markers=True)
    ticks = tuple((float(k), case.name) for k, case in enumerate(cases))
    axis = Axis("", limits=(-0.6, len(cases) - 0.4), names=ticks)
    return Panel(axis, Axis("misalignment, µm"), (total,), title=name, bars=tuple(bars))


def face_load_figure(result: GearboxDeflection) -> Figure | None:
    """Draw the load along the face of every mesh; None where no model has it."""
    names = [
        name
        for name in meshes_worst_first(result)
        if any(own.mesh == name and np.isfinite(own.face_load_factor) for own in result.flanks)
    ]
    if not names:
        return None
    colors = (palette.BLUE, palette.VERMILLION, palette.GREEN, palette.PURPLE)
    panels = []
    for name in names:
        own = [part for part in result.flanks if part.mesh == name]
        lines = tuple(
            Line(
                part.case,
                part.face_position / MM,
                part.face_load * MM,
                colors[k % 4],
                ("solid", "dash")[k // 4 % 2],
            )
            for k, part in enumerate(own)
        )
        panels.append(Panel(Axis("face position, mm"), Axis("load, N/mm"), lines, title=name))
    largest = max(result.flanks, key=lambda part: np.nan_to_num(part.face_load_factor))
    return Figure(
        key="face_load",
        title="Load along the face",
        caption="Force of all pairs per width of face, mean over the mesh cycle; 0: mid-face of the pinion.",
        alternative=f"The most uneven is mesh {largest.mesh} under {largest.case}: K_Hbeta "
        f"{number(largest.face_load_factor, 3)}.",
        content=tuple(panels),
    )


def pattern_figure(result: GearboxDeflection) -> Figure | None:
    """Draw the contact pattern of every mesh under its worst load case; None without flanks."""
    panels, texts = [], []
    for name in meshes_worst_first(result):
        case = worst_case(result, name)
        own = next((p for p in result.flanks if (p.mesh, p.case) == (name, case.name)), None)
        if own is None or not np.isfinite(own.face_load_factor):
            continue
        pattern = np.where(own.pattern > LOADED * own.pattern.max(), own.pattern, np.nan) / 1e6
        shade = HeatMap(
            own.face_position / MM,
            own.roll_length / MM,
            pattern,
            "largest pressure, MPa",
            float(np.nanmax(pattern)),
        )
        panels.append(
            Panel(
                Axis("face position, mm"),
                Axis("roll length of the pinion, mm"),
                title=f"{name}, {case.name}",
                shade=shade,
            )
        )
        texts.append(f"{name}: {number(1e-6 * own.largest_pressure, 4)} MPa.")
    if not panels:
        return None
    return Figure(
        key="contact_patterns",
        title="Contact patterns under the worst load case of each mesh",
        caption="Largest pressure that each point of the pinion's flank meets over the mesh cycle.",
        alternative=" ".join(texts),
        content=tuple(panels),
    )
