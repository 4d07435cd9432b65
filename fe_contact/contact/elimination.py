"""Gaussian elimination with partial pivoting for the small dense systems of the contact, compiled."""

from __future__ import annotations

import math

from fe_contact.contact.kernel import kernel, kernel_of_sums
from fe_contact.types import FloatArray


@kernel_of_sums
def dot(x: FloatArray, y: FloatArray, n: int) -> float:
    """Return the sum of products of the first `n` entries."""
    total = 0.0
    for i in range(n):
        total += x[i] * y[i]
    return total


@kernel
def copy(values: FloatArray, out: FloatArray) -> None:
    """Copy values (n,) to `out` (n,)."""
    for i in range(out.size):
        out[i] = values[i]


@kernel
def any_nonzero(values: FloatArray) -> bool:
    """Whether any value (n,) is not zero; NaN counts."""
    nonzero = False
    for value in values:
        nonzero = nonzero or value != 0.0
    return nonzero


@kernel
def largest_size(values: FloatArray) -> float:
    """Return the largest absolute value, NaN where any value (n,) is."""
    largest = 0.0
    for value in values:
        if math.isnan(value):
            return float(value)
        largest = max(largest, abs(value))
    return largest


@kernel
def eliminate(a: FloatArray, right: FloatArray, n: int) -> bool:
    """Solve a x = right for the leading n x n block; `right` (k, n) holds k right-hand sides, then solutions.

    Both arrays are overwritten. The result is False if the matrix is singular or not finite.
    """
    for j in range(n):
        pivot = j
        for i in range(j + 1, n):
            if abs(a[i, j]) > abs(a[pivot, j]):
                pivot = i
        if not 0.0 < abs(a[pivot, j]) < 1e300:  # false for NaN too
            return False
        if pivot != j:
            _swap(a[j], a[pivot], n)
            for column in right:
                column[j], column[pivot] = column[pivot], column[j]
        for i in range(j + 1, n):
            if a[i, j] != 0.0:
                part = a[i, j] / a[j, j]
                subtract(a[i, j + 1 : n], a[j, j + 1 : n], part)
                for column in right:
                    column[i] -= part * column[j]
    for column in right:
        for i in range(n - 1, -1, -1):
            column[i] = (column[i] - dot(a[i, i + 1 : n], column[i + 1 : n], n - i - 1)) / a[i, i]
    return True


@kernel
def subtract(x: FloatArray, y: FloatArray, part: float) -> None:
    """Subtract `part` times `y` from `x`."""
    for k in range(x.size):
        x[k] -= part * y[k]


@kernel
def _swap(x: FloatArray, y: FloatArray, n: int) -> None:
    for k in range(n):
        x[k], y[k] = y[k], x[k]
