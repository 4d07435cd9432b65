"""Quality of eight-node quadrilaterals, and the refusal of poor ones."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.errors import MeshError
from fe_contact.mesh.quality import MeshQuality, QualityLimits
from fe_contact.types import FloatArray, IntArray

CORNERS = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
MIDDLES = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)])
CENTER = np.array([(0.0, 0.0)])


def quad_quality(points: FloatArray, quads: IntArray) -> MeshQuality:
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
    return MeshQuality(_corner_angle(nodes[:, :4]), determinant.min(axis=1) / largest)


def _corner_angle(corners: FloatArray) -> FloatArray:
    """Return how far the corners of (m, 4, 2) stay from folding and from being straight, rad."""
    ahead, behind = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    cross = ahead[..., 0] * behind[..., 1] - ahead[..., 1] * behind[..., 0]
    angle = np.arctan2(cross, np.sum(ahead * behind, axis=2))
    return np.asarray(np.minimum(angle, np.pi - angle).min(axis=1))


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


def refuse_poor_quads(points: FloatArray, quads: IntArray, limits: QualityLimits) -> None:
    """Refuse a section that misses its limits.

    Raises
    ------
    MeshError
        Naming the worst element, where it is, its value and the limit.
    """
    quality = quad_quality(points, quads)
    for name, values, limit, unit, factor in (
        ("scaled Jacobian", quality.scaled_jacobian, limits.scaled_jacobian, "", 1.0),
        ("corner angle", quality.angle, limits.angle, " deg", math.degrees(1.0)),
    ):
        worst = int(np.argmin(values))
        if not values[worst] >= limit:
            x, y = 1e3 * points[quads[worst, :4]].mean(axis=0)
            raise MeshError(
                f"sector section: element {worst} at ({x:.4g}, {y:.4g}) mm: {name} "
                f"{factor * values[worst]:.3g}{unit} is below {factor * limit:.3g}{unit}. "
                "Try other element sizes in the sector recipe."
            )
