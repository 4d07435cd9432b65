"""Shape functions of scikit-fem at its quadrature points, and integrals of them over quadratic elements."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from dynamics.types import FloatArray, IntArray

ORDER = 4
"""Degree that is integrated exactly: products of two quadratic shape functions on straight elements."""


class _ShapeFunctions(NamedTuple):
    """Weights (p,), shapes (a, p) and slopes (a, k, p) at points p of nodes a along local directions k."""

    weight: FloatArray
    shape: FloatArray
    slope: FloatArray


class _VolumeIntegral(NamedTuple):
    """Volumes in m^3 and gradients in 1/m at the quadrature points: (e, p) and (e, 10, 3, p)."""

    volume: FloatArray
    gradient: FloatArray


class _SurfaceIntegral(NamedTuple):
    """Area vectors, outward, in m^2 and points in m at the quadrature points: both (t, p, 3)."""

    area: FloatArray
    point: FloatArray


@cache
def tetrahedron() -> _ShapeFunctions:
    """Return the reference of tetrahedra with ten nodes."""
    from skfem import ElementTetP2  # noqa: PLC0415 (start-up time)
    from skfem.refdom import RefTet  # noqa: PLC0415

    return _reference(ElementTetP2(), RefTet, 10)


@cache
def triangle() -> _ShapeFunctions:
    """Return the reference of triangles with six nodes."""
    from skfem import ElementTriP2  # noqa: PLC0415 (start-up time)
    from skfem.refdom import RefTri  # noqa: PLC0415

    return _reference(ElementTriP2(), RefTri, 6)


def _reference(element: object, domain: object, nodes: int) -> _ShapeFunctions:
    """Evaluate an element of scikit-fem, whose nodes are ordered as ours."""
    from skfem.quadrature import get_quadrature  # noqa: PLC0415 (start-up time)

    points, weight = get_quadrature(domain, ORDER)
    values = [element.lbasis(points, node) for node in range(nodes)]  # type: ignore[attr-defined]
    shape = np.array([np.broadcast_to(value, weight.shape) for value, _ in values])
    return _ShapeFunctions(weight, shape, np.array([slope for _, slope in values]))


def over_volume(points: FloatArray, tetrahedra: IntArray) -> _VolumeIntegral:
    """Map the reference onto elements; a volume is negative where an element is turned inside out."""
    rule = tetrahedron()
    jacobian = np.einsum("eai,akp->epik", points[tetrahedra], rule.slope, optimize=True)
    determinant = np.linalg.det(jacobian)
    with np.errstate(divide="ignore", invalid="ignore"):
        a, b, c = (jacobian[..., :, k] for k in range(3))
        rows = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=-2)
        inverse = rows / determinant[..., None, None]
    gradient = np.einsum("akp,epki->eaip", rule.slope, inverse, optimize=True)
    return _VolumeIntegral(determinant * rule.weight, gradient)


def over_surface(points: FloatArray, triangles: IntArray) -> _SurfaceIntegral:
    """Map the reference onto triangles with six nodes."""
    rule = triangle()
    tangent = np.einsum("tai,akp->tpki", points[triangles], rule.slope, optimize=True)
    area = np.cross(tangent[:, :, 0], tangent[:, :, 1]) * rule.weight[:, None]
    return _SurfaceIntegral(area, np.einsum("tai,ap->tpi", points[triangles], rule.shape))
