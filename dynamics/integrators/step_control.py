"""Compiled control of the step level."""

from __future__ import annotations

import math
from typing import NamedTuple

from dynamics.arrays.arrays import SystemArrays
from dynamics.integrators.workspace import LEVELS_PER_OCTAVE, Count, Workspace
from dynamics.kernels.compiled import inner
from dynamics.motion.motion import law_speed, write_motion

SAFETY = math.log2(0.9)  # octaves of the step size, like the limits of its change
RISE_LIMIT = math.log2(2.0)
FALL_LIMIT = math.log2(0.2)
POSITION_LIMIT = 1.0 / 64.0  # base pitches


class Control(NamedTuple):
    """Settings of the step size control.

    Attributes
    ----------
    implicit : bool
        Which method.
    adaptive : bool
        False: every step is accepted, and all have the size of the level at the start.
    audit : bool
        Whether to integrate the powers.
    order : int
        Of the embedded error estimate.
    tolerance : float
        Error allowed per step, m.
    force_tolerance : float
        Last update allowed in Newton's method, N.
    step_limit : int
    """

    implicit: bool
    adaptive: bool
    audit: bool
    order: int
    tolerance: float
    force_tolerance: float
    step_limit: int


@inner
def step_error(system: SystemArrays, work: Workspace) -> float:
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
def slow_enough(system: SystemArrays, work: Workspace, level: int) -> int:
    """Return the first level, `level` or later, in whose step no mesh moves by more than POSITION_LIMIT.

    An error estimate knows the table only where the stages look; a step over half a pitch could miss a
    handover.
    """
    reference = system.reference
    write_motion(reference, work.time[0], work.moved, work.motion)
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
