"""Stiffness of 20-node hexahedra between turned copies of a section, by scikit-fem's serendipity element."""

from __future__ import annotations

import numpy as np
from skfem import ElementHexS2
from skfem.quadrature import get_quadrature

from fe_contact.errors import MeshError
from fe_contact.types import FloatArray

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


def layer_nodes(section: FloatArray, thickness: float, turn: float) -> FloatArray:
    """Return the nodes of the hexahedra between two turned copies of quadrilaterals.

    Parameters
    ----------
    section : (m, 8, 2) array
        Corners counter-clockwise, middles of sides 0-1, 1-2, 2-3, 3-0, at the middle of the layer, m.
    thickness, turn : float
        Of the layer, m, and the angle by which its top is turned against its bottom, rad.

    Returns
    -------
    (m, 20, 3) array
        m; z = 0 at the middle of the layer.
    """
    return above(section[:, SECTION], 0.5 * REFERENCE[:, 2], thickness, turn)


def above(points: FloatArray, level: FloatArray, thickness: float, turn: float) -> FloatArray:
    """Return section points (m, p, 2) swept along the helix to the levels (p,), in layers: (m, p, 3)."""
    x, y = points[..., 0], points[..., 1]
    c, s = np.cos(turn * level), np.sin(turn * level)
    return np.stack([c * x - s * y, s * x + c * y, np.broadcast_to(thickness * level, x.shape)], axis=-1)


def stiffness_of(nodes: FloatArray, lame: tuple[float, float]) -> FloatArray:
    """Return the stiffness of isoparametric hexahedra.

    Parameters
    ----------
    nodes : (m, 20, 3) array
        m, in the order of `REFERENCE`.
    lame : (float, float)
        lambda and mu, Pa.

    Returns
    -------
    (m, 60, 60) array
        Freedom 3 i + c is the Cartesian component c of node i, N/m.

    Raises
    ------
    MeshError
        An element is folded.
    """
    gradient, volume = _gradients(nodes)
    weighted = gradient * volume[:, :, None, None]
    count = len(nodes)
    products = gradient.reshape(count, -1, 60).transpose(0, 2, 1) @ weighted.reshape(count, -1, 60)
    products = products.reshape(count, 20, 3, 20, 3)
    trace = np.einsum("miaja->mij", products)
    lam, mu = lame
    local = lam * products + mu * products.transpose(0, 1, 4, 3, 2)
    for c in range(3):
        local[:, :, c, :, c] += mu * trace
    return np.asarray(local.reshape(count, 60, 60))


def in_frames(stiffness: FloatArray, frames: FloatArray) -> FloatArray:
    """Return Q' K Q for matrices (m, 60, 60) and node frames Q (m, 20, 3, 3), the new axes in columns."""
    count = len(stiffness)
    blocks = stiffness.reshape(count, 20, 3, 20, 3).transpose(0, 1, 3, 2, 4)
    turned = frames.transpose(0, 1, 3, 2)[:, :, None] @ blocks @ frames[:, None]
    return np.asarray(turned.transpose(0, 1, 3, 2, 4).reshape(count, 60, 60))


def _gradients(nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the gradients (m, q, 20, 3) of the functions, and the volume of each Gauss point (m, q)."""
    at, weights = get_quadrature(ElementHexS2, QUADRATURE_ORDER)
    gradient, determinant = gradients_at(nodes, at)
    if not determinant.min() > 0.0:
        worst = int(determinant.min(axis=1).argmin())
        x, y = 1e3 * nodes[worst, :, :2].mean(axis=0)
        raise MeshError(
            f"tooth sector: element {worst} at ({x:.4g}, {y:.4g}) mm is folded. "
            "Try other element sizes in the sector recipe."
        )
    return gradient, determinant * weights


def gradients_at(nodes: FloatArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the gradients (m, q, 20, 3) of the functions and the determinants (m, q) at points (3, q).

    The points are of scikit-fem's reference cube, 0 to 1 each way.
    """
    element = ElementHexS2()
    here = np.abs(element.doflocs[:, None] - 0.5 * (REFERENCE + 1.0)).sum(axis=2).argmin(axis=0)
    slopes = np.stack([element.lbasis(at.copy(), i)[1] for i in here]).transpose(2, 1, 0)  # (q, 3, 20)
    jacobian = slopes @ nodes[:, None]
    determinant = np.linalg.det(jacobian)
    singular = np.abs(determinant) <= 0.0
    jacobian[singular] = np.eye(3)  # a folded element, which the determinant tells
    gradient = np.linalg.solve(jacobian, np.broadcast_to(slopes, (len(nodes), *slopes.shape)))
    return np.ascontiguousarray(gradient.transpose(0, 1, 3, 2)), determinant


def cylindrical_frames(nodes: FloatArray) -> FloatArray:
    """Return the frames (m, p, 3, 3) at nodes (m, p, 3): columns radial, tangential, axial."""
    radial = nodes[..., :2] / np.linalg.norm(nodes[..., :2], axis=-1, keepdims=True)
    frames = np.zeros((*nodes.shape[:2], 3, 3))
    frames[..., :2, 0] = radial
    frames[..., 0, 1], frames[..., 1, 1] = -radial[..., 1], radial[..., 0]
    frames[..., 2, 2] = 1.0
    return frames
