"""Bicubic Hermite interpolation, compiled."""

from __future__ import annotations

import numpy as np

from fe_contact.types import FloatArray
from host.loops import inner, njit


@inner()
def _hermite(axis: FloatArray, at: float, weight: FloatArray) -> int:
    """Fill the weights of value and slope at either end of the cell that holds `at`; return the cell."""
    x = min(max(at, axis[0]), axis[-1])
    cell = min(max(np.searchsorted(axis, x) - 1, 0), axis.size - 2)
    step = axis[cell + 1] - axis[cell]
    t = (x - axis[cell]) / step
    weight[0] = (1.0 + 2.0 * t) * (1.0 - t) ** 2
    weight[1] = t * t * (3.0 - 2.0 * t)
    weight[2] = step * t * (1.0 - t) ** 2
    weight[3] = step * t * t * (t - 1.0)
    return int(cell)


@inner()
def bicubic_at(
    axes: tuple[FloatArray, FloatArray],
    nodes: FloatArray,
    roll: float,
    face: float,
    across: FloatArray,
    along: FloatArray,
) -> float:
    """Interpolate at a point; `nodes` (4, m n) row by row, `across` and `along` (4,) are scratch."""
    i, j = _hermite(axes[0], roll, across), _hermite(axes[1], face, along)
    value = 0.0
    for a in range(2):
        for b in range(2):
            at = (i + a) * axes[1].size + j + b
            value += (
                across[a] * along[b] * nodes[0, at]
                + across[2 + a] * along[b] * nodes[1, at]
                + across[a] * along[2 + b] * nodes[2, at]
                + across[2 + a] * along[2 + b] * nodes[3, at]
            )
    return value


@njit(cache=True)
def bicubic(
    roll_axis: FloatArray, face_axis: FloatArray, nodes: FloatArray, roll: FloatArray, face: FloatArray
) -> FloatArray:
    """Bicubic Hermite interpolation at points (k,); `nodes` (4, m n) row by row."""
    values = np.empty(roll.size)
    across, along = np.zeros(4), np.zeros(4)
    for k in range(roll.size):
        values[k] = bicubic_at((roll_axis, face_axis), nodes, roll[k], face[k], across, along)
    return values
