"""Compiled time stepping: steps, error control, samples.

A level is one of the geometric step sizes of a `Workspace`. The error of a step is that of its embedded
estimate, over the tolerance.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from dynamics.arrays.arrays import SystemArrays
from dynamics.integrators.explicit_step import accelerate, explicit_step
from dynamics.integrators.implicit_step import implicit_step, solve_stage
from dynamics.integrators.instant_powers import add_drive_work, write_powers
from dynamics.integrators.sampler import Sampler, SampleRing, move_sampled_trains, sample_step, store_if_due
from dynamics.integrators.speed_jump import next_jump, step_to_jump
from dynamics.integrators.tableaus import EXPLICIT_WEIGHTS, IMPLICIT_WEIGHTS
from dynamics.integrators.workspace import LEVELS_PER_OCTAVE, LOSSES, Count, Workspace
from dynamics.kernels.compiled import compiled, inner
from dynamics.motion.motion import SPEED, law_speed, write_motion
from dynamics.motion.sampled_states import States
from dynamics.types import RunStatus

SAFETY = math.log2(0.9)  # octaves of the step size, like the limits of its change
RISE_LIMIT = math.log2(2.0)
FALL_LIMIT = math.log2(0.2)
POSITION_LIMIT = 1.0 / 64.0  # base pitches
COMPLETED, STEP_FLOOR = int(RunStatus.COMPLETED), int(RunStatus.STEP_FLOOR)
STEP_LIMIT, NOT_FINITE = int(RunStatus.STEP_LIMIT), int(RunStatus.NOT_FINITE)
UNSOLVED = 1e10  # the error of a step in which Newton's method failed
DIVERGED = 1.0  # m
AT_REST = 1e-100
"""Motion below which a freedom is at rest, SI: its squares do not underflow yet."""


class Control(NamedTuple):
    """Settings of the step size control."""

    implicit: bool
    """Whether the steps are implicit; False: explicit."""
    adaptive: bool
    """False: every step is accepted, and all have the size of the level at the start."""
    audit: bool
    """Whether to integrate the powers."""
    order: int
    """Order of the embedded error estimate."""
    tolerance: float
    """Error allowed per step, m."""
    force_tolerance: float
    """Largest force that Newton's method may leave unbalanced, N; 0: rounding alone."""
    step_limit: int


@inner
def _step_error(system: SystemArrays, work: Workspace) -> float:
    """Return the largest error estimate of any freedom over one step, in meters; NaN counts as infinite.

    An error of the rate counts as what it makes of the displacement: where a force jumps, steps get so short
    that their displacements are right long before the impulse is.
    """
    error = 0.0
    for i in range(work.q.size):
        error = max(
            error, system.scale[i] * abs(work.q_error[i]), system.rate_scale[i] * abs(work.v_error[i])
        )
        if not math.isfinite(work.q_error[i]) or not math.isfinite(work.v_error[i]):
            return math.inf
    return error


@inner
def _slow_enough(system: SystemArrays, work: Workspace, level: int) -> int:
    """Return the first level, `level` or later, in whose step no mesh moves by more than POSITION_LIMIT.

    An error estimate knows the table only where the stages look; a step over half a pitch could miss a
    handover.
    """
    reference = system.reference
    write_motion(reference, work.time[0], work.quanta, work.motion)
    rate = 0.0
    for m in range(reference.per_radian.shape[0]):
        moving = 0.0
        for k in range(work.motion.shape[0]):
            moving += reference.per_radian[m, k] * law_speed(reference, k, work.motion, work.v)
        rate = max(rate, abs(moving))
    while rate * work.step_sizes[level] > POSITION_LIMIT and level < work.step_sizes.size - 2:
        level += 1
    return level


@inner
def next_level(work: Workspace, control: Control, error: float, accepted: bool) -> int:
    """Return the level of the next step from this step's error over the tolerance.

    Proportional-integral control (Gustafsson): the factor depends on the last accepted error too, so that the
    step size does not oscillate where the solution is stiff. A rejected step falls by at least one level, and
    no accepted one rises by less than a whole level, so the step stays put unless it pays. After an accepted
    step the level has a step size; after a rejected one it may be the one below, which has none.
    """
    exponent, log_error = 1.0 / (control.order + 1), math.log2(max(error, 1e-10))
    octaves = SAFETY - 0.7 * exponent * log_error + 0.4 * exponent * math.log2(work.error[0])
    if not accepted:
        octaves = min(SAFETY - exponent * log_error, 0.0)
    rise = math.floor(LEVELS_PER_OCTAVE * min(max(octaves, FALL_LIMIT), RISE_LIMIT))
    level = work.counts[Count.LEVEL] - int(rise)
    smallest = work.step_sizes.size - 2
    if not accepted:
        level = max(level, work.counts[Count.LEVEL] + 1)
        smallest += 1  # below the smallest: the caller ends there
    return int(min(max(level, 0), smallest))


def prepare_steps(system: SystemArrays, work: Workspace, implicit: bool, audit: bool) -> None:
    """Compile the method that a run takes, and the powers if it audits them."""
    method = (implicit_step, solve_stage) if implicit else (explicit_step,)
    for part in (accelerate, *method, *((write_powers,) if audit else ())):
        part.prepare(system, work)


def prepare_samples(
    system: SystemArrays, work: Workspace, sampler: Sampler, ring: SampleRing, out: States
) -> None:
    """Compile the routines that sample the steps."""
    store_if_due.prepare(work, sampler, ring, out)
    sample_step.prepare(system, work, sampler, ring, out)


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
        sample_step(system, work, sampler, ring, 1.0, work.time[0], out)
    while work.time[0] < stop:
        count = work.counts
        if count[Count.ACCEPTED] + count[Count.REJECTED] >= control.step_limit:
            return STEP_LIMIT
        level, jump = count[Count.LEVEL], math.inf
        if control.adaptive:
            level = _slow_enough(system, work, level)
            count[Count.LEVEL] = level
            jump = next_jump(system.reference.speed, work.time[0])
            level = step_to_jump(system, work, level, jump)
        landing = level == work.step_sizes.size - 1
        if control.implicit:
            solved = implicit_step(system, work, level, control.force_tolerance, control.audit)
        else:
            solved = explicit_step(system, work, level, control.audit)
        error = _step_error(system, work) / control.tolerance if solved else UNSOLVED
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
        for k in range(work.speed.size):
            work.speed[k] = work.motion[k, SPEED]


@inner
def _accept(system: SystemArrays, work: Workspace, control: Control, level: int, end: float) -> None:
    """Add the step's works, and make its end the new state."""
    step = work.step_sizes[level]
    if control.audit:
        _add_works(work, control.implicit, step)
        add_drive_work(system, work)
        _watch_losses(work)
    _move_on(work, control.implicit, step, end)
    work.counts[Count.ACCEPTED] += 1
    if level < work.step_sizes.size - 1:
        work.counts[Count.SMALLEST_LEVEL] = min(work.counts[Count.SMALLEST_LEVEL], level)
        work.counts[Count.LARGEST_LEVEL] = max(work.counts[Count.LARGEST_LEVEL], level)


@inner
def _move_on(work: Workspace, implicit: bool, step: float, end: float) -> None:
    """Make the end of the step the state; the rounding of time and rates goes into the next step.

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
        increment = step * mean[i] + work.v_rest[i]
        rate = work.v[i] + increment
        work.v_rest[i] = increment - (rate - work.v[i])
        work.q[i], work.v[i], work.a[i] = work.q_new[i], rate, work.a_new[i]
        if abs(work.q[i]) < AT_REST and abs(rate) < AT_REST and abs(work.a[i]) < AT_REST:
            work.q[i] = work.v[i] = work.a[i] = work.v_rest[i] = 0.0
    work.time_rest[0] = step + work.time_rest[0] - (end - work.time[0])
    work.time[0] = end


@inner
def _watch_losses(work: Workspace) -> None:
    """Update the highest value of each loss, and its largest fall below it."""
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
