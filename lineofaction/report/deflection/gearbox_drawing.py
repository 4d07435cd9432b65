"""The gearbox to scale with its deflected axes: from above and along the axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.deflection import CaseDeflection
from lineofaction.gearbox.studies.deflect.result import GearboxDeflection, Outline
from lineofaction.gearbox.units import MM, UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Note, Panel, number

WAYS = np.array([(math.cos(a), math.sin(a)) for a in np.radians(np.arange(45.0, 405.0, 22.5))])
"""Directions of the radii at whose ends a name may begin, the preferred first."""
CHARACTER, ROW = 0.013, 0.03
"""Width and height of a character over the size of the drawing."""

DRAWN = 0.1
"""Largest deflection as it is drawn, over the extent of the gearbox."""
STEPS = (1.0, 2.0, 5.0, 10.0)
ALONG = (
    "From the side: shafts outlined, gears as boxes of their operating pitch diameter, bearings as "
    "triangles, the bent axes in orange."
)
AGAINST = " Against z: operating pitch circles, and where the center of each gear moves."
NEAR = 0.04
"""Distance over the size of the drawing below which names cover each other."""
VIEWS = np.array([(math.cos(a), math.sin(a)) for a in np.radians(sorted(range(-89, 91), key=abs))])
"""Directions across z, the directions near x first."""
_FINEST = 1e-9
"""Length below which a motion is not written out, m: no deflection is known to that."""
COAXIAL = 1e-6
"""Distance in m below which two axes are one."""
EDGE = 0.04
"""Margin of a plot's axis beyond its contents, over their span."""
CIRCLE = np.linspace(0.0, 2.0 * math.pi, 91)


def micrometers(length: float) -> str:
    """Write a length in m with three digits in µm; below a nanometer it is only said to be so."""
    if 0.0 < abs(length) < _FINEST:
        return "< 0.001"
    return "0" if length == 0.0 else number(length / UM, 3)


def largest_motion(case: CaseDeflection) -> float:
    """Return the largest deflection of an axis in x or y, m."""
    return float(np.max(np.abs(case.shafts.motion[:, :2]), initial=0.0))


class _GearName(NamedTuple):
    """The name of a gear and points (n, 2) along it, m."""

    note: Note
    points: FloatArray


def _gear_names(outline: Outline) -> tuple[_GearName, ...]:
    """Return each name where it is farthest from all circles and from the names before it."""
    center = outline.origin[outline.gear_shaft, :2]
    radius = 0.5 * outline.gear[:, 2]
    ends = np.vstack([center - radius[:, None], center + radius[:, None]])
    size = float(np.max(np.ptp(ends, axis=0)))  # the larger extent of the circles
    names: list[_GearName] = []
    for k, text in enumerate(outline.gears):
        written = np.vstack([np.empty((0, 2)), *(name.points for name in names)])
        positions = [_at(text, center[k] + radius[k] * way, way, size) for way in WAYS]
        names.append(max(positions, key=lambda position: _room(position.points, center, radius, written)))
    return tuple(names)


def _at(text: str, start: FloatArray, way: FloatArray, size: float) -> _GearName:
    """Return a name that begins at a point of its circle and leads away from it."""
    side, above = math.copysign(1.0, way[0]), math.copysign(1.0, way[1])
    along = np.linspace(0.0, side * CHARACTER * len(text), 2 + len(text) // 3) * size
    points = np.column_stack([start[0] + along, np.full_like(along, start[1] + above * ROW * size)])
    note = Note(start[0] / MM, start[1] / MM, text, row=0 if above > 0.0 else -1, left=side < 0.0)
    return _GearName(note, points)


def _room(points: FloatArray, center: FloatArray, radius: FloatArray, written: FloatArray) -> float:
    """Return the least distance of points (n, 2) to circles and to the points (m, 2) of other names, m."""
    circles = np.abs(np.linalg.norm(points[:, None] - center, axis=2) - radius)
    texts = np.linalg.norm(points[:, None] - written, axis=2)
    return float(np.min(np.hstack([circles, texts])))


def gearbox_drawing(result: GearboxDeflection, case: CaseDeflection) -> Figure:
    """Draw the gearbox and its axes as one load case bends them, exaggerated."""
    outline = result.outline
    scale = _exaggeration(outline, case)
    panels, caption = [_along(outline, case, _view_direction(outline, case), scale)], ALONG
    if outline.gears:
        panels.append(_end_view(outline, case, scale))
        caption += AGAINST
    return Figure(
        key="deflected_gearbox",
        title=f'The gearbox under the load case "{case.name}"',
        caption=f"To scale; deflections {scale:g} times enlarged. {caption}",
        alternative=_finding(case),
        content=tuple(panels),
    )


def _finding(case: CaseDeflection) -> str:
    if not case.meshes:
        return f"The axes move by up to {number(largest_motion(case) / UM, 3)} µm."
    worst = max(case.meshes, key=lambda mesh: abs(mesh.misalignment))
    size = micrometers(worst.misalignment).replace("< ", "less than ")
    return f"Mesh {worst.name} has the largest misalignment, {size} µm over its face."


def _exaggeration(outline: Outline, case: CaseDeflection) -> float:
    largest = largest_motion(case)
    if largest == 0.0:
        return 1.0
    axis_distance = float(np.max(np.ptp(outline.origin[:, :2], axis=0)))
    exact_scale = DRAWN * max(float(np.max(outline.length)), axis_distance) / largest
    power = 10.0 ** math.floor(math.log10(exact_scale))
    return max(step * power for step in STEPS if step * power <= exact_scale)


def _view_direction(outline: Outline, case: CaseDeflection) -> FloatArray:
    """Return the direction (3,) upwards in the view from the side.

    Along it the two closest axes are as far apart as they can be. Coaxial shafts are seen as they bend most.
    """
    axes = np.unique(np.round(outline.origin[:, :2] / COAXIAL), axis=0) * COAXIAL
    if len(axes) == 1:
        axes = np.vstack([np.zeros(2), case.shafts.motion[:, :2]])
        separation = np.ptp(axes @ VIEWS.T, axis=0)
    else:
        separation = np.diff(np.sort(axes @ VIEWS.T, axis=0), axis=0).min(axis=0)
    return np.array([*VIEWS[np.argmax(separation > (1.0 - 1e-9) * separation.max())], 0.0])


def _along(outline: Outline, case: CaseDeflection, across: FloatArray, scale: float) -> Panel:
    heights = outline.origin @ across
    lines = [*_shafts(outline, heights), *_gears(outline, heights), *_bearings(outline, heights)]
    displacement = case.shafts.motion[:, :2] @ across[:2]
    name = f"axis, {scale:.0f} times"
    for k in range(len(outline.shafts)):
        on_shaft = case.shafts.shaft == k
        z = (outline.origin[k, 2] + case.shafts.position[on_shaft]) / MM
        y = (heights[k] + scale * displacement[on_shaft]) / MM
        lines.append(Line(name, z, y, palette.VERMILLION, width=2.4))
    angle = round(math.degrees(math.atan2(across[1], across[0])))
    axes = Axis("z, mm"), Axis({0: "x, mm", 90: "y, mm"}.get(angle, f"across z, {angle}° from x, mm"))
    return Panel(*axes, tuple(lines), title="From the side", notes=_shaft_names(outline, heights), equal=True)


def _shaft_names(outline: Outline, heights: FloatArray) -> tuple[Note, ...]:
    """Write the names of shafts at their right ends; names that would overlap share a row."""
    ends = outline.origin[:, 2] + outline.length
    row = NEAR * max(float(np.max(outline.length)), float(np.ptp(heights)))
    rows: list[tuple[float, float, list[str]]] = []
    for end, height, name in zip(ends, heights, outline.shafts, strict=True):
        near = (names for z, y, names in rows if abs(z - end) < row and abs(y - height) < row)
        shared_row = next(near, None)
        if shared_row is None:
            rows.append((end, height, [name]))
        else:
            shared_row.append(name)
    return tuple(Note(z / MM, y / MM, ", ".join(names)) for z, y, names in rows)


def _shafts(outline: Outline, heights: FloatArray) -> list[Line]:
    lines = []
    for k, (start, length, left, right) in zip(outline.piece_shaft, outline.piece, strict=True):
        z = (outline.origin[k, 2] + start + length * np.array([0.0, 0.0, 1.0, 1.0, 0.0])) / MM
        y = (heights[k] + 0.5 * np.array([-left, left, right, -right, -left])) / MM
        lines.append(Line("shafts", z, y, palette.MUTED, width=1.2))
    return lines


def _gears(outline: Outline, heights: FloatArray) -> list[Line]:
    lines = []
    for k, (position, width, diameter) in zip(outline.gear_shaft, outline.gear, strict=True):
        z = (outline.origin[k, 2] + position + 0.5 * width * np.array([-1, -1, 1, 1, -1])) / MM
        y = (heights[k] + 0.5 * diameter * np.array([-1, 1, 1, -1, -1])) / MM
        lines.append(Line("gears", z, y, palette.GEARS[0], width=1.6))
    return lines


def _bearings(outline: Outline, heights: FloatArray) -> list[Line]:
    lines = []
    size = 0.03 * float(np.max(outline.length))
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
    lines = []
    for k, (position, _, diameter) in zip(outline.gear_shaft, outline.gear, strict=True):
        center = outline.origin[k, :2]
        on_shaft = case.shafts.shaft == k
        along, motion = case.shafts.position[on_shaft], case.shafts.motion[on_shaft]
        path = np.array([np.interp(position, along, motion[:, axis]) for axis in (0, 1)])
        x, y = (center[:, None] + 0.5 * diameter * np.array([np.cos(CIRCLE), np.sin(CIRCLE)])) / MM
        lines.append(Line("operating pitch circles", x, y, palette.GEARS[0], width=1.4))
        x, y = np.array([center, center + scale * path]).T / MM
        lines.append(Line("path of centers", x, y, palette.VERMILLION, width=2.4, markers=True))
    names = _gear_names(outline)
    points = [name.points / MM for name in names]
    axes = (
        Axis("x, mm", limits=_limits([*(line.x for line in lines), *(xy[:, 0] for xy in points)])),
        Axis("y, mm", limits=_limits([*(line.y for line in lines), *(xy[:, 1] for xy in points)])),
    )
    return Panel(*axes, tuple(lines), title="Against z", notes=tuple(n.note for n in names), equal=True)


def _limits(parts: Sequence[FloatArray]) -> tuple[float, float]:
    """Return the ends of an axis that has all parts of a drawing, with a margin."""
    values = np.concatenate(parts)
    low, high = float(values.min()), float(values.max())
    return low - EDGE * (high - low), high + EDGE * (high - low)
