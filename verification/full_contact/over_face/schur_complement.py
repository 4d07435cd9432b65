"""Schur complement of a symmetric matrix whose unknowns stand in groups on the nodes of a plane graph."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from scipy.linalg import LinAlgError, cholesky, solve_triangular
from scipy.linalg.blas import dsyrk

from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray

MERGED, MAX_NODES = 1.6, 48
"""Fronts merge into the one above while it grows less than so, and up to so many eliminated nodes."""


@dataclass(frozen=True)
class _Front:
    """Nodes that are eliminated together, and nodes that the elimination couples, both rising."""

    nodes: IntArray
    beyond: IntArray


@dataclass(frozen=True)
class ColumnMatrix:
    """Symmetric matrix of columns of unknowns on n nodes, in the order of elimination."""

    lower: sp.csc_array
    """Lower triangle of the matrix. (m, m) sparse array."""
    starts: IntArray
    """First unknown of each node. Shape (n + 1,)."""
    graph: sp.csr_array
    """Graph of the nodes that share elements. (n, n) sparse array."""

    def unknowns(self, nodes: IntArray) -> IntArray:
        """Return the unknowns of nodes, node by node."""
        return np.concatenate([np.arange(self.starts[n], self.starts[n + 1]) for n in nodes.tolist()])


def schur_complement(matrix: ColumnMatrix, border: int) -> FloatArray:
    """Eliminate all nodes but the last `border`; raises `SolveError`: the matrix is not positive definite."""
    left: dict[int, list[tuple[IntArray, FloatArray]]] = defaultdict(list)
    row = np.zeros(matrix.starts[-1], dtype=np.int64)
    count = len(matrix.starts) - 1
    fronts = _fronts(matrix.graph, count - border)
    owner = np.full(count, len(fronts))
    for number, front in enumerate(fronts):
        owner[front.nodes] = number
    fronts.append(_Front(np.arange(count - border, count), np.empty(0, dtype=np.int64)))
    for number, front in enumerate(fronts):
        dense, rows, pivots = _assembled(matrix, front, left.pop(number, []), row)
        if number == len(fronts) - 1:
            break
        rest = _eliminated(dense, pivots)
        if len(front.beyond):
            left[int(owner[front.beyond].min())].append((rows[pivots:], rest))
    return np.asarray(np.tril(dense) + np.tril(dense, -1).T)


def _assembled(
    matrix: ColumnMatrix, front: _Front, children: list[tuple[IntArray, FloatArray]], row: IntArray
) -> tuple[FloatArray, IntArray, int]:
    """Return the lower triangle of a front, its unknowns, and how many of them are eliminated."""
    unknowns = matrix.unknowns(front.nodes)
    rows = np.concatenate([unknowns, matrix.unknowns(front.beyond)]) if len(front.beyond) else unknowns
    row[rows] = np.arange(len(rows))
    dense = np.zeros((len(rows), len(rows)), order="F")
    columns = matrix.lower[:, unknowns]
    column = np.repeat(np.arange(len(unknowns)), np.diff(columns.indptr))
    dense[row[columns.indices], column] = columns.data
    for theirs, block in children:
        at = row[theirs]
        dense.T[np.ix_(at, at)] += block.T  # both run along columns
    return dense, rows, len(unknowns)


def _eliminated(dense: FloatArray, pivots: int) -> FloatArray:
    """Return the front without its first `pivots` unknowns, the lower triangle."""
    try:
        factor = cholesky(dense[:pivots, :pivots], lower=True, check_finite=False)
    except LinAlgError as error:
        raise SolveError(f"full contact over the face: {error}") from error
    if pivots == len(dense):
        return np.empty((0, 0))
    below = solve_triangular(factor, dense[pivots:, :pivots].T, lower=True, check_finite=False)
    rest = np.asfortranarray(dense[pivots:, pivots:])
    return np.asarray(dsyrk(-1.0, below, 1.0, rest, trans=1, lower=1, overwrite_c=1))


def _fronts(graph: sp.csr_array, eliminated: int) -> list[_Front]:
    """Return the fronts of the first nodes, children before their parents."""
    beyond = _structures(graph, eliminated)
    parent = [int(b[0]) if len(b) else -1 for b in beyond]
    top = list(range(eliminated))
    members: dict[int, list[int]] = defaultdict(list)
    for node in range(eliminated - 1, -1, -1):
        above = parent[node]
        if 0 <= above < eliminated:
            head = top[above]
            merged = len(members[head]) + 1 + len(beyond[head])
            if len(members[head]) < MAX_NODES and merged <= MERGED * (1 + len(beyond[node])) + 1:
                top[node] = head
        members[top[node]].append(node)
    return [_Front(np.array(members[head][::-1]), beyond[head]) for head in sorted(members)]


def _structures(graph: sp.csr_array, eliminated: int) -> list[IntArray]:
    """Return for each of the first nodes the later ones that its elimination ties together, rising."""
    beyond: list[IntArray] = []
    children: dict[int, list[int]] = defaultdict(list)
    for node in range(eliminated):
        near = graph.indices[graph.indptr[node] : graph.indptr[node + 1]].astype(np.int64)
        parts: list[IntArray] = [near, *(beyond[child] for child in children.pop(node, []))]
        union: IntArray = np.unique(np.concatenate(parts))
        beyond.append(union[union > node])
        if len(beyond[-1]):
            children[int(beyond[-1][0])].append(node)
    return beyond
