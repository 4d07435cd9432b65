"""Compiled preparation of one step size: inverse of the stage matrix, responses to the flanks."""

from __future__ import annotations

from dynamics.forces.compiled import compiled, inner
from dynamics.integrators.workspace import Workspace
from dynamics.system.arrays import SystemArrays
from dynamics.types import FloatArray, IntArray


@inner
def prepare_rung(system: SystemArrays, work: Workspace, rung: int, diagonal: float) -> None:
    """Fill the matrices of `rung` for the stage weight `diagonal` (0: an explicit method, M alone)."""
    span = diagonal * work.ladder[rung]
    flanks, size = work.force.size, work.q.size
    matrix = work.matrix
    for i in range(size):
        for j in range(size):
            matrix[i, j] = system.mass[i, j] + span * (system.damping[i, j] + span * system.stiffness[i, j])
    invert_blocks(matrix, system.block, work.inverse[rung])
    for f in range(flanks):
        for i in range(size):
            total = 0.0
            for j in range(size):
                total += work.inverse[rung, i, j] * system.direction[f, j]
            work.response[rung, f, i] = total
    for e in range(flanks):
        for f in range(flanks):
            for i in range(size):
                work.approach[rung, e, f] += system.direction[e, i] * work.response[rung, f, i]
                work.turning[rung, e, f] += system.turn[e, i] * work.response[rung, f, i]
    work.ready[rung] = True


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
