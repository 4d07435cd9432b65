"""Compiled inversion of a few equations."""

from __future__ import annotations

from dynamics.kernels.compiled import inner
from dynamics.types import FloatArray


@inner
def invert_equations(matrix: FloatArray, size: int) -> None:
    """Turn [A, I] in the first `size` rows into [I, inverse], with row pivoting (Gauss and Jordan)."""
    for p in range(size):
        best = p
        for i in range(p + 1, size):
            if abs(matrix[i, p]) > abs(matrix[best, p]):
                best = i
        pivot = 1.0 / matrix[best, p]
        for j in range(2 * size):
            matrix[best, j], matrix[p, j] = matrix[p, j], matrix[best, j] * pivot
        for i in range(size):
            factor = matrix[i, p]
            if i != p and factor != 0.0:
                for j in range(2 * size):
                    matrix[i, j] -= factor * matrix[p, j]
