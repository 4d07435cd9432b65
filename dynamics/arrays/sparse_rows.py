"""Matrices by the entries that are not 0, and their compiled products.

Their indices are unsigned where they are used: a signed one could count from the end, and asking takes as
long as the product.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse.csgraph import connected_components

from dynamics.arrays.modal_freedoms import ModalFreedoms, modal_freedoms, subtract_modal_resistance
from dynamics.kernels.compiled import inner
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
        Of `SystemArrays`. The first two have the same entries: those where either matrix is not 0.
    bodies : SparseRows
        The entries of `direction` before the modal freedoms.
    mobility : SparseRows
        Inverse of the mass matrix.
    coupling : SparseRows
        Where the inverse of any sum of mass, damping and stiffness has entries: two freedoms that a chain of
        entries joins. Weights are 1.
    modal : ModalFreedoms
        The last freedoms, where each of them is alone in the first two matrices.
    """

    damping: SparseRows
    stiffness: SparseRows
    direction: SparseRows
    turn: SparseRows
    bodies: SparseRows
    mobility: SparseRows
    coupling: SparseRows
    modal: ModalFreedoms


def _sparse_rows(matrix: FloatArray, entries: FloatArray | None = None) -> SparseRows:
    """Lay out the entries of `matrix` (rows, columns), or all at which `entries` is not 0."""
    row, column = np.nonzero(matrix if entries is None else entries)
    first = np.searchsorted(row, np.arange(matrix.shape[0] + 1))
    return SparseRows(first.astype(np.int64), column.astype(np.int64), matrix[row, column])


def sparse_matrices(
    mass: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    direction: FloatArray,
    turn: FloatArray,
    others: Sequence[FloatArray] = (),
) -> SparseMatrices:
    """Lay out the matrices of a system: (n, n), `direction` (R, n) and `turn` (m, n).

    `others` (..., n) are all further rows that act on its freedoms, or that these act on.
    """
    joined = connected_components((mass != 0.0) | (damping != 0.0) | (stiffness != 0.0))[1]
    coupling = joined[:, None] == joined
    alone = connected_components(mass != 0.0)[1]
    mobility = np.where(alone[:, None] == alone, np.linalg.inv(mass), 0.0)
    either = (damping != 0.0) | (stiffness != 0.0)
    modal = modal_freedoms(mass, damping, stiffness, direction, np.concatenate([turn, *others]))
    return SparseMatrices(
        damping=_sparse_rows(damping, either),
        stiffness=_sparse_rows(stiffness, either),
        direction=_sparse_rows(direction),
        turn=_sparse_rows(turn),
        bodies=_sparse_rows(direction[:, : modal.first]),
        mobility=_sparse_rows(mobility),
        coupling=_sparse_rows(coupling.astype(float)),
        modal=modal,
    )


_NONE = np.zeros((0, 0))
NO_ENTRIES = sparse_matrices(_NONE, _NONE, _NONE, _NONE, _NONE)
"""Of a system without freedoms."""


@inner
def row_product(rows: SparseRows, weight: FloatArray, row: int, vector: FloatArray) -> float:
    """Return one row of the matrix with the entries `weight` times `vector`."""
    total = 0.0
    for entry in range(np.uint64(rows.first[row]), np.uint64(rows.first[row + 1])):
        total += weight[entry] * vector[np.uint64(rows.column[entry])]
    return total


@inner
def row_products(
    rows: SparseRows, row: int, weight: FloatArray, first: FloatArray, other: FloatArray, second: FloatArray
) -> tuple[float, float]:
    """Return one row with the entries `weight` times `first`, and one with `other` times `second`."""
    by_first, by_second = 0.0, 0.0
    for entry in range(np.uint64(rows.first[row]), np.uint64(rows.first[row + 1])):
        column = np.uint64(rows.column[entry])
        by_first += weight[entry] * first[column]
        by_second += other[entry] * second[column]
    return by_first, by_second


@inner
def subtract_resistance(sparse: SparseMatrices, q: FloatArray, v: FloatArray, force: FloatArray) -> None:
    """Subtract what dampers and springs exert at `q` and `v` (n,) from `force`."""
    damping, stiffness = sparse.damping.weight, sparse.stiffness.weight
    for i in range(sparse.modal.first):
        damped, held = row_products(sparse.damping, i, damping, v, stiffness, q)
        force[i] -= damped + held
    subtract_modal_resistance(sparse.modal, q, v, force)


@inner
def subtract_columns(rows: SparseRows, values: FloatArray, target: FloatArray) -> None:
    """Subtract the transposed matrix times `values`, one per row, from `target`."""
    for row in range(values.size):
        for entry in range(np.uint64(rows.first[row]), np.uint64(rows.first[row + 1])):
            target[np.uint64(rows.column[entry])] -= rows.weight[entry] * values[row]
