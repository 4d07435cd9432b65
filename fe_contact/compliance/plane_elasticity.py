"""Elasticity in scikit-fem's forms: stiffness of any isoparametric element, and of a plane section."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np

from fe_contact.types import FloatArray, IntArray
from host.optional_modules import skfem
from host.optional_modules import sparse as sp

QUADRATURE_ORDER = 4  # exact on straight sides (order 2); curved sides need more


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
        Thickness of the elements over the unit thickness.

    Returns
    -------
    (2n, 2n) sparse array
        Symmetric, N/m per m of thickness; freedom 2 i + c is component c of node i.
    """
    local = element_stiffness(skfem.MeshTri2(points.T, triangles.T), QUADRATURE_ORDER, lame)
    local *= np.broadcast_to(thickness, len(triangles))[:, None, None]
    freedoms = (2 * triangles[:, :, None] + np.arange(2)).reshape(len(local), 12)
    rows = np.broadcast_to(freedoms[:, :, None], local.shape).ravel()
    columns = np.broadcast_to(freedoms[:, None, :], local.shape).ravel()
    size = 2 * len(points)
    return sp.csc_array(sp.coo_array((local.ravel(), (rows, columns)), shape=(size, size)))


def element_stiffness(mesh: skfem.Mesh, order: int, lame: tuple[float, float]) -> FloatArray:
    """Return the matrices (m, n d, n d) of isoparametric elements; freedom d a + i is component i of node a.

    K_(ai)(bj) = integral of lambda d_i a d_j b + mu (d_j a d_i b + delta_ij grad a . grad b), with quadrature
    of degree `order`. A form is called for each pair of functions: give it hundreds of elements at once.
    """
    basis = skfem.Basis(mesh, mesh.elem(), intorder=order, disable_doflocs=True)
    basis.dx = np.asfortranarray(basis.dx)  # point by point: forms then add vectors, twice as fast
    for (function,) in basis.basis:
        function.grad = np.ascontiguousarray(function.grad.swapaxes(1, 2)).swapaxes(1, 2)
    dim, count = mesh.dim(), basis.Nbfun
    products = np.empty((dim, dim, mesh.nelements, count, count))
    for i, j in combinations_with_replacement(range(dim), 2):
        form = skfem.BilinearForm(lambda a, b, _, i=i, j=j: a.grad[i] * b.grad[j])
        products[i, j] = form.elemental(basis).tolocal()
        products[j, i] = products[i, j].swapaxes(1, 2)
    lam, mu = lame
    blocks = lam * products + mu * products.swapaxes(0, 1)
    blocks[range(dim), range(dim)] += mu * np.einsum("iimab->mab", products)
    return blocks.transpose(2, 3, 0, 4, 1).reshape(mesh.nelements, count * dim, count * dim)
