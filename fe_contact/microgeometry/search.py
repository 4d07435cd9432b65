"""One search of the best design: repeatable from a seed; it ends converged, used up, or cancelled."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from itertools import count
from typing import Protocol

import numpy as np
from scipy.optimize import Bounds, differential_evolution, minimize

from fe_contact.errors import integer
from fe_contact.microgeometry.design_problem import Assessed, DesignProblem
from fe_contact.microgeometry.objective import LinearMerit
from fe_contact.types import FloatArray, Json
from host import cpu_seconds
from model_studies.progress import unreported

# The merit of designs as a search sees it: counted, ended when enough are evaluated, the best remembered.


class _BudgetUsed(Exception):
    """All designs that may be evaluated were."""


class Cancelled(Exception):
    """Somebody requested the search to end."""


class _Budget:
    """Designs that one search may evaluate, of whatever cost.

    Before every design it is asked whether to `cancel`; after it, the part of all that is used is
    reported.
    """

    def __init__(self, total: int, cancel: Callable[[], bool], report: Callable[[float], None]) -> None:
        self.total, self.used = total, 0
        self._cancel, self._report = cancel, report

    def take(self, most: int) -> None:
        """Take one design, if fewer than `most` were taken; raises `_BudgetUsed` or `Cancelled`."""
        if self._cancel():
            raise Cancelled
        if self.used >= min(most, self.total):
            raise _BudgetUsed
        self.used += 1

    def tell(self) -> None:
        """Report what is used."""
        self._report(self.used / self.total)


class _CountedMerit:
    """Merit of a point (d,) in the unit cube.

    Parameters
    ----------
    most : int
        It raises `_BudgetUsed` when so many designs of the budget are used.

    Attributes
    ----------
    best : tuple of Assessed and ndarray, or None
        Of its designs, by their order; None before the first.
    count : int
        Its designs.
    least, largest : float
        Of the objectives of its designs that could be assessed, m.
    """

    def __init__(self, problem: DesignProblem, budget: _Budget, most: int) -> None:
        self.best: tuple[Assessed, FloatArray] | None = None
        self.count, self.least, self.largest = 0, np.inf, -np.inf
        self._problem, self._budget, self._most = problem, budget, most

    def __call__(self, point: FloatArray) -> float:
        """Assess a design."""
        self._budget.take(self._most)
        return self._counted(self._problem.assess(point), point)

    def linearize(self, point: FloatArray) -> tuple[float, LinearMerit]:
        """Assess a design, and return its merit with what is known about it to first order."""
        self._budget.take(self._most)
        assessed, merit = self._problem.linearize(point)
        return self._counted(assessed, point), merit

    def _counted(self, assessed: Assessed, point: FloatArray) -> float:
        """Count and remember a design; return its merit."""
        self.count += 1
        if self.best is None or assessed.order < self.best[0].order:
            self.best = assessed, np.clip(point, 0.0, 1.0)
        if np.isfinite(assessed.objective):
            self.least, self.largest = (
                min(self.least, assessed.objective),
                max(self.largest, assessed.objective),
            )
        self._budget.tell()
        return assessed.merit


SIMPLEX_SIZE, SIMPLEX_MERIT = 1e-3, 1e-4
"""A simplex this small has converged: parts of the range of a variable, and of the merit of the start."""
EDGE = 0.2
"""Of the first simplex, in parts of the ranges, towards the inside."""
SPREAD = 1e-3
"""Standard deviation of the merit over a population that has converged, in parts of its mean."""

FIRST_REGION = 0.2
"""Largest step of a linear program to begin with, in parts of the ranges."""
POOR, GOOD, POORER = 0.25, 0.75, 0.4
"""Parts of the promised fall by which the region shrinks or grows; to what part of the step it shrinks."""

# Ways to search the unit cube for the design of least merit.

TRIED = 7
"""Steps of every start before the best of them is followed to its end."""

ASIDE, LEAST_GAIN, MISSES = 0.05, 0.005, 3
"""Where a walk ends it is taken up again beside, so far away at most, until that gains less so often."""


class Method(Protocol):
    """A way to search the unit cube."""

    def minimize(
        self, merit: _CountedMerit, rough: _CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search from `start` (d,) until converged; the merits remember the best.

        `rough` costs less and only ranks designs; its designs may end before those of `merit`.

        Raises
        ------
        _BudgetUsed, Cancelled
            By the merit: the search is over.
        """

    def to_json(self) -> Json:
        """Return plain JSON."""


@dataclass(frozen=True)
class NelderMead:
    """Simplex of Nelder and Mead (1965) in bounds, its coefficients by dimension (Gao and Han 2012).

    Cheap and local: start it more than once.
    """

    def minimize(
        self, merit: _CountedMerit, rough: _CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; nothing is random, and nothing is rough."""
        bounds = Bounds(np.zeros(start.size), np.ones(start.size))
        minimize(
            merit,
            start,
            method="Nelder-Mead",
            bounds=bounds,
            options={
                "initial_simplex": np.vstack([start, start + np.diag(np.where(start < 0.5, EDGE, -EDGE))]),
                "xatol": SIMPLEX_SIZE,
                "fatol": SIMPLEX_MERIT,
                "adaptive": True,
                "maxfev": 10**9,
            },
        )

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "nelder_mead"}


@dataclass(frozen=True)
class SequentialLinearProgramming:
    """From design to design by linear programmes over the derivatives of the curves, in a trust region.

    Peak-to-peak is made of maxima, whose kinks a program of all positions, loads and nodes sees [1]_. It is
    local: a Sobol' sequence ranked by the rough merit gives further starts; each is followed for some
    designs, the best of them to its end. Where a contact begins curves have kinks that a program sees from
    one side only; so it is taken up again a little beside where it ended.

    Attributes
    ----------
    sample : int
        Points of the sequence, 0 to 4096; 0: from the start alone.
    trials : int
        The best of them that are followed, 0 to 64.

    References
    ----------
    .. [1] K. Madsen, H. Schjaer-Jacobsen, Linearly constrained minimax optimization, Math. Programming 14
       (1978) 208-223.
    """

    sample: int = 64
    trials: int = 3

    def __post_init__(self) -> None:
        integer("method.sample", self.sample, 0, 4096)
        integer("method.trials", self.trials, 0, 64)

    def minimize(
        self, merit: _CountedMerit, rough: _CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; the sequence and the points beside an end are random."""
        walks = [_Walk(merit, start)]
        for point in self._best(rough, start.size, seed):
            walks.append(_Walk(merit, point))
        for walk in walks if len(walks) > 1 else ():
            walk.follow(TRIED)
        best = min(walks, key=lambda walk: walk.value)
        best.follow()
        random, misses = np.random.default_rng(seed.spawn(1)[0]), 0
        while misses < MISSES and np.isfinite(best.value):
            aside = best.place + ASIDE * random.uniform(-1.0, 1.0, start.size)
            other = _Walk(merit, np.clip(aside, 0.0, 1.0), 2.0 * ASIDE)
            other.follow()
            misses = 0 if other.value < (1.0 - LEAST_GAIN) * best.value else misses + 1
            best = min(best, other, key=lambda walk: walk.value)

    def _best(self, rough: _CountedMerit, dimensions: int, seed: np.random.SeedSequence) -> list[FloatArray]:
        """Return the best points of the sequence, as far as the designs reach."""
        from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

        explored: list[tuple[float, FloatArray]] = []
        with suppress(_BudgetUsed):
            sequence = qmc.Sobol(dimensions, rng=np.random.default_rng(seed))
            for point in sequence.random_base2((self.sample - 1).bit_length())[: self.sample]:
                explored.append((rough(point), point))
        explored.sort(key=lambda trial: trial[0])
        return [point for value, point in explored[: self.trials] if np.isfinite(value)]

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "sequential_linear_programming", "sample": self.sample, "trials": self.trials}


class _Walk:
    """Steps of linear programmes from one design on; `place` (d,) is the best so far, `value` its merit."""

    def __init__(self, merit: _CountedMerit, start: FloatArray, region: float = FIRST_REGION) -> None:
        self._merit, self.place, self._region = merit, start, region
        self.value, self._linear = merit.linearize(start)

    def follow(self, most: int | None = None) -> None:
        """Step until converged, or so often at most."""
        for _ in range(most) if most is not None else count():
            if not np.isfinite(self.value) or self._region <= SIMPLEX_SIZE or not self._step():
                return

    def _step(self) -> bool:
        """Take a step if one promises anything; shorten the region where it keeps too little of it."""
        ends = np.maximum(-self._region, -self.place), np.minimum(self._region, 1.0 - self.place)
        step, promised = self._linear.least(*ends)
        if self.value - promised <= SIMPLEX_MERIT * self.value:
            return False
        point = np.clip(self.place + step, 0.0, 1.0)
        value, linear = self._merit.linearize(point)
        kept = (self.value - value) / (self.value - promised)
        if kept < POOR:
            self._region = POORER * float(np.abs(step).max())
        elif kept > GOOD:
            self._region = min(2.0 * self._region, 1.0)
        if value < self.value:
            self.place, self.value, self._linear = point, value, linear
        return True


@dataclass(frozen=True)
class DifferentialEvolution:
    """Differential evolution (Storn and Price 1997) by the rough merit, then a simplex from its best.

    Attributes
    ----------
    population : int
        Individuals for each variable, 3 to 50.
    """

    population: int = 5

    def __post_init__(self) -> None:
        integer("method.population", self.population, 3, 50)

    def minimize(
        self, merit: _CountedMerit, rough: _CountedMerit, start: FloatArray, seed: np.random.SeedSequence
    ) -> None:
        """Search; the start is one of the first population."""
        merit(start)
        with suppress(_BudgetUsed):
            differential_evolution(
                rough,
                Bounds(np.zeros(start.size), np.ones(start.size)),
                x0=start,
                rng=np.random.default_rng(seed),
                popsize=self.population,
                tol=SPREAD,
                maxiter=10**6,
                polish=False,
            )
        NelderMead().minimize(merit, rough, start if rough.best is None else rough.best[1], seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "differential_evolution", "population": self.population}


EXPLORED = 0.65
"""Part of the designs that exploration may use: the simplex behind it needs some hundred to converge."""

Cancel = Callable[[], bool]


class Ended(StrEnum):
    """The reason why a search ended."""

    CONVERGED = "converged"
    SPENT = "designs used"
    CANCELLED = "interrupted"


@dataclass(frozen=True)
class Search:
    """The method and the size of a search.

    Attributes
    ----------
    method : Method
    seed : int
        Of all random numbers: equal searches give equal results.
    starts : int
        Independent searches; the first starts at the given pair, others at points of a Sobol' sequence.
    evaluations : int
        Largest number of designs that each of them evaluates.
    positions : int
        Equally spaced in a base pitch; the analysis at the end places its own.
    exploration : int
        Positions by which designs are ranked before any is followed, at most `positions`.
    """

    method: Method = SequentialLinearProgramming()
    seed: int = 0
    starts: int = 1
    evaluations: int = 1000
    positions: int = 64
    exploration: int = 16

    def __post_init__(self) -> None:
        integer("search.seed", self.seed, 0, 2**32 - 1)
        integer("search.starts", self.starts, 1, 256)
        integer("search.evaluations", self.evaluations, 1, 10**6)
        integer("search.exploration", self.exploration, 8, 4096)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return self.method.to_json() | {
            "seed": self.seed,
            "starts": self.starts,
            "evaluations": self.evaluations,
            "positions": self.positions,
            "exploration": self.exploration,
        }


@dataclass(frozen=True)
class SearchRun:
    """The result of one start of a search.

    Attributes
    ----------
    place : ndarray, shape (d,)
        Best design, in parts of the ranges of the variables.
    explored : int
        Of the evaluations, those at few positions.
    spread : float
        Largest less least objective of all others, m.
    """

    place: FloatArray
    assessed: Assessed
    evaluations: int
    ended: Ended
    cpu_seconds: float
    explored: int = 0
    spread: float = 0.0

    @property
    def converged(self) -> bool:
        """Whether it ended by itself."""
        return self.ended is Ended.CONVERGED


def search_from(
    problem: DesignProblem,
    search: Search,
    start: FloatArray,
    index: int,
    report: Callable[[float], None] | None = None,
    cancel: Cancel | None = None,
    ending: tuple[type[BaseException], ...] = (Cancelled,),
) -> SearchRun:
    """Search from one start.

    Parameters
    ----------
    start : ndarray, shape (d,)
        In the unit cube.
    index : int
        Of the start: each draws its own random numbers.
    report : callable, optional
        Called with the part of the evaluations used.
    cancel : callable, optional
        Asked before each design whether to end with the best so far.
    ending : tuple of exception types
        By which it is cancelled.
    """
    begun = cpu_seconds()
    budget = _Budget(search.evaluations, cancel or never, report or unreported)
    merit = _CountedMerit(problem, budget, search.evaluations)
    rough = _CountedMerit(problem.rough(search.exploration), budget, int(EXPLORED * search.evaluations))
    ended = Ended.CONVERGED
    try:
        search.method.minimize(merit, rough, start, np.random.SeedSequence((search.seed, index)))
    except _BudgetUsed:
        ended = Ended.SPENT
    except ending:
        ended = Ended.CANCELLED
    assessed, point = _best(problem, merit, rough, start)
    seconds = cpu_seconds() - begun
    spread = max(0.0, merit.largest - merit.least)
    return SearchRun(point, assessed, budget.used, ended, seconds, rough.count, spread)


def _best(
    problem: DesignProblem, merit: _CountedMerit, rough: _CountedMerit, start: FloatArray
) -> tuple[Assessed, FloatArray]:
    """Return the best design; where exploration was cut short its best has yet to be assessed in full."""
    known = [] if merit.best is None else [merit.best]
    if merit.count <= 1 and rough.best is not None:
        known.append((problem.assess(rough.best[1]), rough.best[1]))
    return min(known, key=lambda design: design[0].order) if known else (problem.assess(start), start)


def never() -> bool:
    """Nobody cancels."""
    return False
