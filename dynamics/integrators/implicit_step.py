"""Compiled step of the L-stable, singly diagonally implicit method of order 4."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.compiled import inner
from dynamics.forces.routine import routine
from dynamics.integrators.local_newton import solve_local_forces
from dynamics.integrators.powers import write_powers
from dynamics.integrators.stage import finish_step, set_motion
from dynamics.integrators.step_level import prepare_level, row_product
from dynamics.integrators.tableaus import (
    IMPLICIT_DIAGONAL,
    IMPLICIT_EMBEDDED,
    IMPLICIT_NODES,
    IMPLICIT_STAGES,
    IMPLICIT_WEIGHTS,
)
from dynamics.integrators.workspace import Count, Workspace
from dynamics.motion.motion import add_motion

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
        if audit:
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
        displacement, rate = 0.0, 0.0
        for s in range(stage):
            displacement += IMPLICIT_STAGES[stage, s] * work.stage_v[s, i]
            rate += IMPLICIT_STAGES[stage, s] * work.stage_a[s, i]
        v[i] = work.v[i] + step * rate
        q[i] = work.q[i] + step * displacement + span * v[i]
    for i in range(size):
        work.external[i] -= row_product(system.damping, system.block, v, i)
        work.external[i] -= row_product(system.stiffness, system.block, q, i)
    for i in range(size):
        work.linear[i] = row_product(work.inverse[level], system.block, work.external, i)
    for i in range(size):
        v[i] += span * work.linear[i]
        q[i] += span * span * work.linear[i]
    add_motion(system, q, v, work.free_position, work.free, work.free_rate)
    iterations = solve_local_forces(system, work, level, span, tolerance)
    add_local_forces(system, work, level, stage, span)
    return iterations


@inner
def add_local_forces(system: SystemArrays, work: Workspace, level: int, stage: int, span: float) -> None:
    """Let the forces found push the freedoms within their reach; fill the stage's rates and accelerations."""
    pushed = work.external  # it has done its part in this stage
    for i in range(pushed.size):
        pushed[i] = 0.0
    for r in range(work.force.size):
        for i in range(system.reach[r, 0], system.reach[r, 1]):
            pushed[i] += work.response[level, r, i] * work.force[r]
    for i in range(pushed.size):
        work.stage_a[stage, i] = work.linear[i] - pushed[i]
        work.v_new[i] -= span * pushed[i]
        work.q_new[i] -= span * span * pushed[i]
        work.stage_v[stage, i] = work.v_new[i]
