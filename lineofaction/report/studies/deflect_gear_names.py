"""Names of gears outside their circles, seen along the axes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lineofaction.gearbox.studies.deflect.result import Outline
from lineofaction.gearbox.units import MM
from lineofaction.report.drawing.figure import FloatArray, Note

WAYS = np.array([(math.cos(a), math.sin(a)) for a in np.radians(np.arange(45.0, 405.0, 22.5))])
"""Of the radii at whose ends a name may begin, the preferred first."""
CHARACTER, ROW = 0.013, 0.03
"""Width and height of a character over the size of the drawing."""


class GearName(NamedTuple):
    """The name of a gear and points (n, 2) along it, m."""

    note: Note
    points: FloatArray


def gear_names(outline: Outline) -> tuple[GearName, ...]:
    """Return each name where it is farthest from all circles and from the names before it."""
    center, radius = outline.origin[outline.gear_shaft, :2], 0.5 * outline.gear[:, 2]
    names: list[GearName] = []
    for k, text in enumerate(outline.gears):
        written = np.vstack([np.empty((0, 2)), *(name.points for name in names)])
        places = [_at(text, center[k] + radius[k] * way, way, _size(center, radius)) for way in WAYS]
        names.append(max(places, key=lambda place: _room(place.points, center, radius, written)))
    return tuple(names)


def _size(center: FloatArray, radius: FloatArray) -> float:
    """Return the larger extent of the circles, m."""
    ends = np.vstack([center - radius[:, None], center + radius[:, None]])
    return float(np.max(np.ptp(ends, axis=0)))


def _at(text: str, start: FloatArray, way: FloatArray, size: float) -> GearName:
    """Return a name that begins at a point of its circle and leads away from it."""
    side, above = math.copysign(1.0, way[0]), math.copysign(1.0, way[1])
    along = np.linspace(0.0, side * CHARACTER * len(text), 2 + len(text) // 3) * size
    points = np.column_stack([start[0] + along, np.full_like(along, start[1] + above * ROW * size)])
    note = Note(start[0] / MM, start[1] / MM, text, row=0 if above > 0.0 else -1, left=side < 0.0)
    return GearName(note, points)


def _room(points: FloatArray, center: FloatArray, radius: FloatArray, written: FloatArray) -> float:
    """Return the least distance of points (n, 2) to circles and to the points (m, 2) of other names, m."""
    circles = np.abs(np.linalg.norm(points[:, None] - center, axis=2) - radius)
    texts = np.linalg.norm(points[:, None] - written, axis=2)
    return float(np.min(np.hstack([circles, texts])))
