"""Compiled step of the L-stable, singly diagonally implicit method of order 4."""

from __future__ import annotations

import math

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import (
    row_product,
    run_product,
    subtract_columns,
    subtract_modal_forces,
    subtract_resistance_by_runs,
)
from dynamics.forces.elements import evaluate, evaluate_linear, has_unbalance, is_linear
from dynamics.integrators.explicit_step import add_stages, finish_step, set_motion, write_powers
from dynamics.integrators.tableaus import (
    IMPLICIT_DIAGONAL,
    IMPLICIT_EMBEDDED,
    IMPLICIT_NODES,
    IMPLICIT_STAGES,
    IMPLICIT_WEIGHTS,
)
from dynamics.integrators.workspace import Count, Workspace
from dynamics.kernels.compiled import compiled, inner, inner_sums
from dynamics.kernels.routine import routine
from dynamics.motion.motion import add_motion, set_acceleration
from dynamics.types import FloatArray

ITERATION_LIMIT = 25
WEAK = 0.01
"""Change of a row's law with its own force, below which the row is iterated."""
SLOW = 0.1
"""Part of the last update that is left, above which the equations are made anew."""
ROUNDING = 2.0**-52
"""Update over the largest force that rounding makes where coordinates are as small as deflections."""
NOISE, STALL = 1e-10, 0.5
"""Update over the largest force, and part of the last one left, from which on larger coordinates make it."""
STAGE_COUNT = 6


@inner
def _gauss_jordan(matrix: FloatArray, size: int) -> None:
    """Turn [A, I] in the first `size` rows into [I, inverse], with row pivoting (Gauss and Jordan)."""
    for p in range(size):
        best = p
        for i in range(p + 1, size):
            if abs(matrix[i, p]) > abs(matrix[best, p]):
                best = i
        pivot = 1.0 / matrix[best, p]
        for j in range(2 * size):
            matrix[best, j], matrix[p, j] = matrix[p, j], matrix[best, j] * pivot
        for i in range(size):
            factor = matrix[i, p]
            if i != p and factor != 0.0:
                for j in range(2 * size):
                    matrix[i, j] -= factor * matrix[p, j]


# Compiled elimination of linear force elements from the implicit stages.


@inner
def _eliminate_linear(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """Fill ``held`` of a level, and let linear elements follow in its ``approach``."""
    if work.linear.shape[0] == 0:
        return
    for e in range(system.elements.law.size):
        if is_linear(system.elements, e):
            evaluate_linear(system.elements, work.local, e)
    _invert(work, level, span)
    _hold(work, level)
    _follow(work, level, span)


@inner
def _invert(work: Workspace, level: int, span: float) -> None:
    """Write H behind I + B W in ``jacobian``."""
    count = work.linear.shape[0]
    for a in range(count):
        for b in range(count):
            unit = 1.0 if a == b else 0.0
            work.jacobian[a, b] = unit + _strain(work, level, span, a, work.linear[b, 0])
            work.jacobian[a, count + b] = unit
    _gauss_jordan(work.jacobian, count)


@inner
def _strain(work: Workspace, level: int, span: float, a: int, row: int) -> float:
    """Return the entry of B W in the linear row number `a` for a force in `row`."""
    local, total = work.local, 0.0
    own, first, end = work.linear[a, 0], work.linear[a, 1], work.linear[a, 2]
    for c in range(first, end):
        gain = span * (span * local.tangent[own, c - first] + local.viscous[own, c - first])
        total += gain * work.approach[level, row, work.linear[c, 0]]
    return total


@inner
def _hold(work: Workspace, level: int) -> None:
    """Write the accelerations W H K and W H C by the linear elements."""
    count = work.linear.shape[0]
    for c in range(count):
        for k in range(work.response.size):
            work.held[level, k, c] = work.held[level, k, count + c] = 0.0
        first, end = work.linear[c, 1], work.linear[c, 2]
        for b in range(count):
            spring, damper = 0.0, 0.0
            for a in range(first, end):
                row, weight = work.linear[a, 0], work.jacobian[b, count + a]
                spring += weight * work.local.tangent[row, c - first]
                damper += weight * work.local.viscous[row, c - first]
            for k in range(work.response.size):
                answer = work.approach[level, work.linear[b, 0], k]
                work.held[level, k, c] += spring * answer
                work.held[level, k, count + c] += damper * answer


@inner
def _follow(work: Workspace, level: int, span: float) -> None:
    """Subtract W H B W from the answer to each other force; the rows of linear elements become 0."""
    count = work.linear.shape[0]
    for row in range(work.force.size):
        if _is_linear_row(work, row):
            continue
        for a in range(count):
            work.resting[a] = _strain(work, level, span, a, row)
        for b in range(count):
            force = 0.0
            for a in range(count):
                force += work.jacobian[b, count + a] * work.resting[a]
            for k in range(work.response.size):
                work.approach[level, row, k] -= force * work.approach[level, work.linear[b, 0], k]
    for b in range(count):
        for k in range(work.response.size):
            work.approach[level, work.linear[b, 0], k] = 0.0


@inner
def _is_linear_row(work: Workspace, row: int) -> bool:
    among = False
    for a in range(work.linear.shape[0]):
        among = among or work.linear[a, 0] == row
    return bool(among)


@inner
def _apply_linear(work: Workspace) -> None:
    """Write the forces of linear elements in the local state at the end of a stage; tangents are constant."""
    local = work.local
    for a in range(work.linear.shape[0]):
        row, first, end = work.linear[a, 0], work.linear[a, 1], work.linear[a, 2]
        elastic, viscous = 0.0, 0.0
        for c in range(first, end):
            elastic += local.tangent[row, c - first] * local.coordinate[work.linear[c, 0]]
            viscous += local.viscous[row, c - first] * local.rate[work.linear[c, 0]]
        local.elastic[row] = elastic
        work.force[row] = local.force[row] = elastic + viscous


@inner
def _hold_linear(system: SystemArrays, work: Workspace, level: int, span: float) -> None:
    """Let linear elements act on the motion without local forces; Newton's method leaves their rows at 0."""
    count = work.linear.shape[0]
    if count == 0:
        return
    for c in range(count):
        row = work.linear[c, 0]
        work.resting[c], work.resting[count + c] = work.free[row], work.free_rate[row]
        work.force[row] = work.local.force[row] = 0.0
    rows, accelerated = work.force.size, has_unbalance(system.elements)
    for k in range(rows):
        answer = _sum(work.held[level, k], work.resting)
        work.free[k] -= span * span * answer
        work.free_rate[k] -= span * answer
        if accelerated:
            work.free_acceleration[k] -= answer
    for m in range(work.free_position.size):
        work.free_position[m] -= span * span * _sum(work.held[level, rows + m], work.resting)


@inner_sums
def _sum(weights: FloatArray, values: FloatArray) -> float:
    total = 0.0
    for c in range(values.size):
        total += weights[c] * values[c]
    return total


# Compiled Newton's method for the local forces of one implicit stage.


@inner
def _solve_local_forces(
    system: SystemArrays, work: Workspace, level: int, span: float, tolerance: float, first: bool
) -> int:
    """Find ``work.force`` such that each force is its law's at the motion it causes; return the iterations.

    On entry ``work.free``, ``free_rate`` and ``free_position`` hold the motion without local forces, and
    ``work.force`` is a first guess; on exit ``work.local`` holds the motion with them. `first` says whether
    this is the first stage of its step. The change of the positions with the forces is followed but left out
    of the equations: it is of the order of a deflection over a base pitch. Forces of linear elements are
    part of the motion (`_hold_linear`). An update leaves the part of itself that it was of the one before;
    returns -1 if that fell neither to `tolerance` (N) nor to rounding.
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
        if min(left, 1.0) * size <= tolerance or _is_rounding(work, size, left):
            _move(work, span)
            return iteration + 1
        fresh = iteration > 0 and not left <= SLOW
        last = size
    return -1


@inner
def _is_rounding(work: Workspace, size: float, left: float) -> bool:
    """Whether an update, of which the part `left` remains, is all that rounding lets Newton's method do."""
    largest = 0.0
    for r in range(work.force.size):
        largest = max(largest, abs(work.force[r]))
    return size <= ROUNDING * largest or (left >= STALL and size <= NOISE * largest)


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
    _gauss_jordan(work.jacobian, size)


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
def _prepare_level(system: SystemArrays, work: Workspace, level: int, diagonal: float) -> None:
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
    _eliminate_linear(system, work, level, span)
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


@routine
def implicit_step(system: SystemArrays, work: Workspace, level: int, tolerance: float, audit: bool) -> bool:
    """Try one step from the state in `work`; return whether Newton's method converged in every stage.

    Fills q_new, v_new, a_new, the error estimates and, if `audit`, the powers. `tolerance` in N is Newton's.
    """
    if not work.ready[level]:
        _prepare_level(system, work, level, IMPLICIT_DIAGONAL)
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
    subtract_resistance_by_runs(sparse, q, v, work.external)
    _accelerate(system, work, level, linear)
    for i in range(size):
        v[i] += span * linear[i]
        q[i] += span * span * linear[i]
        work.external[i] = 0.0  # it has done its part
    add_motion(system, q, v, work.free_position, work.free, work.free_rate)
    if has_unbalance(system.elements):
        set_acceleration(system, work.motion, linear, work.free_acceleration)
    _hold_linear(system, work, level, span)
    iterations = _solve_local_forces(system, work, level, span, tolerance, stage == 1)
    _apply_linear(work)
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
        acceleration[i] = run_product(system.sparse.coupling_runs, inverse, i, work.external)
    first = np.uint64(system.sparse.modal.first)
    entry = np.uint64(coupling.first[first])
    for i in range(np.uint64(system.sparse.modal.damping.size)):
        acceleration[first + i] = inverse[entry + i] * work.external[first + i]
