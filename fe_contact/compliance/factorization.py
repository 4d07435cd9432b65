"""Factorization of sparse symmetric matrices."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray
from host.graph_order import ORDERING, graph_order
from host.optional_modules import sparse as sp
from host.optional_modules import sparse_linalg

Solve = Callable[[FloatArray], FloatArray]

FACTORIZATION = f"SuperLU on a {ORDERING} ordering"
"""Name of the method, for receipts and cache keys."""


def factorise(matrix: sp.csc_array, block: int) -> Solve:
    """Factorise a symmetric positive definite matrix once, for many right-hand sides.

    SciPy's SuperLU without pivoting, on an order of the graph of the nodes, which hold `block` consecutive
    freedoms. Returns x(b) for b (n, m), dense. Raises `SolveError`: the matrix is
    singular.
    """
    order = fill_reducing_order(matrix, block)
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        factor = sparse_linalg.splu(
            permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError as error:
        raise SolveError(f"{FACTORIZATION}: {error}") from error

    def solve(right: FloatArray) -> FloatArray:
        x = np.empty_like(right)
        x[order] = factor.solve(right[order])
        return x

    return solve


def fill_reducing_order(matrix: sp.csc_array, block: int) -> IntArray:
    """Return the order of the freedoms by which the factor fills little, from the graph of their nodes."""
    graph = sp.csr_array(matrix[::block, ::block])
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    order = graph_order(graph.indptr, graph.indices)
    return (block * order[:, None] + np.arange(block)).ravel()
