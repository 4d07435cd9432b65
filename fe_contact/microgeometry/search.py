"""One search of the best design: repeatable from a seed; it ends converged, used up, or cancelled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from fe_contact.errors import integer
from fe_contact.microgeometry.design_problem import Assessed, DesignProblem
from fe_contact.microgeometry.search_method import (
    Budget,
    BudgetUsed,
    Cancelled,
    CountedMerit,
    Method,
    SequentialLinearProgramming,
)
from fe_contact.types import FloatArray, Json
from host import cpu_seconds

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

    method: Method = SequentialLinearProgramming()  # noqa: RUF009 (frozen)
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
    assessed : Assessed
    evaluations : int
    ended : Ended
    cpu_seconds : float
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

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "objective_m": self.assessed.objective,
            "violation": self.assessed.violation,
            "evaluations": self.evaluations,
            "explored": self.explored,
            "converged": self.converged,
            "ended": self.ended.value,
            "spread_m": self.spread,
            "cpu_seconds": self.cpu_seconds,
        }


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
    problem : DesignProblem
    search : Search
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
    budget = Budget(search.evaluations, cancel or never, report or _silent)
    merit = CountedMerit(problem, budget, search.evaluations)
    rough = CountedMerit(problem.rough(search.exploration), budget, int(EXPLORED * search.evaluations))
    ended = Ended.CONVERGED
    try:
        search.method.minimize(merit, rough, start, np.random.SeedSequence((search.seed, index)))
    except BudgetUsed:
        ended = Ended.SPENT
    except ending:
        ended = Ended.CANCELLED
    assessed, point = _best(problem, merit, rough, start)
    seconds = cpu_seconds() - begun
    spread = max(0.0, merit.largest - merit.least)
    return SearchRun(point, assessed, budget.used, ended, seconds, rough.count, spread)


def _best(
    problem: DesignProblem, merit: CountedMerit, rough: CountedMerit, start: FloatArray
) -> tuple[Assessed, FloatArray]:
    """Return the best design; where exploration was cut short its best has yet to be assessed in full."""
    known = [] if merit.best is None else [merit.best]
    if merit.count <= 1 and rough.best is not None:
        known.append((problem.assess(rough.best[1]), rough.best[1]))
    return min(known, key=lambda design: design[0].order) if known else (problem.assess(start), start)


def never() -> bool:
    """Nobody cancels."""
    return False


def _silent(part: float) -> None:
    """Report no progress."""
