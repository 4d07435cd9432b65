"""The branch of periodic motions over speed, around its folds, by pseudo-arclength continuation.

A fold is a speed at which the branch turns back; a sweep over the speed jumps there. The unknowns of a point
are state and speed together. The arclength counts the state over its size and the speed over the highest one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from dynamics.checks import integer, positive
from dynamics.errors import InputError
from dynamics.periodic.period_map import PeriodicProblem, PeriodMap
from dynamics.periodic.shooting import (
    ON_THE_CIRCLE,
    RESIDUAL_LIMIT,
    Instability,
    Orbit,
    OrbitStatus,
    find_orbit,
)
from dynamics.types import FloatArray

ITERATION_LIMIT = 16  # most Newton iterations to a point of the branch
FALLING = 0.3
"""Residual over that of the last iteration, above which the Jacobian is computed anew."""
EASY = 1
"""Most computations of the Jacobian for a motion after which the step along the branch grows."""
_SHRINK, _GROW = 0.5, 1.5
"""Factors of the step along the branch where Newton fails, and after an easy motion."""
SMALLEST_STEP = 1e-5  # over the largest step
LARGEST_STEP = 0.02  # between neighboring motions, over the larger speed or the size of the state
MAX_POINTS = 500  # usual limit of the points of a branch
FOLD_LIMIT = 1e-6  # over the largest speed: distance of a fold beyond the motions found
FOLD_ITERATIONS = 20  # most iterations to a fold
FOLD_SHARE = 0.1  # least part of a bracket that an iteration takes off


class BranchStatus(IntEnum):
    """The reason why a branch ended."""

    COMPLETED = 0  # it left the range of speeds
    STEP_FLOOR = 1  # Newton failed with the smallest step along the branch
    POINT_LIMIT = 2  # the number of motions allowed was used up
    NO_START = 3  # no periodic motion was found at the first speed

    @property
    def usable(self) -> bool:
        """Whether the branch covers the requested speeds."""
        return self is BranchStatus.COMPLETED


@dataclass(frozen=True)
class _Bifurcation:
    """A point where a branch turns back in speed, or gains or loses stability."""

    kind: Instability
    """`FOLD`: the branch turns back; a sweep over the speed jumps here."""
    speed: float
    """Speed, rad/s: solved for at a fold, interpolated between two motions at other kinds."""
    point: int
    """Last motion of the branch before the point."""


@dataclass(frozen=True)
class Branch:
    """Periodic motions along a branch, in order."""

    status: BranchStatus
    orbits: tuple[Orbit, ...]
    bifurcations: tuple[_Bifurcation, ...]

    @property
    def speed(self) -> FloatArray:
        """Speeds of all motions, rad/s."""
        return np.array([orbit.speed for orbit in self.orbits])

    @property
    def folds(self) -> FloatArray:
        """Speeds at which the branch turns back, rad/s, in order."""
        return np.array([b.speed for b in self.bifurcations if b.kind is Instability.FOLD])


@dataclass(frozen=True)
class _Point:
    """A point z = (state / size, speed / scale) on the branch with its unit tangent.

    `jacobian` (2n, 2n + 1): derivative of (map - identity) / size by z, with the map of a state over a
    period; `renewed`: number of times that it was computed to find the point.
    """

    z: FloatArray
    tangent: FloatArray
    orbit: Orbit
    jacobian: FloatArray
    renewed: int


def follow_branch(
    problem: PeriodicProblem,
    first: float,
    last: float,
    largest_step: float = LARGEST_STEP,
    guess: FloatArray | None = None,
    points: int = MAX_POINTS,
    progress: Callable[[float], None] | None = None,
) -> Branch:
    """Follow the periodic motions from the speed `first` until they leave the range `first` to `last`.

    The unknowns are state and speed together, so the branch is followed through folds and along its unstable
    parts. Raises `InputError`: a speed is zero or of the wrong sense, or a value out of range.

    Parameters
    ----------
    first, last : float
        Speeds of the leading law, rad/s.
    largest_step : float
        Between neighboring motions: change of the speed over the larger of both speeds, or of the state over
        its size.
    guess : (2n,) array, optional
        State in meters to find the first motion from.
    points : int
        Most motions.
    progress : callable, optional
        Called with the part of the range reached so far; what it raises ends the search.

    Returns
    -------
    Branch
        Branch with its status; nothing is raised where it ends early.
    """
    positive("largest_step", largest_step)
    integer("points", points, 2, 1_000_000)
    if first == last:
        raise InputError("last", last, "another speed than the first")
    PeriodMap(problem, last).arrays  # noqa: B018 - raises if the speed is zero or of the wrong sense
    start = find_orbit(problem, first, guess)
    if not start.status.usable:
        return Branch(BranchStatus.NO_START, (start,), ())
    scale = max(abs(first), abs(last))
    towards = np.append(np.zeros(start.state.size), np.sign(last - first) * np.sign(scale))
    point = _point_on_branch(problem, scale, start, towards)
    return _continue(problem, scale, point, (first, last), largest_step, points, progress)


def _continue(
    problem: PeriodicProblem,
    scale: float,
    start: _Point,
    speeds: tuple[float, float],
    largest_step: float,
    points: int,
    progress: Callable[[float], None] | None,
) -> Branch:
    """Step along the branch from `start` at the first of `speeds`, shorter where Newton fails.

    Other parameters as `follow_branch`.
    """
    first, last = speeds
    low, high = sorted(speeds)
    trail, bifurcations, step = [start], list[_Bifurcation](), largest_step
    status = BranchStatus.POINT_LIMIT
    while len(trail) < points:
        arrived = _step(problem, scale, trail[-1], step)
        if arrived is None:
            step *= _SHRINK
            if step < SMALLEST_STEP * largest_step:
                status = BranchStatus.STEP_FLOOR
                break
            continue
        bifurcations += _bifurcations_between(problem, scale, trail[-1], arrived, step, len(trail) - 1)
        trail.append(arrived)
        if progress is not None:
            progress(min(max(abs(p.orbit.speed - first) for p in trail) / abs(last - first), 1.0))
        if arrived.renewed <= EASY:
            step = min(_GROW * step, largest_step)
        if not low <= arrived.orbit.speed <= high:
            status = BranchStatus.COMPLETED
            break
    return Branch(status, tuple(point.orbit for point in trail), tuple(bifurcations))


def _point_on_branch(
    problem: PeriodicProblem, scale: float, orbit: Orbit, along: FloatArray, renewed: int = 0
) -> _Point:
    """Return the point of `orbit` with its tangent in the sense of `along` (2n + 1,)."""
    z = np.append(orbit.state / problem.size, orbit.speed / scale)
    jacobian = _jacobian(problem, scale, PeriodMap(problem, orbit.speed), orbit.state, orbit.monodromy)
    tangent = np.linalg.svd(jacobian)[2][-1]  # the null vector: the last right singular vector
    return _Point(
        z=z,
        tangent=tangent if tangent @ along >= 0.0 else -tangent,
        orbit=orbit,
        jacobian=jacobian,
        renewed=renewed,
    )


def _jacobian(
    problem: PeriodicProblem, scale: float, over_period: PeriodMap, y: FloatArray, monodromy: FloatArray
) -> FloatArray:
    """Return the derivative of (map - identity) / size by z, (2n, 2n + 1)."""
    by_speed = over_period.by_speed(y) * (scale / problem.size)
    return np.concatenate([monodromy - np.eye(y.size), by_speed[:, None]], axis=1)


def _step(problem: PeriodicProblem, scale: float, point: _Point, step: float) -> _Point | None:
    """Return the motion at the arclength `step` behind `point`, or None if Newton fails.

    It begins with the Jacobian at `point`, to which Broyden's updates are added: so an iteration integrates
    one period, while a Jacobian takes 4 n. It is computed anew where the residual falls by too little.
    """
    aim = point.z + step * point.tangent
    z, correction, matrix = aim.copy(), aim, np.vstack([point.jacobian, point.tangent])
    before, renewed = np.inf, 0
    for iteration in range(ITERATION_LIMIT + 1):
        y, speed = z[:-1] * problem.size, float(z[-1] * scale)
        if speed * point.orbit.speed <= 0.0:
            return None
        over_period = PeriodMap(problem, speed)
        residual = over_period(y) - y
        if not np.all(np.isfinite(residual)):
            return None
        if np.max(np.abs(residual)) <= RESIDUAL_LIMIT * problem.size:
            monodromy = over_period.monodromy(y)
            orbit = Orbit.of(over_period, OrbitStatus.CONVERGED, y, residual, monodromy, iteration)
            return _point_on_branch(problem, scale, orbit, point.tangent, renewed)
        right = np.append(residual / problem.size, point.tangent @ (z - aim))
        if np.linalg.norm(right) > FALLING * before:
            jacobian = _jacobian(problem, scale, over_period, y, over_period.monodromy(y))
            matrix, renewed = np.vstack([jacobian, point.tangent]), renewed + 1
        elif iteration:
            matrix = matrix + np.outer(right, correction / (correction @ correction))
        if not np.all(np.isfinite(matrix)):
            return None
        before = float(np.linalg.norm(right))
        correction = np.asarray(-np.linalg.lstsq(matrix, right, rcond=None)[0])
        z = z + correction
    return None


def _bifurcations_between(
    problem: PeriodicProblem, scale: float, before: _Point, behind: _Point, step: float, index: int
) -> list[_Bifurcation]:
    """Return the bifurcations between two neighboring points."""
    between = []
    if before.tangent[-1] * behind.tangent[-1] < 0.0:
        between.append(_Bifurcation(Instability.FOLD, _fold(problem, scale, before, behind, step), index))
    elif before.orbit.stable is not behind.orbit.stable:
        unstable = behind.orbit if before.orbit.stable else before.orbit
        excess = [abs(p.orbit.multipliers[0]) - 1.0 - ON_THE_CIRCLE for p in (before, behind)]
        weight = excess[0] / (excess[0] - excess[1])
        speed = before.orbit.speed + weight * (behind.orbit.speed - before.orbit.speed)
        between.append(_Bifurcation(unstable.instability, float(speed), index))
    return between


def _fold(problem: PeriodicProblem, scale: float, before: _Point, behind: _Point, step: float) -> float:
    """Return the extreme speed between two points, where the tangent's component of the speed is 0.

    It is found by the Illinois variant of regula falsi over the arclength. Where flanks graze, a branch has a
    corner instead of a smooth fold, and the bracket closes on the corner.
    """
    low, high = 0.0, step
    at_low, at_high = before.tangent[-1], behind.tangent[-1]
    speeds = [before.orbit.speed, behind.orbit.speed]
    for _ in range(FOLD_ITERATIONS):
        if min(abs(at_low), abs(at_high)) * (high - low) < FOLD_LIMIT:
            break
        weight = min(max(at_low / (at_low - at_high), FOLD_SHARE), 1.0 - FOLD_SHARE)
        inside = low + weight * (high - low)
        middle = _step(problem, scale, before, inside)
        if middle is None:
            break
        speeds.append(middle.orbit.speed)
        # half the value at an end that stays, so that both ends move
        if middle.tangent[-1] * at_low > 0.0:
            low, at_low, at_high = inside, middle.tangent[-1], 0.5 * at_high
        else:
            high, at_high, at_low = inside, middle.tangent[-1], 0.5 * at_low
    return max(speeds) if before.tangent[-1] > 0.0 else min(speeds)
