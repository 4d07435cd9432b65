"""Stiffness of six-node triangles in plane strain."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from fe_contact.material import Material
from fe_contact.mesh.quality import shape_derivatives
from fe_contact.types import FloatArray, IntArray

_A, _B = 0.445948490915965, 0.091576213509771


POINTS = np.array(
    [
        [_A, _A],
        [1.0 - 2.0 * _A, _A],
        [_A, 1.0 - 2.0 * _A],
        [_B, _B],
        [1.0 - 2.0 * _B, _B],
        [_B, 1.0 - 2.0 * _B],
    ]
)


WEIGHTS = 0.5 * np.repeat([0.223381589678011, 0.109951743655322], 3)
"""Six points of order 4 (Dunavant 1985): exact on straight sides, enough on curved ones."""


def plane_strain_stiffness(points: FloatArray, triangles: IntArray, material: Material) -> sp.csc_array:
    """Assemble the stiffness of linear elasticity, symmetric (2 n, 2 n), N/m per m.

    Triangles (m, 6) have corners counter-clockwise, then the middles of sides 0-1, 1-2, 2-0. Freedom 2 i
    + c is component c of node i.
    """
    local = _element_stiffness(points[triangles], _elasticity(material))
    freedoms = (2 * triangles[:, :, None] + np.arange(2)).reshape(len(triangles), 12)
    rows = np.broadcast_to(freedoms[:, :, None], local.shape).ravel()
    columns = np.broadcast_to(freedoms[:, None, :], local.shape).ravel()
    size = 2 * len(points)
    return sp.csc_array(sp.coo_array((local.ravel(), (rows, columns)), shape=(size, size)))


def _elasticity(material: Material) -> FloatArray:
    modulus, nu = material.youngs_modulus, material.poissons_ratio
    factor = modulus / ((1.0 + nu) * (1.0 - 2.0 * nu))
    rows = [[1.0 - nu, nu, 0.0], [nu, 1.0 - nu, 0.0], [0.0, 0.0, 0.5 - nu]]
    return factor * np.array(rows)


def _element_stiffness(nodes: FloatArray, elasticity: FloatArray) -> FloatArray:
    """Return the element matrices (m, 12, 12) of nodes (m, 6, 2)."""
    slopes = shape_derivatives(POINTS)
    total = np.zeros((len(nodes), 12, 12))
    for slope, weight in zip(slopes, WEIGHTS, strict=True):
        jacobian = slope @ nodes  # (m, d, x)
        determinant = jacobian[:, 0, 0] * jacobian[:, 1, 1] - jacobian[:, 0, 1] * jacobian[:, 1, 0]
        inverse = np.empty_like(jacobian)
        inverse[:, 0, 0], inverse[:, 1, 1] = jacobian[:, 1, 1], jacobian[:, 0, 0]
        inverse[:, 0, 1], inverse[:, 1, 0] = -jacobian[:, 0, 1], -jacobian[:, 1, 0]
        gradient = (inverse / determinant[:, None, None]) @ slope  # (m, x, a)
        strain = np.zeros((len(nodes), 3, 12))
        strain[:, 0, 0::2] = strain[:, 2, 1::2] = gradient[:, 0]
        strain[:, 1, 1::2] = strain[:, 2, 0::2] = gradient[:, 1]
        stress = elasticity @ strain * (weight * determinant)[:, None, None]
        total += strain.transpose(0, 2, 1) @ stress
    return total
