"""Faces of a meshed housing, chosen from its surface: bores, planes, boxes, named groups.

The surface consists of t six-node triangles; whether one is on a face depends on its three corners alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn, Protocol

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
        """Return the triangles of the wall."""
        axis = unit("axis", self.axis)
        surface, near = mesh.surface, NEAR * self.diameter
        arm = mesh.points[surface[:, :3]] - np.array(self.position)
        along = arm @ axis
        radial = arm - along[..., None] * axis
        radius = np.linalg.norm(radial, axis=2)
        level = np.all(np.abs(along) <= self.length / 2.0 + near, axis=1)
        normal, area = _normals(mesh, surface)
        # cosine between the outward normal and the direction to the axis; 1e-300: no division by zero
        toward = -np.einsum("ti,ti->t", normal, radial.mean(axis=1)) / np.maximum(radius.mean(axis=1), 1e-300)
        facing = toward >= INWARD
        wall = facing & np.all(np.abs(radius - self.diameter / 2.0) <= near, axis=1)
        chosen = wall & level
        if area[chosen].sum() < COVERED * np.pi * self.diameter * self.length:
            # triangles of which at least a part is within the length
            across = (along.min(axis=1) < self.length / 2.0) & (along.max(axis=1) > -self.length / 2.0)
            self._check_length(float(area[wall & across].sum()), along[wall & across])
            self._refuse(float(area[chosen].sum()), radius[facing & level])
        return np.asarray(surface[chosen])

    def _check_length(self, area: float, along: FloatArray) -> None:
        """Refuse a bore whose wall exists, but in elements that reach beyond the bore's stated length.

        `area`: that of triangles with at least a part within the length, m^2; `along`: positions of their
        corners along the axis, m.
        """
        if area < COVERED * np.pi * self.diameter * self.length:
            return
        element = Quantity(float(np.ptp(along, axis=1).max()), "m", digits=3)
        bound = "one between whose ends elements of the wall lie"
        wall = Text.of("The wall of this diameter is there, of elements up to ", element, " along the axis ")
        remedy = "that reach beyond this length. State the whole length of the wall, or mesh it finer."
        raise InputError("length", self.length, bound, Text.of(wall, remedy))

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
