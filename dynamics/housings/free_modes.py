"""Natural modes of a housing with its seats free, and its static deflections under forces on them."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import scipy.sparse as sp

from dynamics.errors import SolveError
from dynamics.housings.assembled_housing import BLOCK, AssembledHousing
from dynamics.types import FloatArray, IntArray

Solve = Callable[[FloatArray], FloatArray]


SHIFT = 1e-10
"""Shift of a housing that may move freely, relative to a bound of the highest squared frequency."""
REFINEMENTS = 8
REFINED, ACCEPTED = 1e-12, 1e-6
"""Work of the forces that a deflection leaves unbalanced, relative to that of its load: where refining ends,
and the most that is accepted. Soft mounts and slender bodies are ill conditioned and stay between."""


def _factorized(matrix: sp.csr_array) -> Solve:
    """Return x of matrix x = b; b is (f,) or (f, m); refuses a singular matrix."""
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


class ModeStatus(IntEnum):
    """The end of the search for modes and deflections."""

    CONVERGED = 0
    ITERATION_LIMIT = 1  # fewer modes than requested; those found are exact
    ILL_CONDITIONED = 2  # deflections under forces on the seats miss their residual


@dataclass(frozen=True)
class FreeModes:
    """Modes, unit modal mass, and static deflections."""

    rigid: FloatArray
    """Rigid motions that nothing holds. Shape (f, k)."""
    shape: FloatArray
    """Shape (f, m)."""
    frequency: FloatArray
    """Hz, rising; of elastic modes alone. Shape (m,)."""
    deflection: FloatArray
    """Under unit forces on the seats; where the housing is loose, in balance with its inertia. Shape (f, s).
    """
    status: ModeStatus
    eigen_residual: float
    """Largest |K x - w^2 M x| / |K x|."""
    solve_residual: float
    """Largest work of the unbalanced forces on a deflection, relative to that of its load."""
    rigid_ratio: float
    """Highest frequency found for a rigid motion over that of the first elastic mode; 0 where held."""


def free_modes(housing: AssembledHousing, count: int) -> FreeModes:
    """Find the lowest elastic modes by shift-invert Lanczos, and the deflections by the same factor.

    What did not converge is in the status. Raises `SolveError`: the stiffness is singular.
    """
    loose = housing.loose.shape[1]
    squares = housing.stiffness.diagonal() / housing.mass.diagonal() if loose else np.zeros(1)
    shift = SHIFT * float(np.max(squares))
    shifted = sp.csr_array(housing.stiffness + shift * housing.mass) if loose else housing.stiffness
    solve = _factorized(shifted)
    rigid_motions = housing.loose
    factor = np.linalg.cholesky(rigid_motions.T @ (housing.mass @ rigid_motions))
    rigid: FloatArray = np.asarray(np.linalg.solve(factor, rigid_motions.T).T)  # orthonormal
    square, shape = _lanczos(housing, solve, shift, count + loose)
    deflection, residual = _deflections(housing, solve, rigid)
    elastic, eigenvalues = shape[:, loose:], square[loose:]
    force = housing.stiffness @ elastic
    imbalance = np.linalg.norm(force - (housing.mass @ elastic) * eigenvalues, axis=0)
    status = ModeStatus.CONVERGED if residual <= ACCEPTED else ModeStatus.ILL_CONDITIONED
    if eigenvalues.size != count:
        status = ModeStatus.ITERATION_LIMIT
    return FreeModes(
        rigid=rigid,
        shape=elastic,
        frequency=np.sqrt(np.maximum(eigenvalues, 0.0)) / (2.0 * math.pi),
        deflection=deflection,
        status=status,
        eigen_residual=float(np.max(imbalance / np.linalg.norm(force, axis=0), initial=0.0)),
        solve_residual=residual,
        rigid_ratio=math.sqrt(float(np.abs(square[:loose]).max()) / eigenvalues[0])
        if loose and eigenvalues.size
        else 0.0,
    )


def _lanczos(
    housing: AssembledHousing, solve: Solve, shift: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return squared circular frequencies, rising, and their modes: those that converged."""
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh  # noqa: PLC0415

    size = housing.stiffness.shape[0]
    inverse = LinearOperator((size, size), matvec=solve, dtype=float)
    start = np.cos(np.arange(size, dtype=float))  # the same in every run
    basis = min(size - 1, basis_vectors(count))
    try:
        square, shape = eigsh(
            housing.stiffness, count, housing.mass, sigma=-shift, OPinv=inverse, v0=start, ncv=basis
        )
    except ArpackNoConvergence as error:
        square, shape = error.eigenvalues, error.eigenvectors
    order = np.argsort(square)
    return square[order], shape[:, order]


def basis_vectors(count: int) -> int:
    """Return how many vectors Lanczos' method holds for so many modes."""
    return count + max(count // 2, 20)


def _deflections(housing: AssembledHousing, solve: Solve, rigid: FloatArray) -> tuple[FloatArray, float]:
    """Return deflections and their residual.

    A loose housing is accelerated by the loads: inertia balances them, and the shift of the factor is
    taken out by iterative refinement.
    """
    inertia = housing.mass @ rigid
    load = housing.seats.T.toarray()
    load -= inertia @ (rigid.T @ load)
    deflection, imbalance = np.zeros_like(load), load
    residual = math.inf
    for _ in range(REFINEMENTS):
        deflection = deflection + solve(imbalance)
        deflection -= rigid @ (inertia.T @ deflection)
        imbalance = load - housing.stiffness @ deflection
        lost, done = (np.einsum("fs,fs->s", deflection, force) for force in (imbalance, load))
        previous, residual = residual, float(np.max(np.abs(lost) / done))
        if residual <= REFINED or residual > 0.5 * previous:
            break
    return deflection, residual
