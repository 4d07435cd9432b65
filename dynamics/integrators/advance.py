"""Compiled time stepping: steps, error control, samples."""

from __future__ import annotations

import math

from dynamics.arrays.arrays import SystemArrays
from dynamics.forces.compiled import compiled, inner
from dynamics.integrators.explicit_step import accelerate, explicit_step
from dynamics.integrators.implicit_step import implicit_step, solve_stage
from dynamics.integrators.law_knots import next_jump, step_to_jump
from dynamics.integrators.powers import add_drive_work, write_powers
from dynamics.integrators.sample_ring import Sampler, SampleRing
from dynamics.integrators.sampler import move_sampled_trains, sample_start, sample_step
from dynamics.integrators.step_control import Control, next_level, slow_enough, step_error
from dynamics.integrators.table_work import add_table_work, keep_motion
from dynamics.integrators.tableaus import EXPLICIT_WEIGHTS, IMPLICIT_WEIGHTS
from dynamics.integrators.workspace import LOSSES, Count, Workspace
from dynamics.motion.sampled_states import States
from dynamics.types import RunStatus

COMPLETED, STEP_FLOOR = int(RunStatus.COMPLETED), int(RunStatus.STEP_FLOOR)
STEP_LIMIT, NOT_FINITE = int(RunStatus.STEP_LIMIT), int(RunStatus.NOT_FINITE)
UNSOLVED = 1e10  # the error of a step in which Newton's method failed
DIVERGED = 1.0  # m

AT_REST = 1e-100
"""Motion below which a freedom is at rest, SI: its squares do not underflow yet."""


def prepare_steps(system: SystemArrays, work: Workspace, implicit: bool, audit: bool) -> None:
    """Compile the method that a run takes, and the powers if it audits them."""
    method = (implicit_step, solve_stage) if implicit else (explicit_step,)
    for routine in (accelerate, *method, *((write_powers, add_table_work) if audit else ())):
        routine.prepare(system, work)


def prepare_samples(
    system: SystemArrays, work: Workspace, sampler: Sampler, ring: SampleRing, out: States
) -> None:
    """Compile what samples the steps."""
    for routine in (sample_start, sample_step):
        routine.prepare(system, work, sampler, ring, out)


@compiled
def advance(
    system: SystemArrays,
    work: Workspace,
    control: Control,
    sampler: Sampler,
    ring: SampleRing,
    stop: float,
    out: States,
) -> int:
    """Step until the time passes `stop` and return a `RunStatus`.

    The output sample k goes into the row k - count[FIRST_ROW] of `out`, half a filter after its time. Steps
    never end at `stop` on purpose: cutting a run into chunks changes no bit of it.
    """
    if work.counts[Count.ACCEPTED] == 0:
        _enter(system, work, control)
        sample_start(system, work, sampler, ring, out)
    while work.time[0] < stop:
        count = work.counts
        if count[Count.ACCEPTED] + count[Count.REJECTED] >= control.step_limit:
            return STEP_LIMIT
        level, jump = count[Count.LEVEL], math.inf
        if control.adaptive:
            level = slow_enough(system, work, level)
            count[Count.LEVEL] = level
            jump = next_jump(system.reference.speed, work.time[0])
            level = step_to_jump(system, work, level, jump)
        landing = level == work.step_sizes.size - 1
        if control.implicit:
            solved = implicit_step(system, work, level, control.force_tolerance, control.audit)
        else:
            solved = explicit_step(system, work, level, control.audit)
        error = step_error(system, work) / control.tolerance if solved else UNSOLVED
        diverged = solved and error * control.tolerance >= DIVERGED
        accepted = error <= 1.0 or (not control.adaptive and solved and not diverged)
        if control.adaptive and not (landing and accepted):
            count[Count.LEVEL] = next_level(work, control, error, accepted)
        if accepted:
            end = jump if landing else work.time[0] + (work.step_sizes[level] + work.time_rest[0])
            sample_step(system, work, sampler, ring, work.step_sizes[level], end, out)
            _accept(system, work, control, level, end)
            move_sampled_trains(system, work, ring)
            if landing:
                _enter(system, work, control)
            else:
                work.error[0] = max(error, 1e-4)
            continue
        count[Count.REJECTED] += 1
        count[Count.NEWTON_FAILED] += 0 if solved else 1
        below_smallest = count[Count.LEVEL] > work.step_sizes.size - 2
        if below_smallest or not control.adaptive:
            return NOT_FINITE if diverged else STEP_FLOOR
    return COMPLETED


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
def _accept(system: SystemArrays, work: Workspace, control: Control, level: int, end: float) -> None:
    """Add the step's works, and make its end the new state."""
    step = work.step_sizes[level]
    if control.audit:
        _add_works(work, control.implicit, step)
        add_drive_work(system, work)
        add_table_work(system, work, step)
        _watch_losses(work)
    _move_on(work, control.implicit, step, end)
    work.counts[Count.ACCEPTED] += 1
    if level < work.step_sizes.size - 1:
        work.counts[Count.SMALLEST_LEVEL] = min(work.counts[Count.SMALLEST_LEVEL], level)
        work.counts[Count.LARGEST_LEVEL] = max(work.counts[Count.LARGEST_LEVEL], level)


@inner
def _move_on(work: Workspace, implicit: bool, step: float, end: float) -> None:
    """Make the end of the step the state; what rounding leaves of time and rates is kept for the next step.

    Else ten million steps would add up ten million roundings of the time and of a free train's speed.
    A motion that has died away is at rest: processors take a hundred times as long for numbers that
    underflow.
    """
    weights, mean = IMPLICIT_WEIGHTS if implicit else EXPLICIT_WEIGHTS, work.external
    for i in range(mean.size):
        mean[i] = 0.0
    for stage in range(weights.size):
        for i in range(mean.size):
            mean[i] += weights[stage] * work.stage_a[stage, i]
    for i in range(work.q.size):
        gained = step * mean[i] + work.v_rest[i]
        rate = work.v[i] + gained
        work.v_rest[i] = gained - (rate - work.v[i])
        work.q[i], work.v[i], work.a[i] = work.q_new[i], rate, work.a_new[i]
        if abs(work.q[i]) < AT_REST and abs(rate) < AT_REST and abs(work.a[i]) < AT_REST:
            work.q[i] = work.v[i] = work.a[i] = work.v_rest[i] = 0.0
    work.time_rest[0] = step + work.time_rest[0] - (end - work.time[0])
    work.time[0] = end


@inner
def _watch_losses(work: Workspace) -> None:
    """Keep the highest value of each loss, and how far it fell below it."""
    for k in range(work.highest.size):
        value = work.work[LOSSES[k]]
        work.highest[k] = max(work.highest[k], value)
        work.fallen[k] = max(work.fallen[k], work.highest[k] - value)


@inner
def _add_works(work: Workspace, implicit: bool, step: float) -> None:
    """Integrate the powers with the method's own weights; the last stage is the next step's first."""
    weights = IMPLICIT_WEIGHTS if implicit else EXPLICIT_WEIGHTS
    last = weights.size - 1
    for column in range(work.work.size):
        for stage in range(weights.size):
            work.work[column] += step * weights[stage] * work.power[stage, column]
        work.power[0, column] = work.power[last, column]
