"""Checks of a tetrahedral mesh: shape of its elements, its size, whether it hangs together."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.csgraph import connected_components

from bounds import between
from dynamics.errors import InputError
from dynamics.housing_modes.quadrature import over_volume, tetrahedron
from dynamics.housing_modes.tetrahedral_mesh import EDGES, TetrahedralMesh
from dynamics.types import FloatArray

LEAST_SHAPE = 0.02
"""A sliver: its volume is that part of a regular tetrahedron's with edges of the same mean square."""
SIZE = between(5e-3, 50.0, "m")
FIELD = "mesh_file"


def element_shape(mesh: TetrahedralMesh) -> FloatArray:
    """Return 6 sqrt(2) V / l^3 of each element's corners, l the root mean square of its edges: 1 at best."""
    corner = mesh.points[mesh.tetrahedra[:, :4]]
    edge = corner[:, EDGES[:, 1]] - corner[:, EDGES[:, 0]]
    length = np.sqrt(np.mean(np.sum(edge**2, axis=2), axis=1))
    volume = np.linalg.det(corner[:, 1:] - corner[:, :1]) / 6.0
    return np.asarray(6.0 * np.sqrt(2.0) * volume / length**3)


def check_quality(mesh: TetrahedralMesh) -> None:
    """Refuse a mesh that gives wrong results.

    Raises
    ------
    InputError
        Slivers, elements turned inside out by their mid-side nodes, parts that nothing joins, or a size that
        is no housing's.
    """
    extent = float(np.ptp(mesh.points, axis=0).max())
    if not SIZE.holds(extent):
        raise InputError(f"{FIELD}.size", extent, SIZE, 'Check the unit of the mesh: "m" or "mm".')
    shape = element_shape(mesh)
    if shape.min() < LEAST_SHAPE:
        count, bound = int(np.sum(shape < LEAST_SHAPE)), f"at least {LEAST_SHAPE:g} (1: regular)"
        raise InputError(
            f"{FIELD}.shape", float(shape.min()), bound, f"{count} elements are slivers: mesh again."
        )
    volume, _ = over_volume(mesh.points, mesh.tetrahedra)
    folded = int(np.sum((volume / tetrahedron().weight).min(axis=1) <= 0.0))  # one weight is negative
    if folded:
        advice = "Mid-side nodes fold them: refine where the surface is curved, or use straight edges."
        raise InputError(f"{FIELD}.elements", f"{folded} of {len(volume)} folded", "without folds", advice)
    _check_joined(mesh)


def _check_joined(mesh: TetrahedralMesh) -> None:
    """Refuse a mesh in parts."""
    corners = mesh.tetrahedra[:, :4]
    row, column = np.repeat(corners[:, :1], 3, axis=1).ravel(), corners[:, 1:].ravel()
    count = len(mesh.points)
    graph = sp.coo_array((np.ones(len(row)), (row, column)), shape=(count, count))
    _, label = connected_components(graph, directed=False)
    parts = np.unique(label[corners[:, 0]]).size
    if parts > 1:
        advice = "Unite the bodies, or merge the nodes they share."
        raise InputError(f"{FIELD}.parts", parts, "1: one body whose elements share nodes", advice)
