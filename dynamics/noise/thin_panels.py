"""Thin panels of a hull turned into wide ones by exchanging diagonals."""

from __future__ import annotations

import numpy as np

from dynamics.types import BoolArray, FloatArray, IntArray

THIN = 0.05
"""Height over longest edge below which a panel is thin."""
ROUNDS = 4
"""A row of nodes on a straight edge needs several exchanges."""


def without_thin(nodes: FloatArray, triangles: IntArray) -> IntArray:
    """Return triangles (T, 3) in which thin ones share their longest edge no more.

    A thin triangle and the one beyond its longest edge form a quadrilateral, which gets its other diagonal.
    What was closed stays closed.
    """
    result = np.array(triangles)
    for _ in range(ROUNDS):
        turned, thin = _longest_first(nodes, result)
        if not np.any(thin):
            break
        _exchange(turned, result, np.flatnonzero(thin))
    return result


def _longest_first(nodes: FloatArray, triangles: IntArray) -> tuple[IntArray, BoolArray]:
    """Return triangles turned so that their longest edge comes first, and which are thin."""
    length = np.linalg.norm(nodes[np.roll(triangles, -1, axis=1)] - nodes[triangles], axis=2)
    first = np.argmax(length, axis=1)
    turned = np.take_along_axis(triangles, (first[:, None] + np.arange(3)) % 3, axis=1)
    a, b, c = np.moveaxis(nodes[turned], 1, 0)
    height = np.linalg.norm(np.cross(b - a, c - a), axis=1) / length.max(axis=1)
    return turned, height < THIN * length.max(axis=1)


def _exchange(turned: IntArray, result: IntArray, thin: IntArray) -> None:
    """Exchange the diagonals of thin triangles with their neighbors, each of which takes part once."""
    beyond = {
        (int(nodes[k]), int(nodes[(k + 1) % 3])): (index, int(nodes[(k + 2) % 3]))
        for index, nodes in enumerate(result)
        for k in range(3)
    }
    done: set[int] = set()
    for index in thin.tolist():
        p, q, top = (int(node) for node in turned[index])
        other, far = beyond.get((q, p), (index, top))
        if index in done or other in done or far == top or other == index:
            continue
        if (top, far) in beyond or (far, top) in beyond:
            continue  # the new diagonal is an edge already
        result[index], result[other] = (top, p, far), (top, far, q)
        beyond[top, far] = beyond[far, top] = (index, p)  # an edge from now on
        done |= {index, other}
