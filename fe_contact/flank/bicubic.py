"""Bicubic Hermite interpolation, compiled.

A node has four numbers: value, slope along the roll length, slope along the face, and mixed slope.
"""

from __future__ import annotations

import numpy as np

from fe_contact.types import FloatArray
from host.loops import inner, njit


@inner(error_model="numpy")
def cell_weights(axis: FloatArray, span: tuple[int, int], at: float, cell: int, weight: FloatArray) -> int:
    """Fill the weights of value and slope at either end of the cell that holds `at`; return the cell.

    Parameters
    ----------
    axis, span : ndarray, (int, int)
        Array with the nodes of the axis, and the part of it that is the axis: first entry, number of entries.
    cell : int
        Where the search begins: most points are near the one before.
    """
    first, size = span
    x = min(max(at, axis[first]), axis[first + size - 1])
    cell = min(cell, size - 2)
    while cell > 0 and axis[first + cell] >= x:
        cell -= 1
    while cell < size - 2 and axis[first + cell + 1] < x:
        cell += 1
    step = axis[first + cell + 1] - axis[first + cell]
    t = (x - axis[first + cell]) / step
    weight[0] = (1.0 + 2.0 * t) * (1.0 - t) ** 2
    weight[1] = t * t * (3.0 - 2.0 * t)
    weight[2] = step * t * (1.0 - t) ** 2
    weight[3] = step * t * t * (t - 1.0)
    return cell


@inner(error_model="numpy")
def cell_value(nodes: FloatArray, corner: int, row: int, across: FloatArray, along: FloatArray) -> float:
    """Interpolate in a cell by weights (4,) along both axes.

    `nodes` (4, N) hold the cell's first corner at `corner`, and the next one across `row` entries further.
    """
    value = 0.0
    for a in range(2):
        for b in range(2):
            at = corner + a * row + b
            value += (
                across[a] * along[b] * nodes[0, at]
                + across[2 + a] * along[b] * nodes[1, at]
                + across[a] * along[2 + b] * nodes[2, at]
                + across[2 + a] * along[2 + b] * nodes[3, at]
            )
    return value


@njit(cache=True, error_model="numpy")
def bicubic(
    roll_axis: FloatArray, face_axis: FloatArray, nodes: FloatArray, roll: FloatArray, face: FloatArray
) -> FloatArray:
    """Bicubic Hermite interpolation at points (k,); `nodes` (4, m n) row by row."""
    values = np.empty(roll.size)
    across, along = np.zeros(4), np.zeros(4)
    rows, columns = (0, roll_axis.size), (0, face_axis.size)
    i, j = 0, 0
    for k in range(roll.size):
        i = cell_weights(roll_axis, rows, roll[k], i, across)
        if k == 0 or face[k] != face[k - 1]:
            j = cell_weights(face_axis, columns, face[k], j, along)
        values[k] = cell_value(nodes, i * face_axis.size + j, face_axis.size, across, along)
    return values
