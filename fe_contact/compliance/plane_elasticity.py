"""Plane elasticity: the hypotheses of plane strain and plane stress, and the stiffness of a section."""

from __future__ import annotations

from enum import Enum

import numpy as np
import scipy.sparse as sp
from skfem import Basis, ElementTriP2, MeshTri, MeshTri2

from fe_contact.material import Material
from fe_contact.types import FloatArray, IntArray

# Plane hypotheses: what the missing dimension does.


class PlaneHypothesis(Enum):
    """Plane strain (no strain along the axis: wide gears) or plane stress (free faces: thin gears)."""

    PLANE_STRAIN = "plane_strain"
    PLANE_STRESS = "plane_stress"

    def lame_parameters(self, material: Material) -> tuple[float, float]:
        """Return lambda and mu in Pa of the plane problem; lambda is the reduced one in plane stress.

        Timoshenko and Goodier, Theory of Elasticity, 3rd ed., articles 16 and 17.
        """
        E, nu = material.youngs_modulus, material.poissons_ratio
        mu = 0.5 * E / (1.0 + nu)
        if self is PlaneHypothesis.PLANE_STRESS:
            return E * nu / (1.0 - nu**2), mu
        return E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), mu

    def contact_modulus(self, material: Material) -> float:
        """Return E / (1 - nu^2) in plane strain, E in plane stress, Pa: the modulus of the half plane."""
        if self is PlaneHypothesis.PLANE_STRESS:
            return material.youngs_modulus
        return material.plane_strain_modulus


QUADRATURE_ORDER = 4  # exact on straight sides (order 2); curved sides need more
SIDES = ((0, 1), (1, 2), (2, 0))


def stiffness_matrix(
    points: FloatArray,
    triangles: IntArray,
    lame: tuple[float, float],
    thickness: FloatArray | float = 1.0,
) -> sp.csc_array:
    """Assemble the stiffness of linear elasticity per unit thickness.

    Parameters
    ----------
    points : (n, 2) array
        Nodes, m.
    triangles : (m, 6) array
        Corners, then middles of sides 0-1, 1-2, 2-0.
    lame : (float, float)
        lambda and mu of the plane problem, Pa.
    thickness : (m,) array or float
        Of the elements, in units of thickness.

    Returns
    -------
    (2n, 2n) sparse array
        Symmetric, N/m per m of thickness; freedom 2 i + c is component c of node i.
    """
    basis, node = _scalar_basis(points, triangles)
    local = _element_stiffness(basis, lame) * np.broadcast_to(thickness, len(triangles))[:, None, None]
    freedoms = (2 * node[basis.element_dofs.T][:, :, None] + np.arange(2)).reshape(len(local), 12)
    rows = np.broadcast_to(freedoms[:, :, None], local.shape).ravel()
    columns = np.broadcast_to(freedoms[:, None, :], local.shape).ravel()
    size = 2 * len(points)
    return sp.csc_array(sp.coo_array((local.ravel(), (rows, columns)), shape=(size, size)))


def _scalar_basis(points: FloatArray, triangles: IntArray) -> tuple[Basis, IntArray]:
    """Return the quadratic basis of one component, and the node of each of its freedoms."""
    corners, flat = np.unique(triangles[:, :3], return_inverse=True)
    linear = MeshTri(np.ascontiguousarray(points[corners].T), np.ascontiguousarray(flat.reshape(-1, 3).T))
    sides = np.sort(np.concatenate([triangles[:, side] for side in SIDES]), axis=1)
    keys, first = np.unique(sides[:, 0] * len(points) + sides[:, 1], return_index=True)
    facets = np.sort(corners[linear.facets], axis=0)
    middles = triangles[:, 3:].T.ravel()[first][np.searchsorted(keys, facets[0] * len(points) + facets[1])]
    nodes = np.concatenate([corners, middles])
    basis = Basis(
        MeshTri2(np.ascontiguousarray(points[nodes].T), linear.t), ElementTriP2(), intorder=QUADRATURE_ORDER
    )
    node = np.empty(basis.N, dtype=np.int64)
    node[basis.nodal_dofs[0]], node[basis.facet_dofs[0]] = corners, middles
    return basis, node


def _element_stiffness(basis: Basis, lame: tuple[float, float]) -> FloatArray:
    """Return the element matrices (m, 12, 12), freedom 2 a + c for component c of local function a.

    K_(ai)(bj) = integral of lambda d_i a d_j b + mu (d_j a d_i b + delta_ij grad a . grad b).
    """
    gradient = np.stack([function[0].grad for function in basis.basis])  # (a, i, m, q)
    weighted = (gradient * basis.dx).transpose(2, 0, 1, 3)
    count = len(weighted)
    products = weighted.reshape(count, 12, -1) @ gradient.transpose(2, 3, 0, 1).reshape(count, -1, 12)
    products = products.reshape(count, 6, 2, 6, 2)
    trace = products[:, :, 0, :, 0] + products[:, :, 1, :, 1]
    lam, mu = lame
    local = lam * products + mu * products.transpose(0, 1, 4, 3, 2)
    local[:, :, 0, :, 0] += mu * trace
    local[:, :, 1, :, 1] += mu * trace
    return np.asarray(local.reshape(count, 12, 12))
