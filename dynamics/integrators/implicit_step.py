"""Compiled step of the L-stable, singly diagonally implicit method of order 4.

A *level* is the index of a step size, for which matrices are factorized once. Force elements have *local*
coordinates and forces f; Newton's method solves for these alone. The *free* motion of a stage is that without
local forces, which the linear equations give. *Modal* freedoms have diagonal matrices.
"""

from __future__ import annotations

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.modal_freedoms import subtract_modal_forces
from dynamics.arrays.sparse_rows import run_product, subtract_columns, subtract_resistance_by_runs
from dynamics.forces.elements import has_unbalance
from dynamics.integrators.instant_powers import write_powers
from dynamics.integrators.linear_elimination import apply_linear, hold_linear
from dynamics.integrators.local_newton import solve_local_forces
from dynamics.integrators.stage_parts import add_stages, finish_step, set_motion
from dynamics.integrators.stage_preparation import prepare_level
from dynamics.integrators.tableaus import (
    IMPLICIT_DIAGONAL,
    IMPLICIT_EMBEDDED,
    IMPLICIT_NODES,
    IMPLICIT_STAGES,
    IMPLICIT_WEIGHTS,
)
from dynamics.integrators.workspace import Count, Workspace
from dynamics.kernels.compiled import inner
from dynamics.kernels.routine import routine
from dynamics.motion.local_accelerations import set_acceleration
from dynamics.motion.motion import add_motion
from dynamics.types import FloatArray

STAGE_COUNT = 6  # stages of the method, the first explicit


@routine
def implicit_step(system: SystemArrays, work: Workspace, level: int, tolerance: float, audit: bool) -> bool:
    """Try one step from the state in `work`; return whether Newton's method converged in every stage.

    Writes q_new, v_new, a_new, the error estimates and, if `audit`, the powers. Newton's method iterates to
    `tolerance`, N.
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
        work.counts[Count.MAX_NEWTON] = max(work.counts[Count.MAX_NEWTON], iterations)
        if audit and (IMPLICIT_WEIGHTS[stage] != 0.0 or stage == STAGE_COUNT - 1):
            write_powers(system, work, stage, work.time[0] + IMPLICIT_NODES[stage] * step)
    for i in range(work.q.size):
        work.v_new[i], work.a_new[i] = work.stage_v[STAGE_COUNT - 1, i], work.stage_a[STAGE_COUNT - 1, i]
    finish_step(work, step, IMPLICIT_WEIGHTS, IMPLICIT_EMBEDDED)
    return True


@routine
def solve_stage(system: SystemArrays, work: Workspace, level: int, stage: int, tolerance: float) -> int:
    """Solve one stage for its acceleration a; return the iterations of Newton's method, < 0 if it failed.

    With s = diagonal * step the stage has v = v* + s a and q = q* + s v* + s^2 a, where v* and q* are the
    contributions of earlier stages, and (M + s C + s^2 K) a = external - C v* - K (q* + s v*) - G^T f.
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
        work.external[i] = 0.0  # from here on it takes the local forces alone
    add_motion(system, q, v, work.free_position, work.free, work.free_rate)
    if has_unbalance(system.elements):
        set_acceleration(system, work.motion, linear, work.free_acceleration)
    hold_linear(system, work, level, span)
    iterations = solve_local_forces(system, work, level, span, tolerance, stage == 1)
    apply_linear(work)
    subtract_columns(sparse.bodies, work.force, work.external)
    subtract_modal_forces(sparse.modal, work.force, work.external)
    by_local_forces = work.stage_a[stage]
    _accelerate(system, work, level, by_local_forces)
    for i in range(size):
        q[i] += span * span * by_local_forces[i]
        v[i] += span * by_local_forces[i]
        work.stage_a[stage, i], work.stage_v[stage, i] = linear[i] + by_local_forces[i], v[i]
    return iterations


@inner
def _accelerate(system: SystemArrays, work: Workspace, level: int, acceleration: FloatArray) -> None:
    """Write the accelerations by the forces in ``work.external``; those of modal freedoms are uncoupled."""
    coupling, inverse = system.sparse.coupling, work.inverse[level]
    for i in range(system.sparse.modal.first):
        acceleration[i] = run_product(system.sparse.coupling_runs, inverse, i, work.external)
    first = np.uint64(system.sparse.modal.first)
    entry = np.uint64(coupling.first[first])
    for i in range(np.uint64(system.sparse.modal.damping.size)):
        acceleration[first + i] = inverse[entry + i] * work.external[first + i]
