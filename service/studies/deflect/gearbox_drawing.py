"""The gearbox to scale with its deflected axes: from above and along the axes."""

from __future__ import annotations

import math

import numpy as np

from bounds import engineering
from dynamics.deflection import CaseDeflection
from service.drawing import palette
from service.drawing.figure import Axis, Figure, FloatArray, Line, Note, Panel
from service.studies.deflect.result import GearboxDeflection, Outline
from service.units import MM, UM

DRAWN = 0.1
"""Largest deflection as it is drawn, over the extent of the gearbox."""
STEPS = (1.0, 2.0, 5.0, 10.0)
SLOPE = math.radians(40.0)
"""Of the radius at whose end the name of a gear stands."""
CIRCLE = np.linspace(0.0, 2.0 * math.pi, 91)


def gearbox_drawing(result: GearboxDeflection, case: CaseDeflection) -> Figure:
    """Draw the gearbox and its axes as one load case bends them, exaggerated."""
    outline = result.outline
    scale = exaggeration(outline, case)
    across, panels = view_axes(outline), []
    panels.append(_along(outline, case, across[0], scale, f"{_named(outline, across[0])} over z"))
    panels.append(_end_view(outline, case, scale))
    worst = max(case.meshes, key=lambda mesh: abs(mesh.misalignment))
    return Figure(
        key="deflected_gearbox",
        title=f'The gearbox under the load case "{case.name}"',
        caption=f"To scale; deflections {scale:.0f} times enlarged. Above: along the axes, shafts outlined, "
        "gears as boxes of their operating pitch diameter, bearings as triangles, the bent axes in red. "
        "Below: seen against z, operating pitch circles, and where the center of each gear moves.",
        alternative=f"Mesh {worst.name} has the largest misalignment, "
        f"{engineering(worst.misalignment / UM, 3)} µm over its face.",
        content=tuple(panels),
    )


def exaggeration(outline: Outline, case: CaseDeflection) -> float:
    """Return the round factor by which deflections are enlarged."""
    largest = float(np.max(np.abs(case.shafts.motion[:, :2]), initial=0.0))
    if largest == 0.0:
        return 1.0
    wanted = DRAWN * float(np.max(outline.length)) / largest
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(step * power for step in STEPS if step * power <= wanted)


def view_axes(outline: Outline) -> tuple[FloatArray, FloatArray]:
    """Return the directions (3,) across the view along the axes: in the plane of most axes, and out of it."""
    spread = outline.origin[:, :2] - outline.origin[:, :2].mean(axis=0)
    direction = np.linalg.svd(spread)[2][0] if len(spread) > 1 and np.any(spread) else np.array([1.0, 0.0])
    direction = direction * (1.0 if direction[np.argmax(np.abs(direction))] > 0.0 else -1.0)
    return np.array([*direction, 0.0]), np.array([-direction[1], direction[0], 0.0])


def _named(outline: Outline, direction: FloatArray) -> str:
    """Name a direction across the axes."""
    angle = math.degrees(math.atan2(direction[1], direction[0]))
    return f"across the axes, {angle:.0f}° from x"


def _along(outline: Outline, case: CaseDeflection, across: FloatArray, scale: float, title: str) -> Panel:
    """Draw the gearbox along its axes, `across` upwards."""
    heights = outline.origin @ across
    lines = [*_shafts(outline, heights), *_gears(outline, heights), *_bearings(outline, heights)]
    ends = outline.origin[:, 2] + outline.length
    notes = [Note(ends[k] / MM, heights[k] / MM, name) for k, name in enumerate(outline.shafts)]
    moved = case.shafts.motion[:, :2] @ across[:2]
    for k in range(len(outline.shafts)):
        own = case.shafts.shaft == k
        z = (outline.origin[k, 2] + case.shafts.position[own]) / MM
        name = f"axis, {scale:.0f} times"
        lines.append(Line(name, z, (heights[k] + scale * moved[own]) / MM, palette.VERMILLION, width=2.4))
    return Panel(Axis("z, mm"), Axis("mm"), tuple(lines), title=title, notes=tuple(notes), equal=True)


def _shafts(outline: Outline, heights: FloatArray) -> list[Line]:
    """Outline the pieces of the shafts."""
    lines = []
    for k, (start, length, left, right) in zip(outline.piece_shaft, outline.piece, strict=True):
        z = (outline.origin[k, 2] + start + length * np.array([0.0, 0.0, 1.0, 1.0, 0.0])) / MM
        y = (heights[k] + 0.5 * np.array([-left, left, right, -right, -left])) / MM
        lines.append(Line("shafts", z, y, palette.MUTED, width=1.2))
    return lines


def _gears(outline: Outline, heights: FloatArray) -> list[Line]:
    """Draw the gears as boxes."""
    lines = []
    for k, (position, width, diameter) in zip(outline.gear_shaft, outline.gear, strict=True):
        z = (outline.origin[k, 2] + position + 0.5 * width * np.array([-1, -1, 1, 1, -1])) / MM
        y = (heights[k] + 0.5 * diameter * np.array([-1, 1, 1, -1, -1])) / MM
        lines.append(Line("gears", z, y, palette.BLUE, width=1.6))
    return lines


def _bearings(outline: Outline, heights: FloatArray) -> list[Line]:
    """Draw the bearings as triangles on either side of the shaft."""
    lines, size = [], 0.03 * float(np.max(outline.length))
    for k, position in zip(outline.bearing_shaft, outline.bearing, strict=True):
        z = outline.origin[k, 2] + position
        radius = _radius(outline, int(k), float(position))
        for side in (1.0, -1.0):
            across = heights[k] + side * (radius + size * np.array([0.0, 1.0, 1.0, 0.0]))
            along = z + size * np.array([0.0, -0.6, 0.6, 0.0])
            lines.append(Line("bearings", along / MM, across / MM, palette.GREEN, width=1.6))
    return lines


def _radius(outline: Outline, shaft: int, position: float) -> float:
    """Return the radius of a shaft at a position, m."""
    for k, (start, length, left, right) in zip(outline.piece_shaft, outline.piece, strict=True):
        if k == shaft and start <= position <= start + length:
            return 0.5 * float(left + (right - left) * (position - start) / length)
    return 0.0


def _end_view(outline: Outline, case: CaseDeflection, scale: float) -> Panel:
    """Draw the gears against z with the paths of their centers."""
    lines, notes = [], []
    for name, k, (position, _, diameter) in zip(outline.gears, outline.gear_shaft, outline.gear, strict=True):
        center = outline.origin[k, :2]
        own = case.shafts.shaft == k
        path = [
            np.interp(position, case.shafts.position[own], case.shafts.motion[own, axis]) for axis in (0, 1)
        ]
        circle = center[:, None] + 0.5 * diameter * np.array([np.cos(CIRCLE), np.sin(CIRCLE)])
        lines.append(Line("operating pitch circles", circle[0] / MM, circle[1] / MM, palette.BLUE, width=1.4))
        ends = np.array([center, center + scale * np.array(path)]) / MM
        lines.append(
            Line("path of centers", ends[:, 0], ends[:, 1], palette.VERMILLION, width=2.4, markers=True)
        )
        notes.append(_name_outside(name, center, 0.5 * diameter, outline.origin[outline.gear_shaft, :2]))
    return Panel(
        Axis("x, mm"), Axis("y, mm"), tuple(lines), title="seen against z", notes=tuple(notes), equal=True
    )


def _name_outside(name: str, center: FloatArray, radius: float, centers: FloatArray) -> Note:
    """Write the name of a gear right of its circle, above or below, away from the other gears."""
    side = 1.0 if center[1] >= centers[:, 1].mean() else -1.0
    x, y = (center + radius * np.array([math.cos(SLOPE), side * math.sin(SLOPE)])) / MM
    return Note(x, y, name, row=0 if side > 0.0 else -1)
