"""Compiled preparation of one step size: inverse of the stage matrix, responses to local forces."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.compiled import compiled, inner
from dynamics.integrators.workspace import Workspace
from dynamics.types import FloatArray, IntArray


@inner
def prepare_level(system: SystemArrays, work: Workspace, level: int, diagonal: float) -> None:
    """Fill the matrices of `level` for the stage weight `diagonal` (0: an explicit method, M alone)."""
    span = diagonal * work.step_sizes[level]
    rows, size = work.force.size, work.q.size
    matrix = work.matrix
    for i in range(size):
        for j in range(size):
            matrix[i, j] = system.mass[i, j] + span * (system.damping[i, j] + span * system.stiffness[i, j])
            work.inverse[level, i, j] = 0.0
    invert_blocks(matrix, system.block, work.inverse[level])
    for r in range(rows):
        for i in range(size):
            total = 0.0
            for j in range(size):
                total += work.inverse[level, i, j] * system.direction[r, j]
            work.response[level, r, i] = total
    for r in range(rows):
        for k in range(rows):
            work.approach[level, k, r] = 0.0
        for m in range(system.turn.shape[0]):
            work.position_response[level, m, r] = 0.0
        for i in range(size):
            for k in range(rows):
                work.approach[level, k, r] += system.direction[k, i] * work.response[level, r, i]
            for m in range(system.turn.shape[0]):
                work.position_response[level, m, r] += system.turn[m, i] * work.response[level, r, i]
    work.ready[level] = True


@compiled
def invert_blocks(matrix: FloatArray, block: IntArray, inverse: FloatArray) -> None:
    """Invert a symmetric positive definite block-diagonal matrix; it is destroyed.

    Gauss and Jordan without pivoting: stable for positive definite matrices.
    """
    for p in range(block.shape[0]):
        inverse[p, p] = 1.0
    for p in range(block.shape[0]):
        pivot = 1.0 / matrix[p, p]
        first, end = block[p, 0], block[p, 1]
        for j in range(first, end):
            matrix[p, j] *= pivot
            inverse[p, j] *= pivot
        for i in range(first, end):
            if i != p:
                factor = matrix[i, p]
                for j in range(first, end):
                    matrix[i, j] -= factor * matrix[p, j]
                    inverse[i, j] -= factor * inverse[p, j]


@inner
def row_product(matrix: FloatArray, block: IntArray, vector: FloatArray, row: int) -> float:
    """Return one row of a block-diagonal matrix times a vector."""
    total = 0.0
    for j in range(block[row, 0], block[row, 1]):
        total += matrix[row, j] * vector[j]
    return total
