"""Matrices by the entries that are not 0, and their compiled products.

Their indices are unsigned where they are used: a signed one could count from the end, and asking takes as
long as the product.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import connected_components

from dynamics.forces.compiled import inner
from dynamics.types import FloatArray, IntArray


class SparseRows(NamedTuple):
    """The entries of a matrix that are not 0, row by row.

    Attributes
    ----------
    first : (rows + 1,) int array
        First entry of each row, and the number of entries.
    column : (entries,) int array
    weight : (entries,) array
    """

    first: IntArray
    column: IntArray
    weight: FloatArray


class SparseMatrices(NamedTuple):
    """What the compiled loops multiply with.

    Attributes
    ----------
    damping, stiffness, direction, turn : SparseRows
        Of `SystemArrays`.
    mobility : SparseRows
        Inverse of the mass matrix.
    coupling : SparseRows
        Where the inverse of any sum of mass, damping and stiffness has entries: two freedoms that a chain of
        entries joins. Weights are 1.
    """

    damping: SparseRows
    stiffness: SparseRows
    direction: SparseRows
    turn: SparseRows
    mobility: SparseRows
    coupling: SparseRows


def sparse_rows(matrix: FloatArray) -> SparseRows:
    """Lay out the entries of `matrix` (rows, columns)."""
    row, column = np.nonzero(matrix)
    first = np.searchsorted(row, np.arange(matrix.shape[0] + 1))
    return SparseRows(first.astype(np.int64), column.astype(np.int64), matrix[row, column])


def sparse_matrices(
    mass: FloatArray, damping: FloatArray, stiffness: FloatArray, direction: FloatArray, turn: FloatArray
) -> SparseMatrices:
    """Lay out the matrices of a system: (n, n), the last two (R, n) and (m, n)."""
    joined = connected_components((mass != 0.0) | (damping != 0.0) | (stiffness != 0.0))[1]
    coupling = joined[:, None] == joined
    alone = connected_components(mass != 0.0)[1]
    mobility = np.where(alone[:, None] == alone, np.linalg.inv(mass), 0.0)
    matrices = (damping, stiffness, direction, turn, mobility, coupling.astype(float))
    return SparseMatrices(*map(sparse_rows, matrices))


@inner
def row_product(rows: SparseRows, weight: FloatArray, row: int, vector: FloatArray) -> float:
    """Return one row of the matrix with the entries `weight` times `vector`."""
    total = 0.0
    for entry in range(np.uint64(rows.first[row]), np.uint64(rows.first[row + 1])):
        total += weight[entry] * vector[np.uint64(rows.column[entry])]
    return total


@inner
def subtract_columns(rows: SparseRows, values: FloatArray, target: FloatArray) -> None:
    """Subtract the transposed matrix times `values`, one per row, from `target`."""
    for row in range(values.size):
        for entry in range(np.uint64(rows.first[row]), np.uint64(rows.first[row + 1])):
            target[np.uint64(rows.column[entry])] -= rows.weight[entry] * values[row]
