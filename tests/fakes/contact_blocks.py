"""Blocks that stand for gears: rectangles clamped at their back, extruded."""

import numpy as np

from fe_contact.types import FloatArray, IntArray
from verification.full_contact.condensation.placed_mesh import PlacedBody, Strip

WIDTH, DEPTH = 3e-3, 2e-3


def grid(depths: FloatArray, heights: FloatArray) -> tuple[FloatArray, IntArray]:
    """Six-node triangles on a rectangle, two to a cell."""
    columns, rows = 2 * len(depths) - 1, 2 * len(heights) - 1
    x, y = (
        np.interp(np.arange(n) / 2.0, np.arange(len(v)), v) for n, v in ((columns, depths), (rows, heights))
    )
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    triangles = []
    for i in range(0, rows - 1, 2):
        for j in range(0, columns - 1, 2):
            n = [[(i + a) * columns + j + b for b in range(3)] for a in range(3)]
            triangles.append([n[0][0], n[0][2], n[2][2], n[0][1], n[1][2], n[1][1]])
            triangles.append([n[0][0], n[2][2], n[2][0], n[1][1], n[2][1], n[1][0]])
    return points, np.array(triangles)


def block(number: int) -> PlacedBody:
    """Left of x = 0 (0) or right of it (1), with 5 and 7 elements of uneven length along the contact."""
    uneven = np.array([0.0, 0.13, 0.4, 0.55, 0.87, 1.0]) * WIDTH
    finer = np.array([0.0, 0.08, 0.3, 0.41, 0.6, 0.77, 0.9, 1.0]) * WIDTH
    depths = (np.array([-1.0, -0.45, 0.0]), np.array([0.0, 0.3, 0.7, 1.0]))[number] * DEPTH
    points, triangles = grid(depths, (uneven, finer)[number])
    face = np.flatnonzero(points[:, 0] == 0.0)
    back = np.flatnonzero(points[:, 0] == (-DEPTH, DEPTH)[number])
    along = face[np.argsort(points[face, 1])][:: (1, -1)[number]]  # counter-clockwise about the body
    return PlacedBody(points, triangles, back, np.zeros(2), {0: Strip(along, np.abs(points[along, 1]))})
