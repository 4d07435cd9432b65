"""The grid of a drawing: the values that its dimensions may have, and the best design on them.

A point is a design in parts of the ranges of its variables, as a search has it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fe_contact.microgeometry.design_problem import Assessed, SearchProblem
from fe_contact.microgeometry.search import SearchRun
from fe_contact.microgeometry.search_methods import Cancel
from fe_contact.types import FloatArray
from model_studies.workers import InProcess, Workers, spent

Grid = Mapping[str, FloatArray]
"""Values of each variable that a drawing may state, m, increasing; a variable that is missing is free."""
ROUNDS = 2
"""Most rounds over all variables, each of which tries the values beside its own."""


def best_on_grid(
    problem: SearchProblem,
    run: SearchRun,
    grid: Grid,
    cancel: Cancel,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SearchRun:
    """Return the run of a search with the best design of the grid near its own.

    The nearest design of the grid is improved by one variable at a time, to the next value on either side.
    """
    free = {name: values for name, values in grid.items() if name in problem.names and values.size}
    if not free:
        return run
    spent_before, count = spent(workers), 0
    best, index = _nearest(problem, run.coordinates, free)
    assessed = problem.assess(best)
    count += 1
    for _ in range(ROUNDS):
        before = assessed.order
        for name, values in free.items():
            for step in (-1, 1):
                at = index[name] + step
                if cancel() or not 0 <= at < values.size:
                    continue
                point = _with(problem, best, name, float(values[at]))
                other = problem.assess(point)
                count += 1
                if _is_better(other, assessed):
                    best, assessed, index = point, other, {**index, name: at}
        if assessed.order >= before:
            break
    seconds = run.cpu_seconds + spent(workers) - spent_before
    return replace(
        run,
        coordinates=best,
        assessed=assessed,
        evaluations=run.evaluations + count,
        cpu_seconds=seconds,
    )


def _nearest(problem: SearchProblem, point: FloatArray, grid: Grid) -> tuple[FloatArray, dict[str, int]]:
    """Return the design of the grid nearest to a point, and the index of its value of each variable."""
    values = problem.values(point)
    index = {name: int(np.abs(allowed - values[name]).argmin()) for name, allowed in grid.items()}
    for name, allowed in grid.items():
        point = _with(problem, point, name, float(allowed[index[name]]))
    return point, index


def _with(problem: SearchProblem, point: FloatArray, name: str, value: float) -> FloatArray:
    """Return a point with another value of one variable, m."""
    at = problem.names.index(name)
    variable = problem.variables[at]
    changed = point.copy()
    changed[at] = (value - variable.low) / (variable.high - variable.low)
    return changed


def _is_better(one: Assessed, other: Assessed) -> bool:
    return one.order < other.order
