"""Sweeps over speed: what a slow run-up or run-down settles on, speed by speed."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from dynamics.checks import integer
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap
from dynamics.periodic.shooting import Orbit, find_orbit
from dynamics.types import FloatArray

SETTLING = 64  # periods; at a damping ratio of 0.01 in resonance the rest is below 2 %


def settled(
    problem: PeriodicProblem, speed: float, state: FloatArray | None = None, periods: int = SETTLING
) -> FloatArray:
    """Return the state (2n,) in meters that `periods` periods at `speed` make of `state` (at rest: None).

    A start for `find_orbit` on a motion that attracts, where Newton's method alone could end anywhere.
    """
    integer("periods", periods, 0, 10_000_000)
    over_period = PeriodMap(problem, speed)
    y = np.array(problem.rest if state is None else state, dtype=float)
    for _ in range(periods):
        y = over_period(y)
    return y


def sweep(
    problem: PeriodicProblem,
    speeds: Sequence[float] | FloatArray,
    periods: int = SETTLING,
    progress: Callable[[float], None] | None = None,
) -> tuple[Orbit, ...]:
    """Return the motion at each of `speeds` (rad/s) in turn, each settled from the one before.

    It stays on its branch up to the fold and jumps there, as a slow run does: rising and falling speeds give
    the two sides of a hysteresis. Where it settles on no motion of the period sought (a longer period, chaos)
    the status says so, and the sweep goes on from there. `progress` is called with the fraction done; what
    it raises ends the sweep.

    Raises
    ------
    InputError
        If a speed is zero or of the other sense.
    """
    state, orbits = problem.rest, []
    for speed in speeds:
        state = settled(problem, float(speed), state, periods)
        orbits.append(find_orbit(problem, float(speed), state))
        if orbits[-1].status.usable and orbits[-1].stable:
            state = orbits[-1].state
        if progress is not None:
            progress(len(orbits) / len(speeds))
    return tuple(orbits)
