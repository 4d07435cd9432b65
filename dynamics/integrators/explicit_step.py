"""Compiled steps of an explicit method; with an energy audit they write the powers at their stages."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import row_product, subtract_columns, subtract_resistance
from dynamics.forces.elements import evaluate_all, has_unbalance
from dynamics.integrators.instant_powers import write_powers
from dynamics.integrators.stage_parts import add_stages, finish_step, set_motion
from dynamics.integrators.tableaus import EXPLICIT_EMBEDDED, EXPLICIT_NODES, EXPLICIT_STAGES, EXPLICIT_WEIGHTS
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.routine import routine
from dynamics.motion.local_accelerations import settle_unbalance
from dynamics.motion.motion import add_motion

STAGE_COUNT = 7  # stages of the method, the last at the end of the step


@routine
def explicit_step(system: SystemArrays, work: Workspace, level: int, audit: bool) -> bool:
    """Try one step of the size number `level` from the state in `work`; return True: it needs no iteration.

    It fills the fields of `work` that `implicit_step` fills.
    """
    step, size = work.step_sizes[level], work.q.size
    for i in range(size):
        work.stage_v[0, i], work.stage_a[0, i] = work.v[i], work.a[i]
    for stage in range(1, STAGE_COUNT):
        for i in range(size):
            work.q_new[i], work.v_new[i] = work.q[i], work.v[i]
        add_stages(EXPLICIT_STAGES, stage, step, work.stage_v, work.q_new)
        add_stages(EXPLICIT_STAGES, stage, step, work.stage_a, work.v_new)
        for i in range(size):
            work.stage_v[stage, i] = work.v_new[i]
        time = work.time[0] + EXPLICIT_NODES[stage] * step
        accelerate(system, work, time, stage)
        if audit and (EXPLICIT_WEIGHTS[stage] != 0.0 or stage == STAGE_COUNT - 1):
            write_powers(system, work, stage, time)
    for i in range(size):
        work.a_new[i] = work.stage_a[STAGE_COUNT - 1, i]
    finish_step(work, step, EXPLICIT_WEIGHTS, EXPLICIT_EMBEDDED)
    return True


@routine
def accelerate(system: SystemArrays, work: Workspace, time: float, stage: int) -> None:
    """Write the accelerations in the state ``q_new``, ``v_new`` at `time` into row `stage` of ``stage_a``.

    The local state goes into `work`.
    """
    q, v, acceleration = work.q_new, work.v_new, work.stage_a[stage]
    local, sparse = work.local, system.sparse
    set_motion(system, work, time, local.position)
    add_motion(system, q, v, local.position, local.coordinate, local.rate)
    evaluate_all(system.elements, local)
    for r in range(work.force.size):
        work.force[r] = local.force[r]
    subtract_columns(sparse.direction, work.force, work.external)
    subtract_resistance(sparse, q, v, work.external)
    for i in range(q.size):
        acceleration[i] = row_product(sparse.mobility, sparse.mobility.weight, i, work.external)
    if has_unbalance(system.elements):
        settle_unbalance(system, work.motion, local, work.external, acceleration)
        for r in range(work.force.size):
            work.force[r] = local.force[r]
