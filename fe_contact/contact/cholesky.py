"""Cholesky factorisation of the small dense matrices of the active set, compiled.

Row by row on the lower triangle, so that every inner loop is a dot product of contiguous rows, which
vectorises when its sums may be reordered. LAPACK would need a copy, raises instead of reporting a lost
definiteness, and starts threads of its own.
"""

from __future__ import annotations

import math

from numba import njit

from fe_contact.types import FloatArray


@njit(cache=True, fastmath={"reassoc", "contract"})
def dot(x: FloatArray, y: FloatArray, n: int) -> float:
    """Sum of products of the first `n` entries."""
    total = 0.0
    for i in range(n):
        total += x[i] * y[i]
    return total


@njit(cache=True)
def factorize(a: FloatArray, n: int) -> bool:
    """Replace the lower triangle of the leading n x n block by its factor; False if not positive definite."""
    for i in range(n):
        for j in range(i):
            a[i, j] = (a[i, j] - dot(a[i], a[j], j)) / a[j, j]
        pivot = a[i, i] - dot(a[i], a[i], i)
        if not pivot > 0.0:  # false for NaN too
            return False
        a[i, i] = math.sqrt(pivot)
    return True


@njit(cache=True)
def substitute(a: FloatArray, x: FloatArray, n: int) -> None:
    """Replace the first `n` entries of x by the solution of L L' y = x."""
    for i in range(n):
        x[i] = (x[i] - dot(a[i], x, i)) / a[i, i]
    for i in range(n - 1, -1, -1):
        x[i] /= a[i, i]
        for j in range(i):
            x[j] -= a[i, j] * x[i]
