"""Integrals over quadratic elements: scikit-fem's forms on tetrahedra, its shape functions on triangles."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from itertools import combinations_with_replacement
from typing import Any, NamedTuple

import numpy as np

from dynamics.types import FloatArray, IntArray
from host.optional_modules import sparse as sp

ORDER = 4
"""Degree that is integrated exactly: products of two quadratic shape functions on straight elements."""


class _ShapeFunctions(NamedTuple):
    """Weights (p,), shapes (a, p) and slopes (a, k, p) at points p of nodes a along local directions k."""

    weight: FloatArray
    shape: FloatArray
    slope: FloatArray


class _SurfaceIntegral(NamedTuple):
    """Area vectors, outward, in m^2 and points in m at the quadrature points: both (t, p, 3)."""

    area: FloatArray
    point: FloatArray


class _PartsIntegral(NamedTuple):
    """The same over parts of triangles, and the shape functions (t, a, p) of nodes a, by part."""

    area: FloatArray
    point: FloatArray
    shape: FloatArray


@cache
def triangle() -> _ShapeFunctions:
    """Return the shape functions of the reference triangle with six nodes, in scikit-fem's order."""
    from skfem import ElementTriP2  # noqa: PLC0415 (start-up time)
    from skfem.quadrature import get_quadrature  # noqa: PLC0415

    points, weight = get_quadrature(ElementTriP2, ORDER)
    values = [ElementTriP2().lbasis(points, node) for node in range(6)]
    shape = np.array([np.broadcast_to(value, weight.shape) for value, _ in values])
    return _ShapeFunctions(weight, shape, np.array([slope for _, slope in values]))


def _separate_mesh(points: FloatArray, tetrahedra: IntArray) -> Any:
    """Return scikit-fem's mesh of the tetrahedra, none of which shares a node: so it keeps their order."""
    from skfem import MeshTet2  # noqa: PLC0415 (start-up time)

    numbers = np.arange(tetrahedra.size).reshape(tetrahedra.shape)
    return MeshTet2(points[tetrahedra].reshape(-1, 3).T, numbers.T)


def determinants(points: FloatArray, tetrahedra: IntArray) -> FloatArray:
    """Return the Jacobian determinants at the quadrature points, (e, p): not above 0 in a fold."""
    from skfem.quadrature import get_quadrature  # noqa: PLC0415 (start-up time)

    mesh = _separate_mesh(points, tetrahedra)
    rows = mesh.mapping().DF(get_quadrature(mesh.elem, ORDER)[0])
    return np.asarray(np.sum(rows[0] * np.cross(rows[1], rows[2], axis=0), axis=0))


def over_volume(points: FloatArray, tetrahedra: IntArray) -> tuple[sp.csr_array, dict[int, sp.csr_array]]:
    """Return the integrals of products of two shape functions, m^3, and of two of their slopes, m.

    All matrices are (n, n) over the nodes of a mesh without folds. Matrix 3 i + j of the slopes has those of
    the row's shape function along i and of the column's along j.
    """
    from skfem import Basis, BilinearForm, ElementTetP2  # noqa: PLC0415 (start-up time)

    basis = Basis(_separate_mesh(points, tetrahedra), ElementTetP2(), intorder=ORDER, disable_doflocs=True)
    node = np.empty(basis.N, dtype=np.int32)
    node[basis.element_dofs] = tetrahedra.T

    def assembled(product: Callable[..., FloatArray]) -> sp.csr_array:
        local = BilinearForm(product).elemental(basis)
        return sp.coo_array((local.data, tuple(node[local.indices])), shape=2 * (len(points),)).tocsr()

    slopes = {}
    for i, j in combinations_with_replacement(range(3), 2):
        slopes[3 * j + i] = assembled(lambda a, b, _, i=i, j=j: a.grad[i] * b.grad[j])
        slopes[3 * i + j] = slopes[3 * j + i].T.tocsr()
    return assembled(lambda a, b, _: a * b), slopes


def over_surface(points: FloatArray, triangles: IntArray) -> _SurfaceIntegral:
    """Return the quadrature points and area vectors of t triangles with six nodes."""
    rule = triangle()
    tangent = np.einsum("tai,akp->tpki", points[triangles], rule.slope, optimize=True)  # (t, p, 2, 3)
    area = np.cross(tangent[:, :, 0], tangent[:, :, 1]) * rule.weight[:, None]
    return _SurfaceIntegral(area, np.einsum("tai,ap->tpi", points[triangles], rule.shape))


def over_parts(points: FloatArray, triangles: IntArray, corners: FloatArray) -> _PartsIntegral:
    """Return the quadrature points, area vectors and shapes of parts of t triangles with six nodes.

    The part of each is the triangle between `corners` (t, 3, 2) in its local coordinates.
    """
    from skfem import ElementTriP2  # noqa: PLC0415 (start-up time)
    from skfem.quadrature import get_quadrature  # noqa: PLC0415

    reference, weight = get_quadrature(ElementTriP2, ORDER)  # (2, p), (p,)
    sides = corners[:, 1:] - corners[:, :1]  # (t, 2 sides, 2)
    local = np.moveaxis(corners[:, :1] + np.einsum("sp,tsk->tpk", reference, sides), 2, 0)  # (2, t, p)
    values = [ElementTriP2().lbasis(local, node) for node in range(6)]
    shape = np.array([np.broadcast_to(value, local.shape[1:]) for value, _ in values])  # (a, t, p)
    slope = np.array([np.broadcast_to(slope, local.shape) for _, slope in values])  # (a, k, t, p)
    tangent = np.einsum("tai,aktp->tpki", points[triangles], slope, optimize=True)
    scale = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    area = np.cross(tangent[:, :, 0], tangent[:, :, 1]) * (weight * scale[:, None])[..., None]
    point = np.einsum("tai,atp->tpi", points[triangles], shape, optimize=True)
    return _PartsIntegral(area, point, np.moveaxis(shape, 0, 1))
