"""Bores of a solid: faces of cylinders about one axis that lie at the same height are one bore."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.housings.mesh_faces import COVERED, Bore
from dynamics.types import FloatArray

_SAME = 1e-6
"""Difference below which directions (1), or positions, radii and heights (m), are the same."""


@dataclass(frozen=True)
class BoreWall:
    """A hollow face of a cylinder: a point on its axis and the axis, its radius, area, and ends along it."""

    point: FloatArray
    axis: FloatArray
    radius: float
    area: float
    low: float
    high: float


def bores_of_walls(walls: Sequence[BoreWall]) -> Iterator[Bore]:
    """Yield the bores that walls with one axis and radius form; walls that overlap in height are one bore."""
    for group in _coaxial(walls):
        first = group[0]
        parts = sorted(_ends(wall, first) for wall in group)
        while parts:
            low, high, area = parts.pop(0)
            while parts and parts[0][0] < high - _SAME:
                _, end, wall_area = parts.pop(0)
                high, area = max(high, end), area + wall_area
            if area >= 2.0 * np.pi * first.radius * (high - low) * COVERED:
                middle = first.point + 0.5 * (low + high) * first.axis
                yield Bore(triple(middle), triple(first.axis), 2.0 * first.radius, high - low)


def _coaxial(walls: Sequence[BoreWall]) -> Iterator[list[BoreWall]]:
    """Yield the walls that have axis and radius in common."""
    groups: list[list[BoreWall]] = []
    for wall in walls:
        group = next((group for group in groups if _same_cylinder(group[0], wall)), None)
        if group is None:
            groups.append([wall])
        else:
            group.append(wall)
    yield from groups


def _same_cylinder(wall: BoreWall, other: BoreWall) -> bool:
    arm = other.point - wall.point
    distance = np.linalg.norm(arm - (arm @ wall.axis) * wall.axis)
    parallel = np.linalg.norm(np.cross(wall.axis, other.axis)) < _SAME
    return bool(parallel and distance < _SAME and abs(wall.radius - other.radius) < _SAME)


def _ends(wall: BoreWall, first: BoreWall) -> tuple[float, float, float]:
    """Return the ends of a wall along the axis of the first from its point, and its area."""
    ends = [float((wall.point + end * wall.axis - first.point) @ first.axis) for end in (wall.low, wall.high)]
    return min(ends), max(ends), wall.area


def triple(values: FloatArray) -> tuple[float, float, float]:
    """Return a vector (3,) as plain numbers."""
    x, y, z = map(float, values)
    return x, y, z
