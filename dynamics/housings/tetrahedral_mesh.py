"""Meshes of quadratic tetrahedra and their outer surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from dynamics.types import FloatArray, IntArray

EDGES = np.array([[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]])
"""Corners of the mid-side nodes 4 to 9, as VTK, Abaqus (C3D10) and Nastran (CTETRA) order them."""
FACES = np.array([[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]])
"""Nodes of the faces: three corners, counter-clockwise from outside, then the mid-side nodes after them."""


@dataclass(frozen=True)
class TetrahedralMesh:
    """Quadratic tetrahedra with ten nodes."""

    points: FloatArray
    """Points of the mesh, m; every point belongs to a tetrahedron. Shape (n, 3)."""
    tetrahedra: IntArray
    """Four corners with positive volume, then the mid-side nodes of `EDGES`. Shape (e, 10)."""
    groups: Mapping[str, IntArray] = field(default_factory=dict)
    """Nodes of named parts of the surface: physical groups, node sets."""

    @cached_property
    def surface(self) -> IntArray:
        """Triangles with six nodes that bound the body, (t, 6), normals outward by the right-hand rule."""
        faces = self.tetrahedra[:, FACES].reshape(-1, 6)
        corners = np.sort(faces[:, :3], axis=1)
        _, first, count = np.unique(corners, axis=0, return_index=True, return_counts=True)
        return np.asarray(faces[np.sort(first[count == 1])])

    @property
    def freedoms(self) -> int:
        """Displacements of all nodes."""
        return 3 * len(self.points)


def raised(corners: IntArray, points: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return points and tetrahedra with mid-side nodes in the middle of straight edges.

    Parameters
    ----------
    corners : (e, 4) int array
    points : (n, 3) array
    """
    ends = np.sort(corners[:, EDGES].reshape(-1, 2), axis=1)
    edges, number = np.unique(ends, axis=0, return_inverse=True)
    middle = points[edges].mean(axis=1)
    midside = len(points) + number.reshape(-1, len(EDGES))
    return np.vstack([points, middle]), np.hstack([corners, midside])
