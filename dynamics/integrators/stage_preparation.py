"""Compiled preparation of one step size: inverse of the stage matrix, responses to local forces."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import row_product
from dynamics.integrators.linear_elimination import eliminate_linear
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.compiled import compiled, inner
from dynamics.types import FloatArray


@inner
def prepare_level(system: SystemArrays, work: Workspace, level: int, diagonal: float) -> None:
    """Fill the matrices of `level` for the stage weight `diagonal`."""
    span, size, rows = diagonal * work.step_sizes[level], system.sparse.modal.first, work.force.size
    matrix, along, coupling = work.matrix, system.sparse.direction, system.sparse.coupling
    for i in range(size):
        for j in range(size):
            matrix[i, j] = system.mass[i, j] + span * (system.damping[i, j] + span * system.stiffness[i, j])
    invert(matrix)
    for i in range(size):
        for entry in range(coupling.first[i], coupling.first[i + 1]):
            work.inverse[level, entry] = matrix[i, coupling.column[entry]]
    _invert_modal(system, work, level, span)
    pushed, gradient = work.external, system.sparse.position_gradient  # `external` is free as scratch here
    for r in range(rows):
        for i in range(pushed.size):
            pushed[i] = 0.0
        for entry in range(along.first[r], along.first[r + 1]):
            column = along.column[entry]
            if column >= size:
                pushed[column] = along.weight[entry] * work.inverse[level, coupling.first[column]]
                continue
            for i in range(size):
                pushed[i] += along.weight[entry] * matrix[i, column]
        for k in range(rows):
            work.approach[level, r, k] = row_product(along, along.weight, k, pushed)
        for m in range(work.free_position.size):
            work.approach[level, r, rows + m] = row_product(gradient, gradient.weight, m, pushed)
    eliminate_linear(system, work, level, span)
    work.ready[level] = True


@inner
def _invert_modal(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """Write the modal freedoms' part of the inverse of the stage matrix, an entry each."""
    modal = system.sparse.modal
    for i in range(modal.mass.size):
        pivot = modal.mass[i] + span * (modal.damping[i] + span * modal.stiffness[i])
        work.inverse[level, system.sparse.coupling.first[modal.first + i]] = 1.0 / pivot


@compiled
def invert(matrix: FloatArray) -> None:
    """Invert a symmetric positive definite matrix in place.

    Gauss and Jordan without pivoting: stable for positive definite matrices. Freedoms that nothing couples
    stay apart: their entries are and remain 0.
    """
    size = matrix.shape[0]
    for p in range(size):
        pivot = 1.0 / matrix[p, p]
        matrix[p, p] = 1.0
        for j in range(size):
            matrix[p, j] *= pivot
        for i in range(size):
            factor = matrix[i, p]
            if i == p or factor == 0.0:
                continue
            matrix[i, p] = 0.0
            for j in range(size):
                matrix[i, j] -= factor * matrix[p, j]
