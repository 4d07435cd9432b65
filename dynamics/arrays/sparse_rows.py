"""Matrices by the entries that are not 0, and their compiled products.

The products use unsigned indices: a negative index counts from the end of an array, and testing the sign of
each would take as long as the product.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.arrays.modal_freedoms import ModalFreedoms, modal_freedoms_of, subtract_modal_resistance
from dynamics.kernels.compiled import inner, inner_sums
from dynamics.types import BoolArray, FloatArray, IntArray

_NONE = np.zeros((0, 0))


class _SparseRows(NamedTuple):
    """The entries of a matrix that are not 0, row by row."""

    first: IntArray
    """First entry of each row, and the number of entries. Shape (rows + 1,)."""
    column: IntArray
    """Columns of the entries. Shape (entries,)."""
    weight: FloatArray
    """Weights of the entries. Shape (entries,)."""


class RowRuns(NamedTuple):
    """Runs of neighboring columns in the entries of a matrix, which products take in vector registers."""

    first: IntArray
    """First run of each row, and the number of runs. Shape (rows + 1,)."""
    entry: IntArray
    column: IntArray
    """`entry`, `column`: First entry of each run, and its column. Shape (runs,) each."""
    length: IntArray
    """Lengths of the runs. Shape (runs,)."""


def _row_runs(rows: _SparseRows) -> RowRuns:
    """Find the runs of a matrix."""
    row = np.repeat(np.arange(rows.first.size - 1), np.diff(rows.first))
    entry = np.arange(rows.column.size)
    begins = np.ones(rows.column.size, dtype=bool)
    begins[1:] = (np.diff(rows.column) != 1) | (np.diff(row) != 0)
    starts = entry[begins]
    length = np.diff(np.append(starts, entry.size))
    first = np.searchsorted(row[begins], np.arange(rows.first.size))
    return RowRuns(
        first=first.astype(np.int64),
        entry=starts.astype(np.int64),
        column=rows.column[starts].astype(np.int64),
        length=length.astype(np.int64),
    )


class SparseMatrices(NamedTuple):
    """Sparse matrices of a system for the products in compiled loops."""

    damping: _SparseRows
    stiffness: _SparseRows
    direction: _SparseRows
    position_gradient: _SparseRows
    """`damping`, `stiffness`, `direction`, `position_gradient`: Matrices of `SystemArrays`. The first two
    have the same entries: all at which either matrix is not 0.
    """
    bodies: _SparseRows
    """The entries of `direction` before the modal freedoms."""
    mobility: _SparseRows
    """Inverse of the mass matrix."""
    coupling: _SparseRows
    """Pattern of the inverse of any sum of mass, damping and stiffness: an entry for any two freedoms that a
    chain of entries joins. Weights are 1.
    """
    coupling_runs: RowRuns
    resistance_runs: RowRuns
    """`coupling_runs`, `resistance_runs`: Runs of the rows of `coupling`, and of `damping` and `stiffness`.
    """
    modal: ModalFreedoms
    """The last freedoms, as far as mass, damping and stiffness couple them to no other."""


def _sparse_rows(matrix: FloatArray, entries: FloatArray | None = None) -> _SparseRows:
    """Lay out the entries of `matrix` (rows, columns), or all at which `entries` is not 0."""
    row, column = np.nonzero(matrix if entries is None else entries)
    first = np.searchsorted(row, np.arange(matrix.shape[0] + 1))
    return _SparseRows(first.astype(np.int64), column.astype(np.int64), matrix[row, column])


def sparse_matrices(
    mass: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    direction: FloatArray,
    position_gradient: FloatArray,
    others: Sequence[FloatArray] = (),
) -> SparseMatrices:
    """Lay out the matrices of a system: (n, n), `direction` (R, n) and `position_gradient` (m, n).

    `others` (..., n) are all further rows over the freedoms along which forces act or depend on motion.
    """
    coupling = joined_by_chains((mass != 0.0) | (damping != 0.0) | (stiffness != 0.0))
    mobility = np.where(joined_by_chains(mass != 0.0), np.linalg.inv(mass), 0.0)
    either = (damping != 0.0) | (stiffness != 0.0)
    gradients = np.concatenate([position_gradient, *others])
    modal = modal_freedoms_of(mass, damping, stiffness, direction, gradients)
    joined, resisting = _sparse_rows(coupling.astype(float)), _sparse_rows(damping, either)
    return SparseMatrices(
        damping=resisting,
        stiffness=_sparse_rows(stiffness, either),
        direction=_sparse_rows(direction),
        position_gradient=_sparse_rows(position_gradient),
        bodies=_sparse_rows(direction[:, : modal.first]),
        mobility=_sparse_rows(mobility),
        coupling=joined,
        coupling_runs=_row_runs(joined),
        resistance_runs=_row_runs(resisting),
        modal=modal,
    )


def joined_by_chains(entries: BoolArray) -> BoolArray:
    """Return which freedoms a chain of `entries` (n, n) joins, either way, (n, n); each is joined to itself.

    Each pass doubles the length of the chains.
    """
    joined = entries | entries.T | np.eye(len(entries), dtype=bool)
    while True:
        reached = joined.astype(float)
        further = reached @ reached > 0.0
        if np.array_equal(further, joined):
            return joined
        joined = further


NO_ENTRIES = sparse_matrices(_NONE, _NONE, _NONE, _NONE, _NONE)
"""Matrices of a system without freedoms."""


@inner
def row_product(rows: _SparseRows, weight: FloatArray, row: int, vector: FloatArray) -> float:
    """Return one row of the matrix with the entries `weight` times `vector`."""
    total = 0.0
    for entry in range(np.uint64(rows.first[row]), np.uint64(rows.first[row + 1])):
        total += weight[entry] * vector[np.uint64(rows.column[entry])]
    return total


@inner
def row_products(
    rows: _SparseRows, row: int, weight: FloatArray, first: FloatArray, other: FloatArray, second: FloatArray
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
    """Subtract the forces of dampers and springs at `q` and `v` (n,) from `force`."""
    damping, stiffness = sparse.damping.weight, sparse.stiffness.weight
    for i in range(sparse.modal.first):
        damped, elastic = row_products(sparse.damping, i, damping, v, stiffness, q)
        force[i] -= damped + elastic
    subtract_modal_resistance(sparse.modal, q, v, force)


@inner_sums
def run_product(runs: RowRuns, weight: FloatArray, row: int, vector: FloatArray) -> float:
    """Return `row_product` by runs, its sums in any order."""
    total = 0.0
    for run in range(np.uint64(runs.first[row]), np.uint64(runs.first[row + 1])):
        entry, column = np.uint64(runs.entry[run]), np.uint64(runs.column[run])
        for k in range(np.uint64(runs.length[run])):
            total += weight[entry + k] * vector[column + k]
    return total


@inner
def subtract_resistance_by_runs(
    sparse: SparseMatrices, q: FloatArray, v: FloatArray, force: FloatArray
) -> None:
    """Subtract the forces as `subtract_resistance` does, the sums of a row in any order."""
    damping, stiffness, runs = sparse.damping.weight, sparse.stiffness.weight, sparse.resistance_runs
    for i in range(sparse.modal.first):
        force[i] -= run_product(runs, damping, i, v) + run_product(runs, stiffness, i, q)
    subtract_modal_resistance(sparse.modal, q, v, force)


@inner
def subtract_columns(rows: _SparseRows, values: FloatArray, target: FloatArray) -> None:
    """Subtract the transposed matrix times `values`, one per row, from `target`."""
    for row in range(values.size):
        for entry in range(np.uint64(rows.first[row]), np.uint64(rows.first[row + 1])):
            target[np.uint64(rows.column[entry])] -= rows.weight[entry] * values[row]
