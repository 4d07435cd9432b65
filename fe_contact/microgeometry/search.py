"""Search of the best design: repeatable from a seed, ended by convergence or by the number of evaluations."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.optimize import Bounds, differential_evolution, minimize
from scipy.stats import qmc

from fe_contact.analysis.solved_table import Progress
from fe_contact.checks import integer
from fe_contact.microgeometry.design_problem import DesignProblem, Judged
from fe_contact.types import FloatArray, Json
from fe_contact.workers import InProcess, Workers

Merit = Callable[[FloatArray], float]
SIMPLEX_SIZE, SIMPLEX_MERIT = 1e-3, 1e-4
"""A simplex this small has converged: parts of the range of a variable, and of the merit of the start."""
EDGE = 0.2
"""Of the first simplex, in parts of the ranges, towards the inside."""
SPREAD = 1e-3
"""Standard deviation of the merit over a population that has converged, in parts of its mean."""


class Method(Protocol):
    """A way to search the unit cube."""

    def minimise(self, merit: Merit, start: FloatArray, seed: np.random.SeedSequence) -> None:
        """Search from `start` (d,) until converged; the merit remembers the best and may end the search."""
        ...

    def to_json(self) -> Json:
        """Return plain JSON."""
        ...


@dataclass(frozen=True)
class NelderMead:
    """Simplex of Nelder and Mead (1965) in bounds, its coefficients by dimension (Gao and Han 2012).

    Cheap and local: start it more than once.
    """

    def minimise(self, merit: Merit, start: FloatArray, seed: np.random.SeedSequence) -> None:
        """Search; nothing is random."""
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
class DifferentialEvolution:
    """Differential evolution (Storn and Price 1997), then a simplex from its best.

    Attributes
    ----------
    population : int
        Individuals for each variable, 3 to 50.
    """

    population: int = 5

    def __post_init__(self) -> None:
        integer("method.population", self.population, 3, 50)

    def minimise(self, merit: Merit, start: FloatArray, seed: np.random.SeedSequence) -> None:
        """Search; the start is one of the first population."""
        found = differential_evolution(
            merit,
            Bounds(np.zeros(start.size), np.ones(start.size)),
            x0=start,
            rng=np.random.default_rng(seed),
            popsize=self.population,
            tol=SPREAD,
            maxiter=10**6,
            polish=False,
        )
        NelderMead().minimise(merit, np.asarray(found.x), seed)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {"method": "differential_evolution", "population": self.population}


@dataclass(frozen=True)
class Search:
    """How designs are searched.

    Attributes
    ----------
    method : Method
    seed : int
        Of all that is random: equal searches give equal results.
    starts : int
        Independent searches; the first begins at the pair as it is, others at points of a Sobol' sequence.
    evaluations : int
        Most designs that each of them evaluates.
    positions : int
        Equally spaced in a base pitch; the analysis at the end places its own.
    """

    method: Method = DifferentialEvolution()
    seed: int = 0
    starts: int = 1
    evaluations: int = 1000
    positions: int = 64

    def __post_init__(self) -> None:
        integer("search.seed", self.seed, 0, 2**32 - 1)
        integer("search.starts", self.starts, 1, 256)
        integer("search.evaluations", self.evaluations, 1, 10**6)

    def to_json(self) -> Json:
        """Return plain JSON."""
        return self.method.to_json() | {
            "seed": self.seed,
            "starts": self.starts,
            "evaluations": self.evaluations,
            "positions": self.positions,
        }


@dataclass(frozen=True)
class SearchRun:
    """What one start of a search found.

    Attributes
    ----------
    place : ndarray, shape (d,)
        Best design, in parts of the ranges of the variables.
    judged : Judged
    evaluations : int
    converged : bool
        False: the evaluations were spent before.
    cpu_seconds : float
    """

    place: FloatArray
    judged: Judged
    evaluations: int
    converged: bool
    cpu_seconds: float

    def to_json(self) -> Json:
        """Return plain JSON."""
        return {
            "objective_m": self.judged.objective,
            "violation": self.judged.violation,
            "evaluations": self.evaluations,
            "converged": self.converged,
            "cpu_seconds": self.cpu_seconds,
        }


class _Spent(Exception):
    """All evaluations are used."""


def search_all(
    problem: DesignProblem, search: Search, own: tuple[float, ...], workers: Workers, report: Progress
) -> tuple[SearchRun, ...]:
    """Search from every start; `own` is the design to begin with, m."""
    first = problem.place(own)
    others = qmc.Sobol(first.size, rng=search.seed).random_base2((search.starts - 1).bit_length())[
        1 : search.starts
    ]

    begins = list(enumerate([first, *others]))
    if isinstance(workers, InProcess):

        def run(index: int, start: FloatArray) -> SearchRun:
            told = lambda part: report("search", (index + part) / search.starts)  # noqa: E731
            return search_from(problem, search, start, index, told)

        return tuple(run(*begin) for begin in begins)
    runs = []
    for one in workers.run(search_one, (problem, search), begins):
        runs.append(one)
        report("search", len(runs) / search.starts)
    return tuple(runs)


def search_one(shared: tuple[DesignProblem, Search], begin: tuple[int, FloatArray]) -> SearchRun:
    """Search from one start: one task."""
    return search_from(*shared, begin[1], begin[0])


def search_from(
    problem: DesignProblem,
    search: Search,
    start: FloatArray,
    index: int,
    report: Callable[[float], None] | None = None,
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
    """
    begun = time.process_time()
    best: list[tuple[Judged, FloatArray]] = []
    count = 0

    def merit(place: FloatArray) -> float:
        nonlocal count
        if count >= search.evaluations:
            raise _Spent
        judged = problem.judge(place)
        count += 1
        if not best or judged.order < best[0][0].order:
            best[:] = [(judged, np.clip(place, 0.0, 1.0))]
        if report is not None:
            report(count / search.evaluations)
        return judged.merit

    try:
        search.method.minimise(merit, start, np.random.SeedSequence((search.seed, index)))
        converged = True
    except _Spent:
        converged = False
    judged, place = best[0]
    return SearchRun(place, judged, count, converged, time.process_time() - begun)
