"""Quality of triangles with six nodes and quadrilaterals with eight, and refusal of poor ones."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fe_contact.errors import MeshError
from fe_contact.types import FloatArray, IntArray

_NODES = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])

CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
MIDDLES = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)])
CENTER = np.array([(0.0, 0.0)])


@dataclass(frozen=True)
class QualityLimits:
    """Least acceptable quality."""

    angle: float = math.radians(12.0)
    """Least angle between straight sides, rad."""
    scaled_jacobian: float = 0.2
    """Least ratio of the smallest to the largest Jacobian determinant within an element."""


@dataclass(frozen=True)
class _MeshQuality:
    """Quality of every element of a mesh."""

    angle: FloatArray
    """Least angle between straight sides, rad. Shape (m,)."""
    scaled_jacobian: FloatArray
    """Lower bound of the smallest over the largest Jacobian determinant; below zero it may be folded. Shape
    (m,).
    """


def mesh_quality(points: FloatArray, triangles: IntArray) -> _MeshQuality:
    """Return the quality of six-node triangles (m, 6) on points (n, 2)."""
    nodes = points[triangles]
    corners = nodes[:, :3]
    sides = np.roll(corners, -1, axis=1) - corners
    sides /= np.linalg.norm(sides, axis=2, keepdims=True)
    cosines = -np.sum(sides * np.roll(sides, 1, axis=1), axis=2)
    angle = np.arccos(np.clip(cosines, -1.0, 1.0)).min(axis=1)
    return _MeshQuality(angle, least_jacobian(nodes))


def least_jacobian(nodes: FloatArray) -> FloatArray:
    """Return a lower bound of min det J / max det J over each element (m, 6, 2), if above 0.

    The determinant is a quadratic polynomial, hence between its least and largest Bernstein coefficients:
    the corner values, and 2 det(middle) - (det(corner) + det(corner)) / 2 for each side.
    """
    gradients = np.einsum("qdk,mkx->mqdx", shape_derivatives(_NODES), nodes)
    determinant = gradients[..., 0, 0] * gradients[..., 1, 1] - gradients[..., 0, 1] * gradients[..., 1, 0]
    corner, middle = determinant[:, :3], determinant[:, 3:]
    bernstein = np.concatenate([corner, 2.0 * middle - 0.5 * (corner + np.roll(corner, -1, axis=1))], axis=1)
    largest = np.abs(bernstein).max(axis=1)
    return np.asarray(bernstein.min(axis=1) / largest)


def shape_derivatives(at: FloatArray) -> FloatArray:
    """Return the derivatives (n, 2, 6) of the quadratic shape functions at reference points (n, 2)."""
    x, y = at.T
    z, zero = 1.0 - x - y, np.zeros(len(at))
    in_x = [1.0 - 4.0 * z, 4.0 * x - 1.0, zero, 4.0 * (z - x), 4.0 * y, -4.0 * y]
    in_y = [1.0 - 4.0 * z, zero, 4.0 * y - 1.0, -4.0 * x, 4.0 * x, 4.0 * (z - y)]
    return np.stack([np.stack(in_x, axis=-1), np.stack(in_y, axis=-1)], axis=1)


def quad_quality(points: FloatArray, quads: IntArray) -> _MeshQuality:
    """Return the quality of eight-node quadrilaterals (m, 8) on points (n, 2).

    `angle` is the least of a corner's angle and what it lacks to a straight one; `scaled_jacobian` the least
    over the largest Jacobian determinant among nodes and center, negative where clockwise.
    """
    nodes = points[quads]
    gradients = np.einsum(
        "qdk,mkx->mqdx", _shape_derivatives(np.concatenate([CORNERS, MIDDLES, CENTER])), nodes
    )
    determinant = gradients[..., 0, 0] * gradients[..., 1, 1] - gradients[..., 0, 1] * gradients[..., 1, 0]
    largest = np.abs(determinant).max(axis=1)
    corners = nodes[:, :4]
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    angle = np.arctan2(cross, np.sum(ahead * behind, axis=2))  # far from folding and from being straight
    angle = np.minimum(angle, np.pi - angle).min(axis=1)
    return _MeshQuality(angle, determinant.min(axis=1) / largest)


def _shape_derivatives(at: FloatArray) -> FloatArray:
    """Return the derivatives (n, 2, 8) of the serendipity functions at reference points (n, 2) of -1 .. 1."""
    x, y = at[:, :1], at[:, 1:]
    a, b = CORNERS.T
    in_x = [0.25 * a * (1 + b * y) * (2 * a * x + b * y), 0.25 * b * (1 + a * x) * (2 * b * y + a * x)]
    sides_x = np.concatenate([-x * (1 - y), 0.5 * (1 - y**2), -x * (1 + y), -0.5 * (1 - y**2)], axis=1)
    sides_y = np.concatenate([-0.5 * (1 - x**2), -y * (1 + x), 0.5 * (1 - x**2), -y * (1 - x)], axis=1)
    return np.stack(
        [np.concatenate([in_x[0], sides_x], axis=1), np.concatenate([in_x[1], sides_y], axis=1)], axis=1
    )


def refuse_poor_elements(part: str, points: FloatArray, elements: IntArray, limits: QualityLimits) -> None:
    """Refuse six-node triangles or eight-node quadrilaterals that miss their limits; `part` names the mesh.

    Raises `MeshError` naming the worst element, where it is, its value and the limit.
    """
    triangles = elements.shape[1] == len(_NODES)
    corners, angle, recipe = (3, "least angle", "mesh") if triangles else (4, "corner angle", "sector")
    quality = (mesh_quality if triangles else quad_quality)(points, elements)
    for name, values, limit, unit, factor in (
        ("scaled Jacobian", quality.scaled_jacobian, limits.scaled_jacobian, "", 1.0),
        (angle, quality.angle, limits.angle, " deg", math.degrees(1.0)),
    ):
        worst = int(np.argmin(values))
        if not values[worst] >= limit:
            x, y = 1e3 * points[elements[worst, :corners]].mean(axis=0)
            raise MeshError(
                f"{part}: element {worst} at ({x:.4g}, {y:.4g}) mm: {name} "
                f"{factor * values[worst]:.3g}{unit} is below {factor * limit:.3g}{unit}. "
                f"Try other element sizes in the {recipe} recipe."
            )
