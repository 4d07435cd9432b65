"""Factorization of sparse symmetric matrices by nested dissection."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray

Solve = Callable[[FloatArray], FloatArray]

FACTORIZATION = "SuperLU on a METIS ordering"
"""Name of the method, for receipts and cache keys."""


def factorise(matrix: sp.csc_array, block: int) -> Solve:
    """Factorise a symmetric positive definite matrix once, for many right-hand sides.

    SciPy's SuperLU without pivoting, on METIS' nested dissection of the graph of the nodes, which hold
    `block` consecutive freedoms. Returns x(b) for b (n, m), dense. Raises `SolveError`: the matrix is
    singular.
    """
    order = nested_dissection(matrix, block)
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SolveError(f"{FACTORIZATION}: {error}") from error

    def solve(right: FloatArray) -> FloatArray:
        x = np.empty_like(right)
        x[order] = factor.solve(right[order])
        return x

    return solve


def nested_dissection(matrix: sp.csc_array, block: int) -> IntArray:
    """Return METIS' fill-reducing order of the freedoms, from the graph of their nodes."""
    import pymetis  # noqa: PLC0415 - a cached result needs no ordering

    graph = sp.csr_array(matrix[::block, ::block])
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    adjacency = pymetis.CSRAdjacency(graph.indptr, graph.indices)
    order, _ = pymetis.nested_dissection(adjacency)
    return (block * np.asarray(order, dtype=np.int64)[:, None] + np.arange(block)).ravel()
