"""Sparse factorisations of symmetric positive definite matrices: choices as objects."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from fe_contact.errors import SolveError
from fe_contact.types import FloatArray, IntArray

Solve = Callable[[FloatArray], FloatArray]


class Solver(Protocol):
    """Factorises a symmetric positive definite matrix once, for many right-hand sides."""

    @property
    def name(self) -> str:
        """Name for the receipt, e.g. "SuperLU on a METIS ordering"."""

    def factorise(self, matrix: sp.csc_array, block: int) -> Solve:
        """Return x(b) for the matrix; b is (n, m), dense. Nodes hold `block` consecutive freedoms.

        Raises
        ------
        SolveError
            The matrix is singular.
        """


@dataclass(frozen=True)
class SuperLuMetis:
    """SciPy's SuperLU without pivoting on METIS' nested dissection of the node graph."""

    name: str = "SuperLU on a METIS ordering"

    def factorise(self, matrix: sp.csc_array, block: int) -> Solve:
        """Order by nodes, factorise, and solve in the given order."""
        order = nested_dissection(matrix, block)
        permuted = sp.csc_array(matrix[order][:, order])
        try:
            factor = splu(
                permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )
        except RuntimeError as error:
            raise SolveError(f"{self.name}: {error}") from error

        def solve(right: FloatArray) -> FloatArray:
            x = np.empty_like(right)
            x[order] = factor.solve(right[order])
            return x

        return solve


@dataclass(frozen=True)
class SuperLuColamd:
    """SciPy's SuperLU with its default column ordering; for comparison, hopeless in 3-D."""

    name: str = "SuperLU on a COLAMD ordering"

    def factorise(self, matrix: sp.csc_array, block: int) -> Solve:
        """Factorise with pivoting."""
        try:
            return splu(matrix).solve
        except RuntimeError as error:
            raise SolveError(f"{self.name}: {error}") from error


@dataclass(frozen=True)
class Pardiso:
    """Intel MKL's PARDISO for symmetric positive definite matrices; needs the extra ``fast``."""

    name: str = "PARDISO"

    def factorise(self, matrix: sp.csc_array, block: int) -> Solve:
        """Factorise the upper triangle."""
        from pypardiso import PyPardisoSolver  # noqa: PLC0415 - optional, and slow to import
        from pypardiso.pardiso_wrapper import PyPardisoError  # noqa: PLC0415

        solver = PyPardisoSolver(mtype=2)
        upper = sp.csr_matrix(sp.triu(matrix, format="csr"))
        try:
            solver.factorize(upper)
        except PyPardisoError as error:
            raise SolveError(f"{self.name}: {error}") from error

        def solve(right: FloatArray) -> FloatArray:
            return np.asarray(solver.solve(upper, np.asfortranarray(right)))

        # MKL keeps its factor until told; pypardiso does not tell it.
        weakref.finalize(solve, solver.free_memory, everything=True)
        return solve


def nested_dissection(matrix: sp.csc_array, block: int) -> IntArray:
    """Return METIS' fill-reducing order of the freedoms, from the graph of their nodes."""
    import pymetis  # noqa: PLC0415 - only this solver needs it

    graph = sp.csr_array(matrix[::block, ::block])
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    adjacency = pymetis.CSRAdjacency(graph.indptr, graph.indices)
    order, _ = pymetis.nested_dissection(adjacency)
    return (block * np.asarray(order, dtype=np.int64)[:, None] + np.arange(block)).ravel()
