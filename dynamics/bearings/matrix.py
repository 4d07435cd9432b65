"""Checks of the stiffness and damping matrices of joints."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.types import FloatArray

Matrix = tuple[tuple[float, ...], ...]


PRECISION = 1e-9
"""Relative precision of stated entries: smaller deviations from a valid matrix are rounding."""
OPERATIONS = 10.0
"""Roundings per term of a row of a computed matrix: rotation, summation and condensation each leave some."""


def matrix_rows(matrix: FloatArray) -> Matrix:
    """Return the rows of an array as a part of a scene holds them."""
    return tuple(tuple(float(value) for value in row) for row in matrix)


def check_matrix(
    field: str, rows: Matrix | FloatArray, sizes: tuple[int, ...], precision: float = PRECISION
) -> FloatArray:
    """Return the matrix of `rows` if it is square of one of `sizes`, symmetric and positive semidefinite.

    Raises `InputError` naming `field`.

    Parameters
    ----------
    field : str
        Name for errors.
    sizes : tuple of int
        Allowed numbers of rows.
    precision : float
        Relative precision of the entries. In units in which every diagonal entry is 1, an eigenvalue may be
        below zero by the precision times the number of rows (Weyl's bound).
    """
    allowed = " or ".join(f"{size} by {size}" for size in sizes)
    if len({len(row) for row in rows}) > 1:
        raise InputError(field, "with rows of different lengths", f"{allowed} finite numbers")
    matrix = np.asarray(rows, dtype=float)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or matrix.shape[0] not in sizes:
        raise InputError(field, f"shape {matrix.shape}", f"{allowed} finite numbers")
    if not np.all(np.isfinite(matrix)):
        raise InputError(field, "with entries that are no numbers", f"{allowed} finite numbers")
    largest = float(np.max(np.abs(matrix)))
    if np.any(np.abs(matrix - matrix.T) > precision * largest):
        raise InputError(field, "not symmetric", "symmetric", "Use half the sum with its transpose.")
    if _least_eigenvalue(matrix, precision) < -len(matrix) * precision:
        raise InputError(field, "with a negative eigenvalue", "positive semidefinite")
    return matrix


def _least_eigenvalue(matrix: FloatArray, precision: float) -> float:
    """Return the least eigenvalue in units in which the diagonal is 1.

    The program that computed the n rows left an error in every entry, of `OPERATIONS` n eps times the largest
    entry; forces and moments are compared by a lever of 1 m. A diagonal entry of which this error is more
    than `precision` says little. It is replaced by the error over `precision` in the units.
    """
    rounding = OPERATIONS * len(matrix) * float(np.finfo(float).eps) * float(np.max(np.abs(matrix)))
    if rounding == 0.0:
        return 0.0
    unit = np.sqrt(np.maximum(np.diag(matrix), rounding / precision))
    return float(np.linalg.eigvalsh(matrix / np.outer(unit, unit))[0])


def least_share(matrix: FloatArray) -> float:
    """Return the least eigenvalue of a symmetric matrix in units in which its diagonal is 1.

    0 if a diagonal entry is 0 or negative.
    """
    diagonal = np.diag(matrix)
    if float(np.min(diagonal)) <= 0.0:
        return 0.0
    unit = np.sqrt(diagonal)
    return float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T) / np.outer(unit, unit))[0])


def congruent(matrix: FloatArray, motion: FloatArray) -> FloatArray:
    """Return `motion`^T `matrix` `motion` as the square of a factor, positive semidefinite however it rounds.

    Parameters
    ----------
    matrix : (p, p) array
        Positive semidefinite within rounding; negative eigenvalues are set to 0.
    motion : (p, n) array

    Returns
    -------
    (n, n) array
        The error of entry (i, j) is about eps times the square root of the product of the diagonal entries i
        and j.
    """
    eigenvalue, vector = np.linalg.eigh(0.5 * (matrix + matrix.T))
    factor = np.sqrt(np.maximum(eigenvalue, 0.0))[:, None] * (vector.T @ motion)
    return np.asarray(factor.T @ factor)
