"""Faces of a meshed housing, chosen from its surface: bores, planes, boxes, named groups.

The surface consists of t six-node triangles; whether one is on a face depends on its three corners alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, NoReturn, Protocol

import numpy as np

from bounds import Quantity, Text, described, required
from dynamics.checks import declared_fields, finite, one_of
from dynamics.errors import InputError
from dynamics.housings.tetrahedral_mesh import TetrahedralMesh
from dynamics.solid_housing import BORE_DIAMETER, BORE_LENGTH
from dynamics.types import BoolArray, FloatArray, IntArray

NEAR = 5e-3
"""Largest distance of a corner from a face that it is on, over the face's size.

The size is the diameter of a bore, or the side of a triangle in a plane. For planes also the difference of
the cosine of the normals from 1.
"""
INWARD = 0.7
"""Least cosine between the normal of a bore's wall and the direction to its axis."""
COVERED = 0.5
"""Least part of a bore's wall that has to exist: a split seat has half of it."""


_TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
"""Corners of a triangle in its local coordinates."""


class WallParts(NamedTuple):
    """The wall of a bore between its ends: w triangles as a whole, c parts of triangles that an end cuts.

    Each part is a triangle between three `corners` in the local coordinates of the one that it is cut from.
    """

    whole: IntArray
    """Shape (w, 6)."""
    cut: IntArray
    """Shape (c, 6)."""
    corners: FloatArray
    """Shape (c, 3, 2)."""


class Face(Protocol):
    """Chooses triangles of a surface."""

    def triangles(self, mesh: TetrahedralMesh) -> IntArray:
        """Return the triangles of `mesh.surface` that are on the face, (t, 6).

        Raises `InputError`: there are none.
        """


def _check_vector(name: str, values: tuple[float, float, float]) -> None:
    if len(values) != 3:
        raise InputError(name, values, "three numbers: x, y, z")
    for index, value in enumerate(values):
        finite(f"{name}[{index}]", value)


def unit(name: str, values: tuple[float, float, float]) -> FloatArray:
    """Return a direction of length 1."""
    _check_vector(name, values)
    length = float(np.linalg.norm(values))
    if length == 0.0:
        raise InputError(name, values, "a direction: not all zero")
    return np.array(values) / length


@described
@dataclass(frozen=True)
class Bore:
    """The wall of a bore: corners within 0.5 % of its diameter of the cylinder, facing its axis.

    ``position`` is the middle of the bore on its axis in m, ``axis`` its direction, as x, y, z of the mesh.
    """

    position: tuple[float, float, float]
    axis: tuple[float, float, float]
    diameter: float = required(BORE_DIAMETER)
    length: float = required(BORE_LENGTH)

    def __post_init__(self) -> None:
        _check_vector("position", self.position)
        unit("axis", self.axis)
        declared_fields(self)

    def triangles(self, mesh: TetrahedralMesh) -> IntArray:
        """Return the triangles of the wall of which at least a part is within the length."""
        parts = self.parts(mesh)
        return np.unique(np.vstack([parts.whole, parts.cut]), axis=0)

    def nodes(self, mesh: TetrahedralMesh) -> IntArray:
        """Return the nodes of the wall that are within the length."""
        nodes = np.unique(self.triangles(mesh))
        along = (mesh.points[nodes] - np.array(self.position)) @ unit("axis", self.axis)
        return np.asarray(nodes[np.abs(along) <= self.length / 2.0 + NEAR * self.diameter])

    def parts(self, mesh: TetrahedralMesh) -> WallParts:
        """Return the wall, its triangles cut at the ends of the bore."""
        axis = unit("axis", self.axis)
        surface, near, half = mesh.surface, NEAR * self.diameter, 0.5 * self.length
        arm = mesh.points[surface[:, :3]] - np.array(self.position)
        along = arm @ axis
        radial = arm - along[..., None] * axis
        radius = np.linalg.norm(radial, axis=2)
        level = np.all(np.abs(along) <= half + near, axis=1)
        normal, area = _normals(mesh, surface)
        # cosine between the outward normal and the direction to the axis; 1e-300: no division by zero
        toward = -np.einsum("ti,ti->t", normal, radial.mean(axis=1)) / np.maximum(radius.mean(axis=1), 1e-300)
        facing = toward >= INWARD
        wall = facing & np.all(np.abs(radius - self.diameter / 2.0) <= near, axis=1)
        across = wall & ~level & (along.min(axis=1) < half) & (along.max(axis=1) > -half)
        cut = [(row, part) for row in np.flatnonzero(across) for part in _between(along[row], half)]
        rows = np.array([row for row, _ in cut], dtype=np.int64)
        corners = np.array([part for _, part in cut]).reshape(-1, 3, 2)
        whole_area = float(area[wall & level].sum())
        # a triangle has the area 1/2 in its local coordinates
        cut_area = float(np.sum(area[rows] * _doubled_area(corners)))
        least_area = COVERED * np.pi * self.diameter * self.length
        if whole_area + cut_area < least_area:
            self._refuse(whole_area, radius[facing & level])
        if whole_area < least_area:
            self._check_length(along[across])
        return WallParts(surface[wall & level], surface[rows], corners)

    def _check_length(self, along: FloatArray) -> None:
        """Refuse a bore that is shorter than an element of its wall.

        `along`: positions along the axis, m, of the corners of triangles that its ends cut.
        """
        extent = float(np.ptp(along, axis=1).max())
        if extent <= self.length:
            return
        element = Quantity(extent, "m", digits=3)
        bound = "at least that of an element of the wall"
        wall = Text.of("The wall of this diameter is there, of elements up to ", element, " along the axis. ")
        raise InputError(
            "length", self.length, bound, Text.of(wall, "State a longer part, or mesh it finer.")
        )

    def _refuse(self, area: float, radii: FloatArray) -> NoReturn:
        """Refuse a bore of whose wall too small an area, m^2, exists; `radii`, m: those of other walls."""
        share = area / (np.pi * self.diameter * self.length)
        others = Text.of("no wall faces the axis there")
        if radii.size:
            nearest = Quantity(2.0 * float(radii.min()), "m", digits=3)
            others = Text.of("the nearest wall that faces the axis has a diameter of ", nearest)
        present_share = f" ({share:.0%} is)" if share > 0.0 else ""
        bound = f"that of a bore of the mesh, of which at least {COVERED:.0%} is there{present_share}"
        x, y, z = (Quantity(value, "m", digits=6) for value in self.position)
        location = Text.of("Its middle is expected at ", x, ", ", y, ", ", z, ". Check ")
        remedy = Text.of(location, "position, axis, length and the unit of the mesh: ", others, ".")
        raise InputError("diameter", self.diameter, bound, remedy)


@dataclass(frozen=True)
class Plane:
    """The flat part of the surface through `point` (m) whose outward normal is `normal`."""

    point: tuple[float, float, float]
    normal: tuple[float, float, float]

    def __post_init__(self) -> None:
        _check_vector("point", self.point)
        unit("normal", self.normal)

    def triangles(self, mesh: TetrahedralMesh) -> IntArray:
        """Return the triangles in the plane."""
        direction, surface = unit("normal", self.normal), mesh.surface
        height = (mesh.points[surface[:, :3]] - np.array(self.point)) @ direction
        normals, areas = _normals(mesh, surface)
        size, facing = np.sqrt(areas)[:, None], normals @ direction > 1.0 - NEAR
        return _require_facets(
            "point", self.point, mesh, facing & np.all(np.abs(height) <= NEAR * size, axis=1)
        )


@dataclass(frozen=True)
class Box:
    """The part of the surface inside a box along the axes, from `low` to `high` (m)."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def __post_init__(self) -> None:
        _check_vector("low", self.low)
        _check_vector("high", self.high)

    def triangles(self, mesh: TetrahedralMesh) -> IntArray:
        """Return the triangles whose corners are all inside."""
        corner = mesh.points[mesh.surface[:, :3]]
        inside = np.all((corner >= np.array(self.low)) & (corner <= np.array(self.high)), axis=(1, 2))
        return _require_facets("low", self.low, mesh, inside)


@dataclass(frozen=True)
class BoundedPlane:
    """The part of a plane inside a box."""

    plane: Plane
    box: Box

    def triangles(self, mesh: TetrahedralMesh) -> IntArray:
        """Return the triangles that are in both."""
        flat, inside = self.plane.triangles(mesh), self.box.triangles(mesh)
        # two corners identify a triangle of the surface in its order of corners; one number for the two
        both = np.isin(
            flat[:, 0] * len(mesh.points) + flat[:, 1], inside[:, 0] * len(mesh.points) + inside[:, 1]
        )
        if not both.any():
            raise InputError("box", (self.box.low, self.box.high), "one that holds triangles of the plane")
        return np.asarray(flat[both])


@dataclass(frozen=True)
class Group:
    """A named part of the surface: a physical group, a node set."""

    name: str

    def triangles(self, mesh: TetrahedralMesh) -> IntArray:
        """Return the triangles whose corners all belong to the group."""
        one_of("name", self.name, list(mesh.groups), "Name the physical group or node set in the mesh file.")
        member = np.zeros(len(mesh.points), dtype=bool)
        member[mesh.groups[self.name]] = True
        return _require_facets("name", self.name, mesh, np.all(member[mesh.surface[:, :3]], axis=1))


def _between(along: FloatArray, half: float) -> list[FloatArray]:
    """Return the triangles (3, 2), in local coordinates, that make up a triangle between two planes.

    `along` (3,): heights of its corners, linear between them; the planes are at the heights +-`half`.
    """
    polygon = np.column_stack([_TRIANGLE, along])
    for side in (1.0, -1.0):  # what is below the upper plane, then what is above the lower one
        inner: list[FloatArray] = []
        for start, end in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            is_in, is_end_in = side * start[2] <= half, side * end[2] <= half
            if is_in:
                inner.append(start)
            if is_in != is_end_in:  # the edge crosses the plane
                inner.append(start + (side * half - start[2]) / (end[2] - start[2]) * (end - start))
        polygon = np.array(inner).reshape(-1, 3)
    fan = [polygon[[0, k, k + 1], :2] for k in range(1, len(polygon) - 1)]
    return [part for part in fan if _doubled_area(part[None])[0] > 0.0]


def _doubled_area(corners: FloatArray) -> FloatArray:
    """Return twice the areas of triangles (c, 3, 2) with corners in positive order."""
    a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _normals(mesh: TetrahedralMesh, triangles: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return unit normals and areas of the flat triangles between corners."""
    a, b, c = (mesh.points[triangles[:, k]] for k in range(3))
    area = np.cross(b - a, c - a) / 2.0
    size = np.linalg.norm(area, axis=1)
    return area / size[:, None], size


def _require_facets(field: str, value: object, mesh: TetrahedralMesh, chosen: BoolArray) -> IntArray:
    """Return the chosen (t,) triangles of the surface; raises `InputError` for `field`: there are none."""
    if not chosen.any():
        extent = np.stack([mesh.points.min(axis=0), mesh.points.max(axis=0)], axis=1).ravel()
        ends = (Quantity(float(end), "m", digits=6) for end in extent)
        separators = ("The mesh spans ", " to ", ", ", " to ", ", ", " to ")
        remedy = Text.of(
            *(part for pair in zip(separators, ends, strict=True) for part in pair), " in x, y, z."
        )
        raise InputError(field, value, "where the surface has triangles", remedy)
    return np.asarray(mesh.surface[chosen])
