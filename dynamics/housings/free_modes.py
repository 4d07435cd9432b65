"""Natural modes of a housing with its seats free, and its static deflections under forces on the seats.

A seat is a bore of the housing that holds a bearing. A loose housing has rigid motions that no mount holds.
Axes of arrays: f freedoms, m elastic modes, k rigid motions, s forces on seats.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from dynamics.errors import SolveError
from dynamics.housings.assembled_housing import BLOCK, AssembledHousing
from dynamics.types import FloatArray, IntArray
from host.graph_order import graph_order
from host.optional_modules import sparse as sp

Solve = Callable[[FloatArray], FloatArray]
"""The solution of a linear system of equations, from its right side."""

SHIFT = 1e-10
"""Shift of the squared frequencies of a loose housing, whose stiffness alone is singular.

It is relative to an estimate of the highest squared frequency.
"""
REFINEMENTS = 8
"""Most steps of iterative refinement of the deflections."""
REFINED = 1e-12
"""Residual at which refinement ends: work of the unbalanced forces on a deflection over that of its load."""
ACCEPTED = 1e-6
"""Largest accepted residual. Ill-conditioned housings, slender or on soft mounts, exceed `REFINED`."""
MIN_DECREASE = 0.5
"""Residual over that of the step before, above which refinement ends: further steps gain nothing."""


def _factorized(matrix: sp.csr_array) -> Solve:
    """Return the solution of matrix x = b, b (f,) or (f, m); raises `SolveError`: a singular matrix."""
    from scipy.sparse.linalg import splu  # noqa: PLC0415 (start-up time)

    order = _fill_reducing_order(matrix)
    permuted = sp.csc_array(matrix[order][:, order])
    try:
        # the matrix is symmetric and in an order of ours: SuperLU must neither reorder nor pivot
        factor = splu(permuted, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise SolveError(f"The stiffness matrix of the housing cannot be factorized: {error}.") from error

    def solve(right: FloatArray) -> FloatArray:
        x = np.empty_like(right)
        x[order] = factor.solve(right[order])
        return x

    return solve


def _fill_reducing_order(matrix: sp.csr_array) -> IntArray:
    """Return the order of the freedoms (f,) by which the factor fills little, from the graph of blocks."""
    blocks = matrix.tobsr(blocksize=(BLOCK, BLOCK))
    graph = sp.csr_array((np.ones(len(blocks.indices)), blocks.indices, blocks.indptr))
    graph.setdiag(0.0)
    graph.eliminate_zeros()
    order = graph_order(graph.indptr, graph.indices)
    return (BLOCK * order[:, None] + np.arange(BLOCK)).ravel()  # blocks to their freedoms


class ModeStatus(IntEnum):
    """Outcome of the search for modes and deflections."""

    CONVERGED = 0
    ITERATION_LIMIT = 1  # fewer modes than requested; those found are exact
    ILL_CONDITIONED = 2  # deflections under forces on the seats miss their residual


@dataclass(frozen=True)
class FreeModes:
    """Modes of unit modal mass, and static deflections."""

    rigid: FloatArray
    """Rigid motions that no mount holds. Shape (f, k)."""
    shape: FloatArray
    """Shapes of the elastic modes. Shape (f, m)."""
    frequency: FloatArray
    """Frequencies of the elastic modes, Hz, rising. Shape (m,)."""
    deflection: FloatArray
    """Static deflections under unit forces on the seats. The inertia of a loose housing balances the forces.
    Shape (f, s).
    """
    status: ModeStatus
    eigen_residual: float
    """Largest |K x - w^2 M x| / |K x| of the elastic modes."""
    solve_residual: float
    """Largest work of the unbalanced forces on a deflection, relative to the work of its load."""
    rigid_ratio: float
    """Highest frequency of a rigid motion over that of the first elastic mode; 0: not loose."""


def free_modes(housing: AssembledHousing, count: int) -> FreeModes:
    """Find the lowest elastic modes by shift-invert Lanczos, and the deflections by the same factor.

    The status says what did not converge. Raises `SolveError`: the stiffness is singular.
    """
    rigid_motions = housing.loose  # (f, k); k = 0: the mounts hold the housing
    rigid_count = rigid_motions.shape[1]
    shift = 0.0
    shifted = housing.stiffness
    if rigid_count:
        shift = SHIFT * float(np.max(housing.stiffness.diagonal() / housing.mass.diagonal()))
        shifted = sp.csr_array(housing.stiffness + shift * housing.mass)
    solve = _factorized(shifted)
    # with the Cholesky factor of their mass the rigid motions become orthonormal in the mass matrix
    factor = np.linalg.cholesky(rigid_motions.T @ (housing.mass @ rigid_motions))
    rigid: FloatArray = np.asarray(np.linalg.solve(factor, rigid_motions.T).T)
    square, shape = _lanczos(housing, solve, shift, count + rigid_count)
    deflection, residual = _deflections(housing, solve, rigid)
    # the lowest modes found are the rigid motions
    elastic = shape[:, rigid_count:]
    eigenvalues = square[rigid_count:]
    rigid_ratio = 0.0
    if rigid_count and eigenvalues.size:
        rigid_ratio = math.sqrt(float(np.abs(square[:rigid_count]).max()) / eigenvalues[0])
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
        rigid_ratio=rigid_ratio,
    )


def _lanczos(
    housing: AssembledHousing, solve: Solve, shift: float, count: int
) -> tuple[FloatArray, FloatArray]:
    """Return the squared angular frequencies that converged, rising, and their modes.

    `solve` solves with the stiffness plus `shift` times the mass: the modes nearest to -`shift` are found
    first.
    """
    from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh  # noqa: PLC0415

    size = housing.stiffness.shape[0]
    inverse = LinearOperator((size, size), matvec=solve, dtype=float)
    start = np.cos(np.arange(size, dtype=float))  # any vector; the same in every run
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
    """Return the number of vectors that Lanczos' method stores to find `count` modes."""
    return count + max(count // 2, 20)


def _deflections(housing: AssembledHousing, solve: Solve, rigid: FloatArray) -> tuple[FloatArray, float]:
    """Return the deflections under unit forces on the seats, (f, s), and their largest residual.

    A loose housing accelerates under a load, and its inertia balances the load. Iterative refinement removes
    the error that the shift of the factor causes.
    """
    inertia = housing.mass @ rigid
    load = housing.seats.T.toarray()
    load -= inertia @ (rigid.T @ load)  # inertia of the rigid acceleration
    deflection = np.zeros_like(load)
    imbalance = load
    residual = math.inf
    for _ in range(REFINEMENTS):
        deflection = deflection + solve(imbalance)
        deflection -= rigid @ (inertia.T @ deflection)  # no rigid motion
        imbalance = load - housing.stiffness @ deflection
        unbalanced_work = np.einsum("fs,fs->s", deflection, imbalance)
        work = np.einsum("fs,fs->s", deflection, load)
        previous = residual
        residual = float(np.max(np.abs(unbalanced_work) / work))
        if residual <= REFINED or residual > MIN_DECREASE * previous:
            break
    return deflection, residual
