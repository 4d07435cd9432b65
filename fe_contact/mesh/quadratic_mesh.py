"""Six-node triangles with mid-side nodes on the exact outline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fe_contact.errors import MeshError
from fe_contact.mesh.gmsh_process import ask_gmsh
from fe_contact.mesh.outline import Outline
from fe_contact.mesh.quality import QualityLimits, refuse_poor_elements
from fe_contact.types import FloatArray, IntArray

SIDES = ((0, 1), (1, 2), (2, 0))


@dataclass(frozen=True)
class Region:
    """Polygon with holes: `loops[0]` is the outer boundary, each loop (n, 2), first point not repeated."""

    loops: tuple[FloatArray, ...]
    scale: float = 1.0
    """Length in m of which gmsh works in multiples: its tolerances are absolute."""
    growth: float = 0.3
    """Growth of the triangles from the size of the boundary edges, per unit distance."""


@dataclass(frozen=True)
class Triangulation:
    """Straight triangles."""

    points: FloatArray
    """The points of the region's loops first, bit for bit and in their order, then the inner ones. Shape (n,
    2).
    """
    triangles: IntArray
    """Corner indices, counter-clockwise. Shape (m, 3)."""


def triangulate(
    regions: Sequence[Region], seconds: float = 60.0, command: Sequence[str] | None = None
) -> list[Triangulation]:
    """Fill each region with triangles that keep the edges of its loops undivided.

    All regions are meshed in one child process, killed after `seconds`: the gmsh worker, or `command`. Raises
    `MeshError`: the child failed, was killed, ran out of time or answered nonsense; the message says which.
    """
    loops = [[(loop / region.scale).tolist() for loop in region.loops] for region in regions]
    growth = [region.growth for region in regions]
    answer = ask_gmsh({"regions": loops, "growth": growth}, seconds, command)
    try:
        return [
            _received_triangulation(region, mesh)
            for region, mesh in zip(regions, answer["regions"], strict=True)
        ]
    except (KeyError, ValueError, TypeError) as error:
        raise MeshError("gmsh worker: unusable answer") from error


def _received_triangulation(region: Region, mesh: dict[str, Any]) -> Triangulation:
    """Convert one answer, with the boundary points as they were given and triangles counter-clockwise."""
    points = np.array(mesh["points"], dtype=float).reshape(-1, 2) * region.scale
    boundary = np.concatenate(region.loops)
    points[: len(boundary)] = boundary
    triangles = np.array(mesh["triangles"], dtype=np.int64).reshape(-1, 3)
    if len(triangles) == 0:
        raise ValueError("no triangles")
    a, b, c = (points[triangles[:, i]] for i in range(3))
    ab, ac = b - a, c - a
    clockwise = ab[:, 0] * ac[:, 1] < ab[:, 1] * ac[:, 0]
    triangles[clockwise] = triangles[clockwise][:, [0, 2, 1]]
    return Triangulation(points, triangles)


@dataclass(frozen=True)
class QuadraticMesh:
    """Isoparametric six-node triangles."""

    points: FloatArray
    """Nodes, m; corners first. Shape (n, 2)."""
    triangles: IntArray
    """Corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0 (order of gmsh and VTK). Shape (m,
    6).
    """
    boundary: tuple[IntArray, ...]
    """Per outline the node numbers of its `nodes`, in their order."""


@dataclass(frozen=True)
class Part:
    """Part of a section."""

    name: str
    """Name in messages."""
    outlines: tuple[Outline, ...]
    """Outlines, the outer one first."""
    scale: float
    growth: float
    """`scale`, `growth`: As in `Region`."""

    @property
    def region(self) -> Region:
        """Polygon through the corners of the outlines."""
        return Region(tuple(outline.corners for outline in self.outlines), self.scale, self.growth)


def quadratic_meshes(
    parts: Sequence[Part], limits: QualityLimits, seconds: float = 60.0
) -> list[QuadraticMesh]:
    """Fill each part with checked triangles, all in one child process (`triangulate`).

    Raises `MeshError`: gmsh failed, was killed or ran out of time, or an element misses its quality limit.
    """
    meshes = []
    straight = triangulate([part.region for part in parts], seconds)
    for part, triangles in zip(parts, straight, strict=True):
        mesh = with_mid_side_nodes(part.outlines, triangles)
        refuse_poor_elements(part.name, mesh.points, mesh.triangles, limits)
        meshes.append(mesh)
    return meshes


def with_mid_side_nodes(outlines: Sequence[Outline], straight: Triangulation) -> QuadraticMesh:
    """Add mid-side nodes to a triangulation of the polygons through the corners of outlines.

    Inner sides get their middle, sides on an outline the outline's own mid-side node. Raises `MeshError`: an
    edge of an outline is no side of the triangulation.
    """
    count = len(straight.points)
    sides = np.sort(np.concatenate([straight.triangles[:, side] for side in SIDES]), axis=1)
    # one whole number for each side, by its two corners in rising order
    keys, inverse = np.unique(sides[:, 0] * count + sides[:, 1], return_inverse=True)
    first, second = keys // count, keys % count
    points = np.concatenate([straight.points, 0.5 * (straight.points[first] + straight.points[second])])
    triangles = np.concatenate([straight.triangles, count + inverse.reshape(3, -1).T], axis=1)
    boundary, start = [], 0
    for outline in outlines:
        nodes = _numbered(outline, start, count, keys)
        points[nodes] = outline.nodes
        boundary.append(nodes)
        start += len(outline.corners)
    return QuadraticMesh(points, triangles, tuple(boundary))


def _numbered(outline: Outline, start: int, count: int, keys: IntArray) -> IntArray:
    """Return the node numbers along an outline whose corners are numbered from `start`."""
    n = len(outline.corners)
    corners = start + np.arange(n)
    following = start + (np.arange(n) + 1) % n
    edges = np.minimum(corners, following) * count + np.maximum(corners, following)
    index = np.minimum(np.searchsorted(keys, edges), len(keys) - 1)
    if not np.array_equal(keys[index], edges):
        raise MeshError("gmsh worker: an edge of the outline was divided")
    nodes = np.empty(2 * n, dtype=np.int64)
    nodes[::2], nodes[1::2] = corners, count + index
    return nodes


def rotated(points: FloatArray, angle: float) -> FloatArray:
    """Return points turned counter-clockwise by `angle` about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    result: FloatArray = points @ np.array([[c, s], [-s, c]])
    return result
