"""One search of the best design: repeatable from a seed; it ends converged, used up, or cancelled."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from fe_contact.errors import integer
from fe_contact.microgeometry.counted_merit import Budget, BudgetUsed, Cancelled, CountedMerit
from fe_contact.microgeometry.design_problem import Assessed, SearchProblem
from fe_contact.microgeometry.search_methods import (
    EXPLORED,
    FOLLOWED,
    LINEARIZED,
    TRIED,
    Cancel,
    DifferentialEvolution,
    Method,
    SequentialLinearProgramming,
    StagedLinearProgramming,
    never,
)
from fe_contact.types import FloatArray, Json
from model_studies.progress import unreported
from model_studies.record import under_key
from model_studies.workers import InProcess, Workers, WorkersLost, spent


class Ended(StrEnum):
    """The reason why a search ended."""

    CONVERGED = "converged"
    SPENT = "designs used"
    CANCELLED = "interrupted"


@dataclass(frozen=True)
class Search:
    """The method and the size of a search."""

    method: Method = SequentialLinearProgramming()  # noqa: RUF009 (frozen)
    seed: int = 0
    """Seed of all random numbers: equal searches give equal results."""
    starts: int = 1
    """Independent searches; the first starts at the given pair, others at points of a Sobol' sequence."""
    evaluations: int = 1000
    """Largest number of designs that each search evaluates."""
    positions: int = 64
    """Number of equally spaced positions in a base pitch; the analysis at the end places its own positions.
    """
    exploration: int = 16
    """Number of positions by which designs are ranked before any is followed, at most `positions`."""

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


def usual_designs(search: Search) -> float:
    """Return the cost of a usual search, in assessments of a design at all positions."""
    share, maximum, method = (
        min(search.exploration / search.positions, 1.0),
        float(search.evaluations),
        search.method,
    )
    explored = EXPLORED * maximum
    if isinstance(method, DifferentialEvolution):
        return search.starts * (share * explored + maximum - explored)
    if not isinstance(method, (SequentialLinearProgramming, StagedLinearProgramming)):
        return search.starts * maximum
    explored = min(method.sample, explored)
    walked = min((method.trials + 1) * (TRIED + 1) + FOLLOWED, maximum - explored)
    return search.starts * (share * explored + LINEARIZED * walked)


@dataclass(frozen=True)
class SearchRun:
    """The result of one start of a search."""

    coordinates: FloatArray = field(metadata=under_key("place"))
    """Best design, in parts of the ranges of the variables. Shape (d,)."""
    assessed: Assessed
    evaluations: int
    ended: Ended
    cpu_seconds: float
    explored: int = 0
    """Number of the evaluations that took few positions."""
    spread: float = 0.0
    """Largest less least objective of all other runs."""
    ends: tuple[float, ...] = ()
    """Objectives at which walks from each start ended, by few positions and without scatter; only walks that
    keep the limits best.
    """

    @property
    def converged(self) -> bool:
        """Whether it ended by itself."""
        return self.ended is Ended.CONVERGED


def search_from(
    problem: SearchProblem,
    search: Search,
    start: FloatArray,
    index: int,
    report: Callable[[float], None] | None = None,
    cancel: Cancel | None = None,
    ending: tuple[type[BaseException], ...] = (Cancelled,),
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SearchRun:
    """Search from one start.

    Parameters
    ----------
    start : ndarray, shape (d,)
        In the unit cube.
    index : int
        Of the start: each draws its own random numbers.
    report : callable, optional
        Called with the part of the work done, by the usual cost of a search.
    cancel : callable, optional
        Asked before each design whether to end with the best so far, and when workers are lost.
    ending : tuple of exception types
        By which it is cancelled.
    workers : Workers
        Who assesses designs, and takes walks, that do not wait for each other.
    """
    spent_before = spent(workers)
    usual = usual_designs(search) / search.starts
    budget = Budget(search.evaluations, cancel or never, report or unreported, usual)
    linear = isinstance(search.method, (SequentialLinearProgramming, StagedLinearProgramming))
    merit = CountedMerit(problem, budget, search.evaluations, workers, LINEARIZED if linear else 1.0)
    explored, few = int(EXPLORED * search.evaluations), min(search.exploration / search.positions, 1.0)
    rough = CountedMerit(problem.rough(search.exploration), budget, explored, workers, few)
    ended = Ended.CONVERGED
    try:
        search.method.minimize(merit, rough, start, np.random.SeedSequence((search.seed, index)))
    except BudgetUsed:
        ended = Ended.SPENT
    except ending:
        ended = Ended.CANCELLED
    except WorkersLost:
        if not budget.cancelled():
            raise
        ended = Ended.CANCELLED
    assessed, point = _best(problem, merit, rough, start)
    seconds = spent(workers) - spent_before
    exploration = len(rough.designs), merit.spread, rough.levels
    return SearchRun(point, assessed, budget.used, ended, seconds, *exploration)


def _best(
    problem: SearchProblem, merit: CountedMerit, rough: CountedMerit, start: FloatArray
) -> tuple[Assessed, FloatArray]:
    """Return the best design; where exploration was cut short its best has yet to be assessed in full."""
    known = [] if merit.best is None else [merit.best]
    if len(merit.designs) <= 1 and rough.best is not None:
        known.append((problem.assess(rough.best[1]), rough.best[1]))
    return min(known, key=lambda design: design[0].order) if known else (problem.assess(start), start)
