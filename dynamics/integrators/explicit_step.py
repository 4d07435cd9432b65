"""Compiled step of the explicit Dormand-Prince method of order 5: the check of the implicit one."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.element_laws import evaluate
from dynamics.forces.routine import routine
from dynamics.integrators.powers import write_powers
from dynamics.integrators.stage import finish_step, set_motion
from dynamics.integrators.step_level import prepare_level, row_product
from dynamics.integrators.tableaus import (
    EXPLICIT_EMBEDDED,
    EXPLICIT_NODES,
    EXPLICIT_STAGES,
    EXPLICIT_WEIGHTS,
)
from dynamics.integrators.workspace import Workspace
from dynamics.motion.motion import add_motion

STAGE_COUNT = 7


@routine
def explicit_step(system: SystemArrays, work: Workspace, level: int, audit: bool) -> bool:
    """Try one step from the state in `work`; fill what `implicit_step` fills; return True."""
    step, size = work.step_sizes[level], work.q.size
    for i in range(size):
        work.stage_v[0, i], work.stage_a[0, i] = work.v[i], work.a[i]
    for stage in range(1, STAGE_COUNT):
        for i in range(size):
            displacement, rate = 0.0, 0.0
            for s in range(stage):
                displacement += EXPLICIT_STAGES[stage, s] * work.stage_v[s, i]
                rate += EXPLICIT_STAGES[stage, s] * work.stage_a[s, i]
            work.q_new[i] = work.q[i] + step * displacement
            work.v_new[i] = work.v[i] + step * rate
            work.stage_v[stage, i] = work.v_new[i]
        time = work.time[0] + EXPLICIT_NODES[stage] * step
        accelerate(system, work, time, stage)
        if audit:
            write_powers(system, work, stage, time)
    for i in range(size):
        work.a_new[i] = work.stage_a[STAGE_COUNT - 1, i]
    finish_step(work, step, EXPLICIT_WEIGHTS, EXPLICIT_EMBEDDED)
    return True


@routine
def accelerate(system: SystemArrays, work: Workspace, time: float, stage: int) -> None:
    """Write the accelerations in the state ``q_new``, ``v_new`` at `time` into row `stage` of ``stage_a``.

    The local state goes into `work`. The last level's step is 0, so its matrix is M alone.
    """
    q, v, acceleration = work.q_new, work.v_new, work.stage_a[stage]
    level = work.step_sizes.size - 1
    if not work.ready[level]:
        prepare_level(system, work, level, 0.0)
    local = work.local
    set_motion(system, work, time, local.position)
    add_motion(system, q, v, local.position, local.coordinate, local.rate)
    for i in range(q.size):
        work.external[i] -= row_product(system.damping, system.block, v, i)
        work.external[i] -= row_product(system.stiffness, system.block, q, i)
    for i in range(q.size):
        acceleration[i] = row_product(work.inverse[level], system.block, work.external, i)
    for e in range(system.elements.law.size):
        evaluate(system.elements, local, e)
    for r in range(work.force.size):
        work.force[r] = local.force[r]
        for i in range(system.reach[r, 0], system.reach[r, 1]):
            acceleration[i] -= work.response[level, r, i] * work.force[r]
