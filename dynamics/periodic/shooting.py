"""Periodic steady state at one speed, by shooting: Newton's method on the map over one period.

The map takes the state at the start of a period to the state at its end. A periodic motion is its fixed
point; the eigenvalues of its derivative are Floquet's multipliers, which tell whether the motion is stable.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntEnum

import numpy as np

from dynamics.checks import integer
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap
from dynamics.types import ComplexArray, FloatArray

ON_THE_CIRCLE = 1e-6  # multipliers of undamped motions lie on it but for rounding
ITERATION_LIMIT = 30  # most Newton iterations to a motion
HALVINGS = 12  # most halvings of a Newton step
RESIDUAL_LIMIT = 1e-9  # largest change over a period, over the size of a state
SETTLING = 64  # periods; at a damping ratio of 0.01 in resonance the rest is below 2 %


class Instability(Enum):
    """Through which point the largest multiplier has left the unit circle."""

    NONE = "stable"
    FOLD = "real, above 1"
    PERIOD_DOUBLING = "real, below -1"
    NEIMARK_SACKER = "complex pair"


class OrbitStatus(IntEnum):
    """The end of the search for a periodic motion."""

    CONVERGED = 0
    ITERATION_LIMIT = 1  # Newton ran out of iterations
    STALLED = 2  # no step along Newton's direction lowered the residual
    NOT_FINITE = 3  # the march over a period failed

    @property
    def usable(self) -> bool:
        """Whether the motion found is periodic."""
        return self is OrbitStatus.CONVERGED


@dataclass(frozen=True)
class Orbit:
    """A periodic motion at one speed, n freedoms."""

    status: OrbitStatus
    residual: float
    """Largest change of the state over the period, m."""
    iterations: int
    speed: float
    """Speed of the leading law, rad/s."""
    duration: float
    """Duration of the period sought, s."""
    state: FloatArray
    """State at t = 0, in meters, as `PeriodicProblem` scales it. Shape (2n,)."""
    monodromy: FloatArray
    """Derivative of the state after a period in the state before it, in the same scale. Shape (2n, 2n)."""
    multipliers: ComplexArray
    """Floquet multipliers, by falling size. Shape (2n,)."""
    step_error: float
    """Estimated change of the motion at t = 0 by the errors of the steps, m; close to a fold it grows without
    limit, as the motion does.
    """

    @classmethod
    def of(
        cls,
        over_period: PeriodMap,
        status: OrbitStatus,
        y: FloatArray,
        left: FloatArray,
        jacobian: FloatArray,
        iterations: int,
    ) -> Orbit:
        """Put an orbit together from where a search ended."""
        multipliers = np.full(y.size, np.nan + 0j)
        error = np.inf
        if np.all(np.isfinite(jacobian)):
            values = np.linalg.eigvals(jacobian).astype(complex)
            multipliers = values[np.argsort(-np.abs(values), kind="stable")]
            error = float(np.max(np.abs(_solve(np.eye(y.size) - jacobian, over_period.step_error(y)))))
        residual = float(np.max(np.abs(left)))
        duration, speed = over_period.duration, over_period.speed
        return cls(status, residual, iterations, speed, duration, y, jacobian, multipliers, error)

    @property
    def instability(self) -> Instability:
        """The kind of instability, if the motion is unstable, by its largest multiplier."""
        largest = complex(self.multipliers[0])
        if abs(largest) <= 1.0 + ON_THE_CIRCLE:
            return Instability.NONE
        if abs(largest.imag) > ON_THE_CIRCLE * abs(largest):
            return Instability.NEIMARK_SACKER
        return Instability.FOLD if largest.real > 0.0 else Instability.PERIOD_DOUBLING

    @property
    def stable(self) -> bool:
        """Whether small disturbances do not grow."""
        return self.instability is Instability.NONE


def find_orbit(problem: PeriodicProblem, speed: float, guess: FloatArray | None = None) -> Orbit:
    """Return the periodic motion at `speed` that Newton's method with step halving finds from `guess`.

    Raises `InputError`: the speed is zero or of the other sense.

    Parameters
    ----------
    speed : float
        Speed of the leading law, rad/s.
    guess : (2n,) array, optional
        State at t = 0 in meters; the static equilibrium without one.

    Returns
    -------
    Orbit
        Orbit with the status of the search; nothing is raised where it fails.
    """
    over_period = PeriodMap(problem, speed)
    y = np.array(problem.rest if guess is None else guess, dtype=float)
    defect = over_period(y) - y
    status, iterations = OrbitStatus.ITERATION_LIMIT, 0
    jacobian = np.full((y.size, y.size), np.nan)
    while iterations <= ITERATION_LIMIT:
        if not np.all(np.isfinite(defect)):
            status = OrbitStatus.NOT_FINITE
            break
        jacobian = over_period.monodromy(y)
        if np.max(np.abs(defect)) <= RESIDUAL_LIMIT * problem.size:
            status = OrbitStatus.CONVERGED
            break
        update = _solve(np.eye(y.size) - jacobian, defect)
        searched = _line_search(over_period, y, update, defect)
        if searched is None:
            status = OrbitStatus.STALLED
            break
        y, defect = searched
        iterations += 1
    return Orbit.of(over_period, status, y, defect, jacobian, iterations)


def _solve(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve in the sense of least squares: at a fold the matrix is singular."""
    if not np.all(np.isfinite(matrix)) or not np.all(np.isfinite(right)):
        return np.full(right.size, np.nan)
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0])


def _line_search(
    over_period: PeriodMap, y: FloatArray, update: FloatArray, left: FloatArray
) -> tuple[FloatArray, FloatArray] | None:
    """Halve the update until the residual falls; None if it never does."""
    size = float(np.linalg.norm(left))
    for halving in range(HALVINGS):
        trial = y + update * 0.5**halving
        remaining = over_period(trial) - trial
        if np.linalg.norm(remaining) < size:  # False for NaN
            return trial, remaining
    return None


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
