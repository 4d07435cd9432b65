"""Checks of the stiffness and damping matrices of joints."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.types import FloatArray

Matrix = tuple[tuple[float, ...], ...]

SYMMETRY = 1e-9  # relative
LEAST_EIGENVALUE = -1e-9  # over the largest, in units in which the diagonal is 1


def check_matrix(
    field: str, matrix: FloatArray, sizes: tuple[int, ...], symmetry: float = SYMMETRY
) -> FloatArray:
    """Return `matrix` if it is square of one of `sizes`, symmetric and positive semidefinite.

    Parameters
    ----------
    field : str
        Name for errors.
    matrix : array
    sizes : tuple of int
        Allowed numbers of rows.
    symmetry : float
        Largest difference from the transpose over the largest entry.

    Raises
    ------
    InputError
        Naming `field`.
    """
    allowed = " or ".join(f"{size} by {size}" for size in sizes)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or matrix.shape[0] not in sizes:
        raise InputError(field, f"shape {matrix.shape}", f"{allowed} finite numbers")
    if not np.all(np.isfinite(matrix)):
        raise InputError(field, "with entries that are no numbers", f"{allowed} finite numbers")
    largest = float(np.max(np.abs(matrix)))
    if np.any(np.abs(matrix - matrix.T) > symmetry * largest):
        raise InputError(field, "not symmetric", "symmetric", "Use half the sum with its transpose.")
    per = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    eigenvalue = np.linalg.eigvalsh(matrix / np.outer(per, per))
    if eigenvalue[0] < LEAST_EIGENVALUE * max(1.0, float(eigenvalue[-1])):
        raise InputError(field, "with a negative eigenvalue", "positive semidefinite")
    return matrix
