"""Energy that a packed table stores below each of its levels, as a polynomial in the position."""

from __future__ import annotations

import numpy as np

from dynamics.types import FloatArray, IntArray

ORDER = 9
"""Degree in the position: a width, cubic, squared, times a stiffness, cubic."""


def energy_below(row: FloatArray, offset: IntArray, level: FloatArray) -> FloatArray:
    """Return ascending coefficients, (sum of P L, ORDER + 1), J, laid out as ``PackedTables.row``.

    With levels F_k at deflections d_k(u) and stiffness K_k(u), an interval of width h = d_k+1 - d_k holds
    h (F_k + F_k+1)/2 + h^2 (K_k - K_k+1)/12; row k has the sum over the intervals below level k.
    """
    energy = np.zeros((row.shape[0], ORDER + 1))
    for flank, (first, first_level, levels) in enumerate(offset[:, 3:]):
        end = offset[flank + 1, 3] if flank + 1 < len(offset) else len(row)
        cubics = row[first:end].reshape(-1, levels, 2, 4)
        width, bend = np.diff(cubics[:, :, 0], axis=1), -np.diff(cubics[:, :, 1], axis=1) / 12.0
        forces = level[first_level : first_level + levels]
        whole = _product(_product(width, width), bend)
        whole[..., :4] += 0.5 * (forces[:-1] + forces[1:])[:, None] * width
        energy[first:end].reshape(-1, levels, ORDER + 1)[:, 1:] = np.cumsum(whole, axis=1)
    return energy


def _product(one: FloatArray, other: FloatArray) -> FloatArray:
    """Multiply polynomials along the last axis."""
    product = np.zeros((*one.shape[:-1], one.shape[-1] + other.shape[-1] - 1))
    for power in range(one.shape[-1]):
        product[..., power : power + other.shape[-1]] += one[..., power, None] * other
    return product
