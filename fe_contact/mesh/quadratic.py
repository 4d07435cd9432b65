"""Six-node triangles with mid-side nodes on the exact outline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.errors import MeshError
from fe_contact.mesh.outline import Outline
from fe_contact.mesh.triangulation import Region, Triangulation
from fe_contact.types import FloatArray, IntArray

SIDES = ((0, 1), (1, 2), (2, 0))


@dataclass(frozen=True)
class QuadraticMesh:
    """Isoparametric six-node triangles.

    Attributes
    ----------
    points : (n, 2) array
        Nodes, m; corners first.
    triangles : (m, 6) array
        Corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0 (order of gmsh and VTK).
    boundary : tuple of int arrays
        Per outline the node numbers of its `nodes`, in their order.
    """

    points: FloatArray
    triangles: IntArray
    boundary: tuple[IntArray, ...]


def region(outlines: Sequence[Outline]) -> Region:
    """Return the polygon through the corners of outlines, the first the outer one."""
    return Region(tuple(o.corners for o in outlines))


def quadratic_mesh(outlines: Sequence[Outline], straight: Triangulation) -> QuadraticMesh:
    """Add mid-side nodes to a triangulation of `region(outlines)`.

    Inner sides get their middle, sides on an outline the outline's own mid-side node.

    Raises
    ------
    MeshError
        An edge of an outline is no side of the triangulation.
    """
    count = len(straight.points)
    sides = np.sort(np.concatenate([straight.triangles[:, side] for side in SIDES]), axis=1)
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
    turned: FloatArray = points @ np.array([[c, s], [-s, c]])
    return turned
