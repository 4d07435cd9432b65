"""Searches from several starts, here or by workers; cancelled, what they found so far is kept."""

from __future__ import annotations

from dataclasses import replace

from scipy.stats import qmc

from fe_contact.microgeometry.counted_merit import Cancelled
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.search import Cancel, Ended, Search, SearchRun, search_from
from fe_contact.options import Run
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess


def search_all(
    problem: DesignProblem,
    search: Search,
    own: tuple[float, ...],
    run: Run,
    cancel: Cancel,
) -> tuple[SearchRun, ...]:
    """Search from every start; `own` is the design to begin with, m.

    At least one run: where the search is cancelled before any has ended, that of the design to begin with.
    """
    first = problem.place(own)
    others = qmc.Sobol(first.size, rng=search.seed).random_base2((search.starts - 1).bit_length())[
        1 : search.starts
    ]
    begins = list(enumerate([first, *others]))
    search_from_each = _here if isinstance(run.workers, InProcess) else _remotely
    runs = search_from_each(problem, search, begins, run, cancel)
    return tuple(runs) or (SearchRun(first, problem.assess(first), 1, Ended.CANCELLED, 0.0),)


def _here(
    problem: DesignProblem,
    search: Search,
    begins: list[tuple[int, FloatArray]],
    run: Run,
    cancel: Cancel,
) -> list[SearchRun]:
    """Search from one start after the other."""
    runs: list[SearchRun] = []
    for index, start in begins:
        if cancel():
            break

        def report(part: float, index: int = index) -> None:
            run.progress("search", (index + part) / search.starts)

        runs.append(search_from(problem, search, start, index, report, cancel))
    return runs


def _remotely(
    problem: DesignProblem,
    search: Search,
    begins: list[tuple[int, FloatArray]],
    run: Run,
    cancel: Cancel,
) -> list[SearchRun]:
    """Let workers search; cancelled, keep what is there: a Ctrl-C may have ended some of them."""
    runs: list[SearchRun] = []
    try:
        bare = replace(problem, memory=None)  # a file of this machine, for one writer
        for result in run.workers.run(search_one, (bare, search), begins):
            runs.append(result)
            run.progress("search", len(runs) / search.starts)
            if cancel():
                break
    except Exception:
        if not cancel():
            raise
    return runs


def search_one(shared: tuple[DesignProblem, Search], begin: tuple[int, FloatArray]) -> SearchRun:
    """Search from one start: one task; an interrupted worker gives what it has."""
    return search_from(*shared, begin[1], begin[0], ending=(Cancelled, KeyboardInterrupt))
