"""Stiffness of 20-node hexahedra between turned copies of a section, by scikit-fem's serendipity element.

Nodes are in VTK's order, which differs from scikit-fem's. The m elements of a layer are each between a bottom
and a top, copies of one eight-node quadrilateral of the plane section.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from fe_contact.compliance.plane_elasticity import element_stiffness
from fe_contact.errors import MeshError
from fe_contact.types import FloatArray, IntArray
from host.optional_modules import skfem

# Reference coordinates of the nodes: bottom corners, top corners, bottom middles, top middles, uprights.
_RING = [(-1, -1), (1, -1), (1, 1), (-1, 1)]

_SIDES = [(0, -1), (1, 0), (0, 1), (-1, 0)]

REFERENCE = np.array(
    [(x, y, z) for ring in (_RING, _SIDES) for z in (-1, 1) for x, y in ring] + [(x, y, 0) for x, y in _RING],
    dtype=float,
)

SECTION = np.array([0, 1, 2, 3, 0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 0, 1, 2, 3])
"""Node of the quadrilateral that each node of the hexahedron stands above."""

QUADRATURE_ORDER = 5  # three Gauss points each way


@cache
def _numbering() -> tuple[IntArray, IntArray]:
    """Return VTK's node of each of scikit-fem's functions, and the reverse.

    Reference cubes go from 0 to 1 and from -1 to 1.
    """
    distance = np.abs(skfem.ElementHexS2.doflocs[:, None] - 0.5 * (REFERENCE + 1.0)).sum(axis=2)
    return distance.argmin(axis=1), distance.argmin(axis=0)


def layer_nodes(section: FloatArray, thickness: float, angle: float) -> FloatArray:
    """Return the nodes (m, 20, 3) of the hexahedra between two turned copies of quadrilaterals, m.

    `section` (m, 8, 2) has corners counter-clockwise and middles of sides 0-1, 1-2, 2-3, 3-0 at the
    middle of the layer, where z = 0. Its top is turned against its bottom by `angle` in rad.
    """
    return above(section[:, SECTION], 0.5 * REFERENCE[:, 2], thickness, angle)


def above(points: FloatArray, level: FloatArray, thickness: float, angle: float) -> FloatArray:
    """Return section points (m, p, 2) swept along the helix to levels (p,), as (m, p, 3) in m.

    A level counts from the middle of a layer in its thickness; `angle` is the turn of a layer, rad.
    """
    x, y = points[..., 0], points[..., 1]
    c, s = np.cos(angle * level), np.sin(angle * level)
    return np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(thickness * level, x.shape)], axis=-1)


def hexahedra(nodes: FloatArray) -> skfem.MeshHex:
    """Return scikit-fem's mesh of unconnected hexahedra with `nodes` (m, 20, 3) in m."""
    numbers = np.arange(20 * len(nodes)).reshape(-1, 20)
    nodes_of_functions, _ = _numbering()
    return skfem.MeshHex(nodes.reshape(-1, 3).T, numbers[:, nodes_of_functions].T, elem=skfem.ElementHexS2)


def determinants(mesh: skfem.MeshHex, at: FloatArray) -> FloatArray:
    """Return the determinants (m, q) of the map from scikit-fem's cube, 0 to 1 each way, at points (3, q)."""
    rows = mesh.mapping().DF(at)
    return np.asarray(np.sum(rows[0] * np.cross(rows[1], rows[2], axis=0), axis=0))


def gradients(mesh: skfem.MeshHex, at: FloatArray) -> FloatArray:
    """Return the gradients (m, q, 20, 3), 1/m, of the shape functions at points (3, q) of that cube."""
    basis = skfem.Basis(
        mesh, skfem.ElementHexS2(), quadrature=(at, np.ones(at.shape[1])), disable_doflocs=True
    )
    return np.stack([basis.basis[i][0].grad for i in _numbering()[1]]).transpose(2, 3, 0, 1)


def stiffness_of(nodes: FloatArray, lame: tuple[float, float]) -> FloatArray:
    """Return the stiffness (m, 60, 60) of hexahedra with `nodes` (m, 20, 3) in m as in `REFERENCE`, N/m.

    Freedom 3 i + c is the Cartesian component c of node i; `lame` are lambda and mu, Pa. Raises `MeshError`:
    an element is folded.
    """
    mesh = hexahedra(nodes)
    minimum = determinants(
        mesh, skfem.quadrature.get_quadrature(skfem.ElementHexS2, QUADRATURE_ORDER)[0]
    ).min(axis=1)
    if not minimum.min() > 0.0:
        worst = int(minimum.argmin())
        x, y = 1e3 * nodes[worst, :, :2].mean(axis=0)
        raise MeshError(
            f"tooth sector: element {worst} at ({x:.4g}, {y:.4g}) mm is folded. "
            "Try other element sizes in the sector recipe."
        )
    freedoms = (3 * _numbering()[1][:, None] + np.arange(3)).ravel()
    return element_stiffness(mesh, QUADRATURE_ORDER, lame)[:, freedoms[:, None], freedoms]


def cylindrical_frames(nodes: FloatArray) -> FloatArray:
    """Return the frames (m, p, 3, 3) at nodes (m, p, 3): columns radial, tangential, axial."""
    radial = nodes[..., :2] / np.linalg.norm(nodes[..., :2], axis=-1, keepdims=True)
    frames = np.zeros((*nodes.shape[:2], 3, 3))
    frames[..., :2, 0] = radial
    frames[..., 0, 1], frames[..., 1, 1] = -radial[..., 1], radial[..., 0]
    frames[..., 2, 2] = 1.0
    return frames
