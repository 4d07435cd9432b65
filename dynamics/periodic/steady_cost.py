"""The cost of steady states over speed: number of integrated periods times measured cost of a step.

Settling integrates periods until transients have decayed; Newton's iterations on the map of a period follow.
A stretch is a number of steps that are run to measure the cost of one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.linearize import natural_modes
from dynamics.linearize.harmonic_response import excited_lines
from dynamics.linearize.operating_speeds import leading_law
from dynamics.linearize.steady_vibration import steady_vibration
from dynamics.periodic.continuation import LARGEST_STEP, MAX_POINTS
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap, periodic_problem
from dynamics.periodic.shooting import RESIDUAL_LIMIT, SETTLING, settled
from dynamics.types import FloatArray
from host import cpu_seconds

ENOUGH, MIN_STEPS, TIMES = 0.01, 16, 3
"""CPU s and steps of a stretch that is long enough to measure, and number of its repetitions: the quickest
counts, as other work on the machine only slows it. All stretches of a probe take at most six times as long,
where steps are cheap.
"""
PROBED, AFFORDED = 9, 0.5
"""Number of speeds at which motions settle, and CPU s that this may take: where it takes more, the estimate
assumes that no flank lifts off.
"""
RESPONSES, ORDERS = 400, 10
"""Speeds of the linear response, and orders of the meshes in it."""
SAMPLED_SPEEDS = 30
"""Most speeds whose steps are counted."""
CHANGE = 5e-3
"""Change of a state over a period after a step of a sweep, over the size of the state: 2e-3 to 1e-2 measured.
"""
BRANCH_ITERATIONS, BRANCH_DERIVATIONS, BRANCH_MAPS = 5, 1.25, 10
"""Iterations of a point of a branch, on average 3.5 to 5.4; derivations, 1 to 1.4; and maps that are laid out
for them: one per speed, and one of half the steps.
"""


@dataclass(frozen=True)
class SteadyCost:
    """Motions of both sweeps and points of the branch: their numbers, and CPU seconds of each.

    `pitches` are those of each mesh in a period of a motion, `freedoms` what its derivatives are by.
    """

    motions: int
    motion: float
    points: int
    point: float
    pitches: tuple[int, ...]
    freedoms: int


def expected_iterations(problem: PeriodicProblem, speed: float, settling: int) -> int:
    """Return the Newton iterations at a speed after settling: each squares the change that settling leaves.

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
    """Return the number of periods that are integrated for a motion of a sweep.

    Settling, the residual, the derivatives by central differences in 2 n states, and the error of the steps,
    whose run on half the steps counts twice.
    """
    return settling + 4 + 4 * freedoms + iterations * (4 * freedoms + 1)


def point_periods(
    freedoms: int, iterations: float = BRANCH_ITERATIONS, derivations: float = BRANCH_DERIVATIONS
) -> float:
    """Return the periods that are integrated for a point of a branch, derived in the speed too."""
    return derivations * (4 * freedoms + 2) + iterations + 4


def steps_share(problem: PeriodicProblem, speed: FloatArray) -> float:
    """Return the mean number of steps of motions at speeds, over the steps of the problem."""
    sample = speed[np.linspace(0, speed.size - 1, min(speed.size, SAMPLED_SPEEDS)).astype(int)]
    return float(np.mean([problem.at(float(w)).grid.level.size for w in sample])) / problem.grid.level.size


def steady_cost(
    system: System, speed: FloatArray, *, branch: bool = True, repeat: int = 1, periods: int
) -> SteadyCost:
    """Return the cost of `steady_states` with these arguments; it integrates some hundredths of a CPU second.

    Raises `InputError`, `SolveError` as `steady_states`.
    """
    sense = float(np.sign(system.scene.references[leading_law(system)].speed.extreme))
    problem = periodic_problem(system, sense * float(speed[0]), repeat)
    ends = [sense * float(at) for at in (speed[0], speed[-1])]
    period_cost = float(np.mean([period_seconds(problem, at) for at in ends]))
    freedoms, points, making = problem.rest.size // 2, 0, 0.0
    if branch and speed.size > 1:
        at, states = _response_states(problem, sense * speed)
        affords = PROBED * SETTLING * period_cost < AFFORDED
        seconds, length = _settling(problem, at, states) if affords else (period_cost, _lengths(states).sum())
        period_cost, points = seconds, min(int(np.ceil(length / LARGEST_STEP)) + 1, MAX_POINTS)
        making = min(_taken(PeriodMap(problem, end), problem.rest, 1) for end in ends)
    motions = [motion_periods(freedoms, periods, expected_iterations(problem, end, periods)) for end in ends]
    return SteadyCost(
        speed.size * (2 if speed.size > 1 else 1),
        float(np.mean(motions)) * period_cost * steps_share(problem, sense * speed),
        points,
        point_periods(freedoms) * period_cost + BRANCH_MAPS * making,
        tuple(repeat * abs(count) for count in problem.period.pitches),
        freedoms,
    )


def _response_states(problem: PeriodicProblem, speed: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return speeds (S,) and the states of a branch at them if no flank lifted off, (S, 2n + 1).

    States over their size and the speed over the highest, as the arclength of a branch has them: the linear
    response at the start of a period.
    """
    at = np.linspace(speed[0], speed[-1], RESPONSES)
    about, lines = excited_lines(problem.system, ORDERS, problem.time, at)
    steady = steady_vibration(about, at, lines.harmonics)
    rate = 1j * steady.omega[..., None] * steady.displacement
    state = np.concatenate([steady.displacement, rate], axis=2).sum(axis=1).real * problem.scale
    return at, np.column_stack([state / problem.size, at / at[-1]])


def _lengths(states: FloatArray) -> FloatArray:
    """Return the distances of neighboring states (S, 2n + 1); states that are not finite are left out."""
    return np.asarray(np.nan_to_num(np.linalg.norm(np.diff(states, axis=0), axis=1)))


def _settling(problem: PeriodicProblem, speed: FloatArray, states: FloatArray) -> tuple[float, float]:
    """Return the CPU seconds of a period of settling motions, and the length of a branch through them.

    They settle where the linear response has gone equal ways, at falling speeds: as resonances bend to lower
    ones where flanks lift off, the larger motions follow. A way is at least that of the linear response.
    """
    along = np.append(0.0, np.cumsum(_lengths(states)))
    ways = np.linspace(along[-1], 0.0, PROBED)
    began, state, passed = cpu_seconds(), problem.rest, []
    for at in np.interp(ways, along, speed).tolist():
        state = settled(problem, at, state)
        passed.append(np.append(state / problem.size, at / speed[-1]))
    seconds = (cpu_seconds() - began) / (PROBED * SETTLING)
    return seconds, float(np.maximum(_lengths(np.array(passed)), -np.diff(ways)).sum())


def period_seconds(problem: PeriodicProblem, speed: float) -> float:
    """Return the CPU seconds of a period of the motions at a speed, by the first steps from rest."""
    over_period, steps, levels = PeriodMap(problem, speed), MIN_STEPS, problem.grid.level.size
    over_period.begun(problem.rest, 1)  # reads the code
    while True:
        steps = min(steps, levels)
        seconds = min(_taken(over_period, problem.rest, steps) for _ in range(TIMES))
        if seconds >= ENOUGH or steps == levels:
            return problem.repeat * levels * seconds / steps
        steps *= 2


def _taken(over_period: PeriodMap, state: FloatArray, steps: int) -> float:
    began = cpu_seconds()
    over_period.begun(state, steps)
    return cpu_seconds() - began
