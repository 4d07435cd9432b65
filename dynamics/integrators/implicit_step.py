"""Compiled step of the L-stable, singly diagonally implicit method of order 4."""

from __future__ import annotations

import math

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.modal_freedoms import subtract_modal_forces
from dynamics.arrays.sparse_rows import row_product, subtract_columns, subtract_resistance
from dynamics.forces.elements import evaluate, has_unbalance, is_linear
from dynamics.integrators.equations import invert_equations
from dynamics.integrators.linear_elements import apply_linear, eliminate_linear, hold_linear
from dynamics.integrators.powers import write_powers
from dynamics.integrators.stage import add_stages, finish_step, set_motion
from dynamics.integrators.tableaus import (
    IMPLICIT_DIAGONAL,
    IMPLICIT_EMBEDDED,
    IMPLICIT_NODES,
    IMPLICIT_STAGES,
    IMPLICIT_WEIGHTS,
)
from dynamics.integrators.workspace import Count, Workspace
from dynamics.kernels.compiled import compiled, inner
from dynamics.kernels.routine import routine
from dynamics.motion.accelerations import set_acceleration
from dynamics.motion.motion import add_motion
from dynamics.types import FloatArray

# Compiled Newton's method for the local forces of one implicit stage.


ITERATION_LIMIT = 25
WEAK = 0.01
"""Change of a row's law with its own force, below which the row is iterated."""
SLOW = 0.1
"""Part of the last update that is left, above which the equations are made anew."""


@inner
def solve_local_forces(
    system: SystemArrays, work: Workspace, level: int, span: float, tolerance: float, first: bool
) -> int:
    """Find ``work.force`` such that each force is its law's at the motion it causes; return the iterations.

    On entry ``work.free``, ``free_rate`` and ``free_position`` hold the motion without local forces, and
    ``work.force`` is a first guess; on exit ``work.local`` holds the motion with them. `first` says whether
    this is the first stage of its step. The change of the positions with the forces is followed but left out
    of the equations: it is of the order of a deflection over a base pitch. Forces of linear elements are
    part of the motion (`hold_linear`). An update leaves the part of itself that it was of the one before;
    returns -1 if that did not fall to `tolerance` (N).
    """
    fresh, last, left = first, math.inf, 1.0
    if first:  # later stages begin with the forces and the answer to them that the one before ended with
        _respond(work, level)
    for iteration in range(ITERATION_LIMIT):
        _move(work, span)
        for e in range(system.elements.law.size):
            if not is_linear(system.elements, e):
                evaluate(system.elements, work.local, e)
        if fresh:
            _invert_equations(system, work, level, span)
        size = _update_forces(work)
        _respond(work, level)
        if iteration > 0:
            left = size / last
        if min(left, 1.0) * size <= tolerance:
            _move(work, span)
            return iteration + 1
        fresh = iteration > 0 and not left <= SLOW
        last = size
    return -1


@inner
def _respond(work: Workspace, level: int) -> None:
    """Write the accelerations of coordinates and positions by the forces, approach f, into ``response``."""
    response = work.response
    for k in range(response.size):
        response[k] = 0.0
    for r in range(work.force.size):
        force = work.force[r]
        if force != 0.0:
            for k in range(response.size):
                response[k] += work.approach[level, r, k] * force


@inner
def _move(work: Workspace, span: float) -> None:
    """Let the forces act: they move coordinates and positions by -span^2 response, rates by -span ..."""
    response, local, rows = work.response, work.local, work.force.size
    for k in range(rows):
        local.coordinate[k] = work.free[k] - span * span * response[k]
        local.rate[k] = work.free_rate[k] - span * response[k]
        local.acceleration[k] = work.free_acceleration[k] - response[k]
    for m in range(work.free_position.size):
        local.position[m] = work.free_position[m] - span * span * response[rows + m]


@inner
def _gain(work: Workspace, span: float, k: int, j: int) -> float:
    """Return how the law of row k changes with what moves the coordinate j of its own element."""
    moved = span * (span * work.local.tangent[k, j] + work.local.viscous[k, j])
    return float(moved + work.local.inertial[k, j])


@inner
def _invert_equations(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """List the rows whose law changes by more than WEAK with their own force, and invert their equations.

    These are I + (span^2 df/dy + span df/dy' + df/dy'') approach, transposed: then columns of the inverse lie
    along rows in memory.
    """
    size, approach = 0, work.approach
    for e in range(system.elements.law.size):
        first, end = system.elements.first[e], system.elements.first[e + 1]
        for k in range(first, end):
            change = 0.0
            for j in range(end - first):
                change += abs(_gain(work, span, k, j)) * approach[level, first + j, first + j]
            if change > WEAK:
                work.solved[size] = k
                size += 1
    work.solved[size] = -1
    for e in range(system.elements.law.size):
        first, end = system.elements.first[e], system.elements.first[e + 1]
        for b in range(size):
            k = work.solved[b]
            if not first <= k < end:
                continue
            for a in range(size):
                total = 1.0 if a == b else 0.0
                for j in range(end - first):
                    total += _gain(work, span, k, j) * approach[level, first + j, work.solved[a]]
                work.jacobian[a, b] = total
                work.jacobian[a, size + b] = 1.0 if a == b else 0.0
    invert_equations(work.jacobian, size)


@inner
def _update_forces(work: Workspace) -> float:
    """Add the update that the equations give to ``work.force``, and return the largest one."""
    update, solved, size = work.update, work.correction, 0
    for r in range(update.size):
        update[r] = work.local.force[r] - work.force[r]
    while work.solved[size] >= 0:
        solved[size] = 0.0
        size += 1
    for b in range(size):
        value = update[work.solved[b]]
        for a in range(size):
            solved[a] += work.jacobian[b, size + a] * value
    for a in range(size):
        update[work.solved[a]] = solved[a]
    largest = 0.0
    for r in range(update.size):
        work.force[r] += update[r]
        largest = max(largest, abs(update[r]))
    return largest


# Compiled preparation of one step size: inverse of the stage matrix, responses to local forces.


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
    pushed, turn = work.external, system.sparse.turn
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
            work.approach[level, r, rows + m] = row_product(turn, turn.weight, m, pushed)
    eliminate_linear(system, work, level, span)
    work.ready[level] = True


@inner
def _invert_modal(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """Write the modal freedoms' part of the inverse of the stage matrix, an entry each."""
    modal = system.sparse.modal
    for i in range(modal.mass.size):
        own = modal.mass[i] + span * (modal.damping[i] + span * modal.stiffness[i])
        work.inverse[level, system.sparse.coupling.first[modal.first + i]] = 1.0 / own


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


STAGE_COUNT = 6


@routine
def implicit_step(system: SystemArrays, work: Workspace, level: int, tolerance: float, audit: bool) -> bool:
    """Try one step from the state in `work`; return whether Newton's method converged in every stage.

    Fills q_new, v_new, a_new, the error estimates and, if `audit`, the powers. `tolerance` in N is Newton's.
    """
    if not work.ready[level]:
        prepare_level(system, work, level, IMPLICIT_DIAGONAL)
    step = work.step_sizes[level]
    for i in range(work.q.size):
        work.stage_v[0, i], work.stage_a[0, i] = work.v[i], work.a[i]
    for stage in range(1, STAGE_COUNT):
        iterations = solve_stage(system, work, level, stage, tolerance)
        if iterations < 0:
            return False
        work.counts[Count.NEWTON_TOTAL] += iterations
        work.counts[Count.NEWTON_MOST] = max(work.counts[Count.NEWTON_MOST], iterations)
        if audit and (IMPLICIT_WEIGHTS[stage] != 0.0 or stage == STAGE_COUNT - 1):
            write_powers(system, work, stage, work.time[0] + IMPLICIT_NODES[stage] * step)
    for i in range(work.q.size):
        work.v_new[i], work.a_new[i] = work.stage_v[STAGE_COUNT - 1, i], work.stage_a[STAGE_COUNT - 1, i]
    finish_step(work, step, IMPLICIT_WEIGHTS, IMPLICIT_EMBEDDED)
    return True


@routine
def solve_stage(system: SystemArrays, work: Workspace, level: int, stage: int, tolerance: float) -> int:
    """Solve one stage for its acceleration.

    With s = diagonal * step the stage's rates are v = v* + s a and q = q* + s v* + s^2 a, where v* and q*
    hold what earlier stages contribute; (M + s C + s^2 K) a = external - C v* - K (q* + s v*) - G^T f.
    """
    step, size = work.step_sizes[level], work.q.size
    span = IMPLICIT_DIAGONAL * step
    set_motion(system, work, work.time[0] + IMPLICIT_NODES[stage] * step, work.free_position)
    q, v = work.q_new, work.v_new
    for i in range(size):
        q[i], v[i] = work.q[i], work.v[i]
    add_stages(IMPLICIT_STAGES, stage, step, work.stage_v, q)
    add_stages(IMPLICIT_STAGES, stage, step, work.stage_a, v)
    for i in range(size):
        q[i] += span * v[i]
    sparse, linear = system.sparse, work.unloaded
    subtract_resistance(sparse, q, v, work.external)
    _accelerate(system, work, level, linear)
    for i in range(size):
        v[i] += span * linear[i]
        q[i] += span * span * linear[i]
        work.external[i] = 0.0  # it has done its part
    add_motion(system, q, v, work.free_position, work.free, work.free_rate)
    if has_unbalance(system.elements):
        set_acceleration(system, work.motion, linear, work.free_acceleration)
    hold_linear(system, work, level, span)
    iterations = solve_local_forces(system, work, level, span, tolerance, stage == 1)
    apply_linear(work)
    subtract_columns(sparse.bodies, work.force, work.external)
    subtract_modal_forces(sparse.modal, work.force, work.external)
    pushed = work.stage_a[stage]
    _accelerate(system, work, level, pushed)
    for i in range(size):
        q[i] += span * span * pushed[i]
        v[i] += span * pushed[i]
        work.stage_a[stage, i], work.stage_v[stage, i] = linear[i] + pushed[i], v[i]
    return iterations


@inner
def _accelerate(system: SystemArrays, work: Workspace, level: int, acceleration: FloatArray) -> None:
    """Write the accelerations by the forces in ``work.external``: modal freedoms answer for themselves."""
    coupling, inverse = system.sparse.coupling, work.inverse[level]
    for i in range(system.sparse.modal.first):
        acceleration[i] = row_product(coupling, inverse, i, work.external)
    first = np.uint64(system.sparse.modal.first)
    entry = np.uint64(coupling.first[first])
    for i in range(np.uint64(system.sparse.modal.damping.size)):
        acceleration[first + i] = inverse[entry + i] * work.external[first + i]
