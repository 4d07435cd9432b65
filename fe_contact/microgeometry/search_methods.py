"""Methods that search the unit cube for the design of least merit.

A point of the unit cube is a design: each coordinate is a variable over its range. The merit is the objective
with a penalty for limits that are exceeded. The rough merit costs less and ranks designs only. A walk is a
sequence of designs, each from the linear program about the one before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import count
from typing import Protocol

import numpy as np

from fe_contact.errors import integer
from fe_contact.microgeometry.counted_merit import Budget, BudgetUsed, CountedMerit, Design
from fe_contact.microgeometry.design_problem import Merit, SearchProblem
from fe_contact.types import FloatArray, Json
from host.optional_modules import optimize
from model_studies.progress import unreported

SIMPLEX_SIZE, SIMPLEX_MERIT = 1e-3, 1e-4
"""Size of a converged simplex over the ranges, and its range of merits over the merit of the start."""

EDGE = 0.2
"""Edge of the first simplex over the ranges, towards the inside."""

SPREAD = 1e-3
"""Standard deviation of the merit over a converged population, over its mean."""

FIRST_REGION = 0.2
"""Largest step of the first linear program, in parts of the ranges."""

POOR, GOOD = 0.25, 0.75
"""Part of the predicted fall of the merit below which the trust region shrinks, and above which it grows."""
POORER = 0.4
"""Size of a trust region that shrinks over the step that was poor."""

TRIED = 7
"""Steps from every start, before the best walk is followed to its end."""

ASIDE = 0.05
"""Largest distance of a restart from the end of a walk, in parts of the ranges."""
MIN_GAIN, MISSES = 0.005, 3
"""Least relative gain of a restart that counts, and number of restarts in a row without it that ends a walk.
"""

FINISHED = 3
"""Number of rough walks that are continued by the merit: the best by it."""

EXPLORED = 0.65
"""Part of the designs that exploration may use: the simplex behind it needs some hundred to converge."""

LINEARIZED = 2.1
"""Cost of a design with its slopes over that of a design; measured with five variables of a helical pair."""
FOLLOWED = 75
"""Number of designs of a walk to its end, and of its restarts."""

Cancel = Callable[[], bool]


class Method(Protocol):
    """A way to search the unit cube."""

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search from `start` (d,) until converged; the merits remember the best.

        `rough` costs less and only ranks designs; its designs may end before those of `merit`. Raises
        `BudgetUsed`, `Cancelled` by the merit: the search is over.
        """

    def to_json(self) -> Json:
        """Return plain JSON."""


@dataclass(frozen=True)
class NelderMead:
    """Simplex of Nelder and Mead (1965) in bounds, its coefficients by dimension (Gao and Han 2012).

    The search is cheap and finds a local minimum: start it more than once.
    """

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search by the merit alone; `rough` and `seed` are not used."""
        edges = np.diag(np.where(start < 0.5, EDGE, -EDGE))
        optimize.minimize(
            merit,
            start,
            method="Nelder-Mead",
            bounds=optimize.Bounds(np.zeros(start.size), np.ones(start.size)),
            options={
                "initial_simplex": np.vstack([start, start + edges]),
                "xatol": SIMPLEX_SIZE,
                "fatol": SIMPLEX_MERIT,
                "adaptive": True,
                "maxfev": 10**9,  # the merit ends the search
            },
        )

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "nelder_mead"}


@dataclass(frozen=True)
class SequentialLinearProgramming:
    """Linear programs over the derivatives of the curves in a trust region, from design to design.

    Peak-to-peak is made of maxima, whose kinks a program of all positions, loads and nodes sees [1]_. A walk
    finds a local minimum. A Sobol' sequence ranked by the rough merit gives further starts: each is followed
    for `TRIED` steps, the best to its end. Where a contact begins, curves have kinks that a program sees from
    one side only; so the walk is restarted near its end.

    References
    ----------
    .. [1] K. Madsen, H. Schjaer-Jacobsen, Linearly constrained minimax optimization, Math. Programming 14
       (1978) 208-223.
    """

    sample: int = 64
    """Points of the sequence, 0 to 4096; 0: from the start alone."""
    trials: int = 3
    """Number of its best points that are followed, 0 to 64."""

    def __post_init__(self) -> None:
        integer("method.sample", self.sample, 0, 4096)
        integer("method.trials", self.trials, 0, 64)

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search by both merits; the sequence and the restarts are random."""
        walks = [_first_walk(merit, _Walk(start))]
        for point in _screened(rough, self.sample, self.trials, start.size, seed):
            walks.append(_first_walk(merit, _Walk(point)))
        if len(walks) > 1:
            walks = list(_following_walks(merit, walks, TRIED))
        best = min(walks, key=lambda walk: walk.value)
        _try_neighbors(merit, _completed_walk(merit, best), seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "sequential_linear_programming", "sample": self.sample, "trials": self.trials}


@dataclass(frozen=True)
class StagedLinearProgramming:
    """Sequential linear programs for a rough merit that is nearly the merit itself, and much cheaper.

    The start and the best points of a Sobol' sequence are followed to their ends by the rough merit: the
    first steps of a walk do not tell where it ends. The ends that are best by the merit are followed on by
    it. `sample`, `trials`: as of `SequentialLinearProgramming`.
    """

    sample: int = 64
    trials: int = 8

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search by both merits, each of which remembers the ends of its walks."""
        merit(start)
        with suppress(BudgetUsed):
            points = [start, *_screened(rough, self.sample, self.trials, start.size, seed)]
            for walk in _following_walks(rough, [_Walk(point) for point in points]):
                rough.end(walk.position)
            assessed, position = min(rough.ends, key=lambda design: design[0].merit)
            _try_neighbors(rough, _Walk(position, value=assessed.merit), seed)
        designs = [*rough.ends, rough.best] if rough.best else list(rough.ends)
        starts: list[FloatArray] = []
        for _, position in sorted(designs, key=lambda design: design[0].order):
            if all(np.abs(position - other).max() > ASIDE for other in starts):
                starts.append(position)
        # by the merit, then by their order; the merit remembers the best design of the walks
        ranked = sorted(zip(merit.assessed_in_turn(starts), range(len(starts)), strict=True))
        for _ in _following_walks(merit, [_Walk(starts[index]) for _, index in ranked[:FINISHED]]):
            pass

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "staged_linear_programming", "sample": self.sample, "trials": self.trials}


def _screened(
    rough: CountedMerit, sample: int, trials: int, dimensions: int, seed: np.random.SeedSequence
) -> list[FloatArray]:
    """Return the best points of a sample of a Sobol' sequence, of those that the budget can assess."""
    from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

    explored: list[tuple[float, FloatArray]] = []
    with suppress(BudgetUsed):
        sequence = qmc.Sobol(dimensions, rng=np.random.default_rng(seed))
        points = list(sequence.random_base2((sample - 1).bit_length())[:sample])
        for value, point in zip(rough.assessed_in_turn(points), points, strict=True):
            explored.append((value, point))  # one by one: the budget may end among them
    explored.sort(key=lambda trial: trial[0])
    return [point for value, point in explored[:trials] if np.isfinite(value)]


def _try_neighbors(merit: CountedMerit, best: _Walk, seed: np.random.SeedSequence) -> None:
    """Restart a walk near its end until `MISSES` restarts in a row gain too little."""
    random, misses = np.random.default_rng(seed.spawn(1)[0]), 0
    draws: list[FloatArray] = []
    while misses < MISSES and np.isfinite(best.value):
        fresh = MISSES - misses - len(draws)
        draws += [random.uniform(-1.0, 1.0, best.position.size) for _ in range(fresh)]
        asides = [np.clip(best.position + ASIDE * draw, 0.0, 1.0) for draw in draws]
        for other in _following_walks(merit, [_Walk(aside, 2.0 * ASIDE) for aside in asides]):
            draws.pop(0)
            misses = 0 if other.value < (1.0 - MIN_GAIN) * best.value else misses + 1
            if other.value < best.value:
                best = other
                break  # the other restarts began near the previous best design


@dataclass(frozen=True)
class _Walk:
    """State of a walk by linear programs."""

    position: FloatArray
    """The best design so far. Shape (d,)."""
    region: float = FIRST_REGION
    """Largest step of a coordinate."""
    value: float = np.inf
    """Merit of the design."""
    linear: Merit | None = None
    """Merit linearized there; None before the walk begins."""


def _first_walk(merit: CountedMerit, walk: _Walk) -> _Walk:
    """Assess the design that a walk starts from."""
    value, linear = merit.linearize(walk.position)
    return replace(walk, value=value, linear=linear)


def _completed_walk(merit: CountedMerit, walk: _Walk, maximum: int | None = None) -> _Walk:
    """Begin the walk where it has not begun, and step until converged, at most `maximum` times."""
    walk = _first_walk(merit, walk) if walk.linear is None else walk
    for _ in range(maximum) if maximum is not None else count():
        if not np.isfinite(walk.value) or walk.region <= SIMPLEX_SIZE:
            break
        further = _next_walk(merit, walk)
        if further is None:
            break
        walk = further
    return walk


def _next_walk(merit: CountedMerit, walk: _Walk) -> _Walk | None:
    """Take the step of the linear program, and adapt the region to its success; None: it promises nothing."""
    assert walk.linear is not None
    low, high = np.maximum(-walk.region, -walk.position), np.minimum(walk.region, 1.0 - walk.position)
    step, predicted = walk.linear.minimum(low, high)
    if walk.value - predicted <= SIMPLEX_MERIT * walk.value:
        return None
    point = np.clip(walk.position + step, 0.0, 1.0)
    value, linear = merit.linearize(point)
    part, region = (walk.value - value) / (walk.value - predicted), walk.region
    if part < POOR:
        region = POORER * float(np.abs(step).max())
    elif part > GOOD:
        region = min(2.0 * region, 1.0)
    return _Walk(point, region, value, linear) if value < walk.value else replace(walk, region=region)


def _following_walks(
    merit: CountedMerit, walks: Sequence[_Walk], maximum: int | None = None
) -> Iterator[_Walk]:
    """Follow independent walks to their ends, or for `maximum` steps at most, and yield each."""
    if len(walks) < 2 or not merit.divides:
        yield from (_completed_walk(merit, walk, maximum) for walk in walks)
        return
    tasks = [(walk, maximum, merit.left + 1) for walk in walks]
    for walk, designs in merit.workers.run(_walked, merit.problem, tasks):
        merit.replay(designs)
        yield walk


def _walked(problem: SearchProblem, task: tuple[_Walk, int | None, int]) -> tuple[_Walk, list[Design]]:
    """Follow a walk: one task of a worker.

    It may assess one design more than are left: the search of the caller then ends as its budget is used.
    """
    walk, maximum, designs = task
    merit = CountedMerit(problem, Budget(designs, never, unreported), designs)
    with suppress(BudgetUsed):
        walk = _completed_walk(merit, walk, maximum)
    return walk, merit.designs


@dataclass(frozen=True)
class DifferentialEvolution:
    """Differential evolution (Storn and Price 1997) by the rough merit, then a simplex from its best design.

    `population`: individuals for each variable, 3 to 50.
    """

    population: int = 5

    def __post_init__(self) -> None:
        integer("method.population", self.population, 3, 50)

    def minimize(
        self, merit: CountedMerit, rough: CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search from a population to which the start belongs."""
        merit(start)
        with suppress(BudgetUsed):
            optimize.differential_evolution(
                rough,
                optimize.Bounds(np.zeros(start.size), np.ones(start.size)),
                x0=start,
                rng=np.random.default_rng(seed),
                popsize=self.population,
                tol=SPREAD,
                maxiter=10**6,  # the merit ends the search
                polish=False,
            )
        NelderMead().minimize(merit, rough, start if rough.best is None else rough.best[1], seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "differential_evolution", "population": self.population}


def never() -> bool:
    """Return False: nobody cancels."""
    return False
