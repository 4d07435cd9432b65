"""Factor of a symmetric positive definite matrix: SuperLU without pivoting on an ordering by METIS."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from dynamics.errors import SolveError
from dynamics.types import FloatArray, IntArray

BLOCK = 3
"""Consecutive freedoms that are ordered as one: those of a node, half those of a rigid face."""
Solve = Callable[[FloatArray], FloatArray]


def factorized(matrix: sp.csr_array) -> Solve:
    """Return x of matrix x = b; b is (f,) or (f, m).

    Raises
    ------
    SolveError
        The matrix is singular.
    """
    from scipy.sparse.linalg import splu  # noqa: PLC0415 (start-up time)

    order = _nested_dissection(matrix)
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SolveError(f"The stiffness matrix of the housing cannot be factorized: {error}.") from error

    def solve(right: FloatArray) -> FloatArray:
        x = np.empty_like(right)
        x[order] = factor.solve(right[order])
        return x

    return solve


def _nested_dissection(matrix: sp.csr_array) -> IntArray:
    """Return METIS' fill-reducing order, from the graph of blocks."""
    import pymetis  # noqa: PLC0415 (start-up time)

    blocks = matrix.tobsr(blocksize=(BLOCK, BLOCK))
    graph = sp.csr_array((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    order, _ = pymetis.nested_dissection(pymetis.CSRAdjacency(graph.indptr, graph.indices))
    return (BLOCK * np.asarray(order, dtype=np.int64)[:, None] + np.arange(BLOCK)).ravel()
