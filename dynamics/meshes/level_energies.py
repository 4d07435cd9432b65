"""The energy that a packed table stores below each of its levels, as a polynomial in the position."""

from __future__ import annotations

import numpy as np

from dynamics.kernels.compiled import compiled
from dynamics.types import FloatArray

ORDER = 9
"""Degree in the position: width^2 times stiffness, where both are cubic."""


def energy_below(row: FloatArray, level: FloatArray) -> FloatArray:
    """Return ascending coefficients (P L, ORDER + 1), J, of a table at P positions and the levels (L,).

    `row` (P L, 8) holds four coefficients of the deflection, then four of the stiffness. With levels F_k at
    deflections d_k(u) and stiffness K_k(u), an interval of width h = d_k+1 - d_k holds h (F_k + F_k+1)/2 +
    h^2 (K_k - K_k+1)/12; row k has the sum over the intervals below level k.
    """
    energy = np.zeros((row.shape[0], ORDER + 1))
    _add_intervals(row, level, energy)
    return energy


@compiled
def _add_intervals(row: FloatArray, level: FloatArray, energy: FloatArray) -> None:
    """Fill the coefficients of one table; its rows run through the levels position by position."""
    levels = level.size
    for start in range(0, row.shape[0], levels):
        for k in range(levels - 1):
            low, high, mean = start + k, start + k + 1, 0.5 * (level[k] + level[k + 1])
            for power in range(energy.shape[1]):
                energy[high, power] = energy[low, power]
            for a in range(4):
                width = row[high, a] - row[low, a]
                energy[high, a] += mean * width
                for b in range(4):
                    square = width * (row[high, b] - row[low, b]) / 12.0
                    for c in range(4):
                        energy[high, a + b + c] += square * (row[low, 4 + c] - row[high, 4 + c])
