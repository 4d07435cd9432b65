"""What steady states over speed will cost: the periods that are integrated, counted, times steps measured."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.linearize import natural_modes
from dynamics.linearize.operating_speeds import leading_law
from dynamics.periodic.continuation import LARGEST_STEP, MOST_POINTS
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap, periodic_problem
from dynamics.periodic.shooting import RESIDUAL_LIMIT, SETTLING, settled
from dynamics.types import FloatArray
from host import cpu_seconds

ENOUGH, LEAST_STEPS, TIMES = 0.01, 16, 3
"""CPU s and steps of a stretch that tells, and how often it is taken: the quickest counts, as other work on
the machine only slows it. All stretches of a probe take at most six times as long, where steps are cheap."""
PROBED, AFFORDED = 9, 0.5
"""Speeds at which motions settle, and CPU s that this may take: where it takes more, no flank lifts off."""
CHANGE = 5e-3
"""Of the size of a state: what a period changes of it after a step of a sweep, 2e-3 to 1e-2."""
BRANCH_ITERATIONS = 2
"""Newton iterations of a point of a branch: on average 1 to 2.7."""


@dataclass(frozen=True)
class SteadyCost:
    """Motions of both sweeps and points of the branch: how many, and CPU seconds of each.

    `pitches` are those of each mesh in a period of a motion, `freedoms` what its derivatives are by.
    """

    motions: int
    motion: float
    points: int
    point: float
    pitches: tuple[int, ...]
    freedoms: int


def expected_iterations(problem: PeriodicProblem, speed: float, settling: int) -> int:
    """Return the Newton iterations at a speed behind settling: each squares what that leaves of the change.

    It falls as the mode does that is damped least, and ends below `RESIDUAL_LIMIT`.
    """
    modes = natural_modes(problem.system, problem.time)
    damping = 2.0 * np.pi * modes.frequency * modes.damping_ratio
    slowest = float(np.min(damping[modes.frequency > 0.0], initial=np.inf))
    duration = problem.repeat * problem.period.duration(speed)
    left = np.log(CHANGE) - (slowest * settling * duration if settling else 0.0)
    limit = np.log(RESIDUAL_LIMIT)
    return 0 if left <= limit else int(np.ceil(np.log2(limit / left)))


def motion_periods(freedoms: int, settling: int, iterations: int) -> int:
    """Return the periods that are integrated for a motion of a sweep, in units of that of the motion.

    Settling, the residual, the derivatives by central differences in 2 n states, and the error of the steps,
    whose run on half the steps counts twice.
    """
    return settling + 4 + 4 * freedoms + iterations * (4 * freedoms + 1)


def point_periods(freedoms: int, iterations: int = BRANCH_ITERATIONS) -> int:
    """Return the periods that are integrated for a point of a branch, derived in the speed too."""
    return 4 * freedoms + 6 + iterations * (4 * freedoms + 3)


def branch_points(speed: FloatArray) -> int:
    """Return how many points a branch has over speeds without a fold: its steps are shares of the highest."""
    return int(np.ceil((1.0 - float(speed[0] / speed[-1])) / LARGEST_STEP)) + 1


def steady_cost(
    system: System, speed: FloatArray, *, branch: bool = True, repeat: int = 1, periods: int
) -> SteadyCost:
    """Return what `steady_states` of the same will cost; some hundredths of a second of it are integrated.

    Raises `InputError`, `SolveError` as `steady_states`.
    """
    sense = float(np.sign(system.scene.references[leading_law(system)].speed.extreme))
    problem = periodic_problem(system, sense * float(speed[0]), repeat)
    ends = [sense * float(at) for at in (speed[0], speed[-1])]
    each = float(np.mean([period_seconds(problem, at) for at in ends]))
    freedoms, several, points = problem.rest.size // 2, speed.size > 1, branch_points(speed)
    if several and branch and PROBED * SETTLING * each < AFFORDED:
        each, points = _settling(problem, sense * speed)
    whole = [motion_periods(freedoms, periods, expected_iterations(problem, at, periods)) for at in ends]
    return SteadyCost(
        speed.size * (2 if several else 1),
        float(np.mean(whole)) * each,
        points if branch and several else 0,
        point_periods(freedoms) * each,
        tuple(repeat * abs(count) for count in problem.period.pitches),
        freedoms,
    )


def _settling(problem: PeriodicProblem, speed: FloatArray) -> tuple[float, int]:
    """Return the CPU seconds of a period of settling motions, and how many points a branch through them has.

    Where flanks lift off steps are halved, and states change more than speeds: the arclength counts both.
    """
    began, state, passed = cpu_seconds(), problem.rest, []
    for at in np.linspace(speed[0], speed[-1], PROBED).tolist():
        state = settled(problem, at, state)
        passed.append(np.append(state / problem.size, at / speed[-1]))
    seconds = (cpu_seconds() - began) / (PROBED * SETTLING)
    length = float(np.nan_to_num(np.linalg.norm(np.diff(passed, axis=0), axis=1)).sum())
    return seconds, min(int(np.ceil(length / LARGEST_STEP)) + 1, MOST_POINTS)


def period_seconds(problem: PeriodicProblem, speed: float) -> float:
    """Return the CPU seconds of a period of the motions at a speed, by the first steps from rest."""
    over_period, steps, whole = PeriodMap(problem, speed), LEAST_STEPS, problem.grid.level.size
    over_period.begun(problem.rest, 1)  # reads the code
    while True:
        steps = min(steps, whole)
        seconds = min(_taken(over_period, problem.rest, steps) for _ in range(TIMES))
        if seconds >= ENOUGH or steps == whole:
            return problem.repeat * whole * seconds / steps
        steps *= 2


def _taken(over_period: PeriodMap, state: FloatArray, steps: int) -> float:
    began = cpu_seconds()
    over_period.begun(state, steps)
    return cpu_seconds() - began
