"""The part of the sky that faces of a surface see: outer faces see much of it, inner ones little or none."""

from __future__ import annotations

import numpy as np

from dynamics.acoustics.plane_waves import directions
from dynamics.forces.compiled import compiled
from dynamics.types import FloatArray

ORDER = 8
"""Views from 2 ORDER^2 = 128 directions."""
PIXELS = 512
"""Across the sphere about the surface, in a view."""
STEEP = 0.2
"""Least cosine between a face's normal and a view that counts; pixels are too coarse for flatter ones."""
MARGIN = 8.0
"""Pixels by which another face must be in front: a face under `STEEP` spans 5 in depth in its own pixel."""


def free_sky(corners: FloatArray) -> FloatArray:
    """Return the part of the hemisphere over each triangle from which its middle is seen, (t,), 0 to 1.

    Directions weigh by the cosine to the normal, as in the view factor to surroundings at infinity: 1 on a
    convex body, 0 in a closed cavity.

    Parameters
    ----------
    corners : (t, 3, 3) array
        Of the triangles, m, counter-clockwise from outside. All triangles can hide others.
    """
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    middle = corners.reshape(-1, 3)
    middle = 0.5 * (middle.min(axis=0) + middle.max(axis=0))
    radius = float(np.linalg.norm(corners - middle, axis=2).max())
    scaled = (corners - middle) * (PIXELS / 2.0 / radius)
    seen, whole = np.zeros(len(corners)), np.zeros(len(corners))
    for view, weight in zip(*directions(ORDER), strict=True):
        cosine = normal @ view
        share = np.where(cosine > STEEP, weight * cosine, 0.0)
        whole += share
        seen += share * _visible(scaled, view)
    return np.asarray(seen / np.maximum(whole, 1e-300))


def _visible(corners: FloatArray, view: FloatArray) -> FloatArray:
    """Return 1 for triangles whose middle nothing hides from a far eye in direction `view`, else 0, (t,)."""
    across = np.linalg.svd(view[None])[2]  # last two rows: across the view
    axes = np.stack([across[1], across[2], view], axis=1)
    turned = np.ascontiguousarray(corners @ axes + np.array([PIXELS / 2.0, PIXELS / 2.0, 0.0]))
    nearest = np.full((PIXELS, PIXELS), -np.inf)
    _draw(turned, nearest)
    column, row, depth = turned.mean(axis=1).T
    last = PIXELS - 1
    front = nearest[np.clip(column.astype(int), 0, last), np.clip(row.astype(int), 0, last)]
    return np.where(depth >= front - MARGIN, 1.0, 0.0)


@compiled
def _draw(corners: FloatArray, nearest: FloatArray) -> None:
    """Raise `nearest` (columns, rows) to the depth of every triangle that covers the middle of a pixel."""
    for t in range(corners.shape[0]):
        ax, ay, az = corners[t, 0, 0], corners[t, 0, 1], corners[t, 0, 2]
        bx, by, bz = corners[t, 1, 0] - ax, corners[t, 1, 1] - ay, corners[t, 1, 2] - az
        cx, cy, cz = corners[t, 2, 0] - ax, corners[t, 2, 1] - ay, corners[t, 2, 2] - az
        area = bx * cy - by * cx
        if area == 0.0:
            continue
        low_x, high_x = max(int(ax + min(0.0, bx, cx) - 0.5), 0), min(int(ax + max(0.0, bx, cx)), PIXELS - 1)
        low_y, high_y = max(int(ay + min(0.0, by, cy) - 0.5), 0), min(int(ay + max(0.0, by, cy)), PIXELS - 1)
        for i in range(low_x, high_x + 1):
            for j in range(low_y, high_y + 1):
                x, y = i + 0.5 - ax, j + 0.5 - ay
                b, c = (x * cy - y * cx) / area, (bx * y - by * x) / area
                if b >= 0.0 and c >= 0.0 and b + c <= 1.0:
                    nearest[i, j] = max(nearest[i, j], az + b * bz + c * cz)
