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


@njit(cache=True)
def bicubic(
    roll_axis: FloatArray, face_axis: FloatArray, nodes: FloatArray, roll: FloatArray, face: FloatArray
) -> FloatArray:
    """Bicubic Hermite interpolation at points (k,)."""
    values = np.zeros(roll.size)
    across, along = np.zeros(4), np.zeros(4)
    for k in range(roll.size):
        i = _hermite(roll_axis, roll[k], across)
        j = _hermite(face_axis, face[k], along)
        for a in range(2):
            for b in range(2):
                values[k] += (
                    across[a] * along[b] * nodes[0, i + a, j + b]
                    + across[2 + a] * along[b] * nodes[1, i + a, j + b]
                    + across[a] * along[2 + b] * nodes[2, i + a, j + b]
                    + across[2 + a] * along[2 + b] * nodes[3, i + a, j + b]
                )
    return values
