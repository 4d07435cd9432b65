"""Compiled time stepping: steps, error control, output on a uniform grid."""

from __future__ import annotations

import math

from dynamics.forces.compiled import compiled, inner
from dynamics.integrators.explicit_step import accelerate, explicit_step
from dynamics.integrators.implicit_step import implicit_step, solve_stage
from dynamics.integrators.law_knots import next_jump, step_to_jump
from dynamics.integrators.powers import add_drive_work, write_powers
from dynamics.integrators.step_control import Control, next_rung, slow_enough, step_error
from dynamics.integrators.table_work import add_table_work, keep_motion
from dynamics.integrators.tableaus import EXPLICIT_WEIGHTS, IMPLICIT_WEIGHTS
from dynamics.integrators.workspace import Count, Workspace
from dynamics.system.arrays import SystemArrays
from dynamics.system.motion import move_free_trains
from dynamics.types import FloatArray, IntArray, RunStatus

COMPLETED, STEP_FLOOR = int(RunStatus.COMPLETED), int(RunStatus.STEP_FLOOR)
STEP_LIMIT, NOT_FINITE = int(RunStatus.STEP_LIMIT), int(RunStatus.NOT_FINITE)
UNSOLVED = 1e10  # stands for the error of a step in which Newton's method failed
DIVERGED = 1.0  # m


def prepare_steps(system: SystemArrays, work: Workspace, implicit: bool, audit: bool) -> None:
    """Compile the method that a run takes, and the powers if it audits them."""
    method = (implicit_step, solve_stage) if implicit else (explicit_step,)
    for routine in (accelerate, *method, *((write_powers, add_table_work) if audit else ())):
        routine.prepare(system, work)


@compiled
def advance(
    system: SystemArrays,
    work: Workspace,
    control: Control,
    stop: float,
    sample_rate: float,
    q_out: FloatArray,
    v_out: FloatArray,
    moved_out: IntArray,
) -> int:
    """Step until the time passes `stop` and return a `RunStatus`.

    The output samples at k / sample_rate go into the rows k - count[FIRST_ROW] of `q_out`, `v_out` and
    `moved_out`. Steps never end at `stop` on purpose: cutting a run into chunks changes no bit of it.
    """
    if work.counts[Count.ACCEPTED] == 0:
        _start(system, work, control, q_out, v_out, moved_out)
    while work.time[0] < stop:
        count = work.counts
        if count[Count.ACCEPTED] + count[Count.REJECTED] >= control.step_limit:
            return STEP_LIMIT
        rung, jump = count[Count.RUNG], math.inf
        if control.adaptive:
            rung = slow_enough(system, work, rung)
            count[Count.RUNG] = rung
            jump = next_jump(system.reference.speed, work.time[0])
            rung = step_to_jump(system, work, rung, jump)
        landing = rung == work.ladder.size - 2
        if control.implicit:
            solved = implicit_step(system, work, rung, control.force_tolerance, control.audit)
        else:
            solved = explicit_step(system, work, rung, control.audit)
        error = step_error(system, work) / control.tolerance if solved else UNSOLVED
        diverged = solved and error * control.tolerance >= DIVERGED
        accepted = error <= 1.0 or (not control.adaptive and solved and not diverged)
        if control.adaptive and not (landing and accepted):
            count[Count.RUNG] = next_rung(work, control, error, accepted)
        if accepted:
            end = jump if landing else work.time[0] + (work.ladder[rung] + work.time_rest[0])
            _accept(system, work, control, rung, end, sample_rate, q_out, v_out, moved_out)
            move_free_trains(system.reference, work.moved, work.q)
            if landing:
                _enter(system, work, control)
            else:
                work.error[0] = max(error, 1e-4)
            continue
        count[Count.REJECTED] += 1
        count[Count.NEWTON_FAILED] += 0 if solved else 1
        below_the_ladder = count[Count.RUNG] > work.ladder.size - 3
        if below_the_ladder or not control.adaptive:
            return NOT_FINITE if diverged else STEP_FLOOR
    return COMPLETED


@inner
def _start(
    system: SystemArrays,
    work: Workspace,
    control: Control,
    q_out: FloatArray,
    v_out: FloatArray,
    moved_out: IntArray,
) -> None:
    """Evaluate the state at t = 0, and store sample 0."""
    _enter(system, work, control)
    for i in range(work.q.size):
        q_out[0, i], v_out[0, i] = work.q[i], work.v[i]
    for k in range(work.moved.size):
        moved_out[0, k] = work.moved[k]
    work.counts[Count.OUTPUT] = 1


@inner
def _enter(system: SystemArrays, work: Workspace, control: Control) -> None:
    """Evaluate accelerations and powers of the state as the start of a step."""
    for i in range(work.q.size):
        work.q_new[i], work.v_new[i], work.stage_v[0, i] = work.q[i], work.v[i], work.v[i]
    accelerate(system, work, work.time[0], 0)
    for i in range(work.q.size):
        work.a[i] = work.stage_a[0, i]
    if control.audit:
        write_powers(system, work, 0, work.time[0])
        keep_motion(system, work, work.before)


@inner
def _accept(
    system: SystemArrays,
    work: Workspace,
    control: Control,
    rung: int,
    end: float,
    sample_rate: float,
    q_out: FloatArray,
    v_out: FloatArray,
    moved_out: IntArray,
) -> None:
    """Store the samples inside the step, add its works, and make its end the new state."""
    step = work.ladder[rung]
    sample, first = work.counts[Count.OUTPUT], work.counts[Count.FIRST_ROW]
    while sample - first < q_out.shape[0] and sample / sample_rate <= end:
        row = sample - first
        _interpolate(work, step, sample / sample_rate - work.time[0], q_out[row], v_out[row])
        for k in range(work.moved.size):
            moved_out[row, k] = work.moved[k]
        sample += 1
    work.counts[Count.OUTPUT] = sample
    if control.audit:
        _add_works(work, control.implicit, step)
        add_drive_work(system, work)
        add_table_work(system, work, step)
    _move_on(work, control.implicit, step, end)
    work.counts[Count.ACCEPTED] += 1
    if rung < work.ladder.size - 2:
        work.counts[Count.SMALLEST_RUNG] = min(work.counts[Count.SMALLEST_RUNG], rung)
        work.counts[Count.LARGEST_RUNG] = max(work.counts[Count.LARGEST_RUNG], rung)


@inner
def _move_on(work: Workspace, implicit: bool, step: float, end: float) -> None:
    """Make the end of the step the state; what rounding leaves of time and rates is kept for the next step.

    Else ten million steps would add up ten million roundings of the time and of a free train's speed.
    """
    weights = IMPLICIT_WEIGHTS if implicit else EXPLICIT_WEIGHTS
    for i in range(work.q.size):
        gained = 0.0
        for stage in range(weights.size):
            gained += weights[stage] * work.stage_a[stage, i]
        gained = step * gained + work.v_rest[i]
        rate = work.v[i] + gained
        work.v_rest[i] = gained - (rate - work.v[i])
        work.q[i], work.v[i], work.a[i] = work.q_new[i], rate, work.a_new[i]
    work.time_rest[0] = step + work.time_rest[0] - (end - work.time[0])
    work.time[0] = end


@inner
def _interpolate(work: Workspace, step: float, elapsed: float, q: FloatArray, v: FloatArray) -> None:
    """Cubic Hermite interpolation of displacements (with rates) and of rates (with accelerations)."""
    u = elapsed / step
    end = u * u * (3.0 - 2.0 * u)
    first, last = step * u * (1.0 - u) ** 2, -step * u * u * (1.0 - u)
    for i in range(q.size):
        q[i] = work.q[i] + end * (work.q_new[i] - work.q[i]) + first * work.v[i] + last * work.v_new[i]
        v[i] = work.v[i] + end * (work.v_new[i] - work.v[i]) + first * work.a[i] + last * work.a_new[i]


@inner
def _add_works(work: Workspace, implicit: bool, step: float) -> None:
    """Integrate the powers with the method's own weights; the last stage is the next step's first."""
    weights = IMPLICIT_WEIGHTS if implicit else EXPLICIT_WEIGHTS
    last = weights.size - 1
    for column in range(work.work.size):
        for stage in range(weights.size):
            work.work[column] += step * weights[stage] * work.power[stage, column]
        work.power[0, column] = work.power[last, column]
