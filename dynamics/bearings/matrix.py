"""Checks of the stiffness and damping matrices of joints."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.types import FloatArray

Matrix = tuple[tuple[float, ...], ...]


PRECISION = 1e-9
"""Relative precision to which entries count."""
OPERATIONS = 10.0
"""Roundings per term of a row: turning, adding and condensing each leave some."""


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
        Relative precision of the entries. In units in which every diagonal entry is 1 that many times the
        number of rows is how far below zero an eigenvalue of n such rows may be (Weyl).
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

    The program that computed the entries left an error of n eps of the largest entry, with 1 m as lever
    between forces and moments. A diagonal entry so small that this is more than `precision` of it is measured
    by that instead.
    """
    rounding = OPERATIONS * len(matrix) * float(np.finfo(float).eps) * float(np.max(np.abs(matrix)))
    if rounding == 0.0:
        return 0.0
    unit = np.sqrt(np.maximum(np.diag(matrix), rounding / precision))
    return float(np.linalg.eigvalsh(matrix / np.outer(unit, unit))[0])


def least_share(matrix: FloatArray) -> float:
    """Return the least eigenvalue of a symmetric matrix in units in which its diagonal is 1; 0 at a zero."""
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
        Positive semidefinite to rounding; what is not is projected away.
    motion : (p, n) array

    Returns
    -------
    (n, n) array
        Entries are good to eps of the root of the product of their diagonal entries.
    """
    eigenvalue, vector = np.linalg.eigh(0.5 * (matrix + matrix.T))
    factor = np.sqrt(np.maximum(eigenvalue, 0.0))[:, None] * (vector.T @ motion)
    return np.asarray(factor.T @ factor)
