"""The best design of all searches, assessed by full analyses of this design and of the start design."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from fe_contact.errors import SolveError
from fe_contact.microgeometry.confirmation import ConfirmedDesign, confirm
from fe_contact.microgeometry.design_memory import DesignMemory
from fe_contact.microgeometry.design_problem import SLACK, DesignProblem
from fe_contact.microgeometry.design_study import DesignStudy
from fe_contact.microgeometry.drawing_grid import best_on_grid
from fe_contact.microgeometry.objective import NO_LIMITS
from fe_contact.microgeometry.optimization import OptimizationRequest, Perturbation
from fe_contact.microgeometry.scatter import Scatter
from fe_contact.microgeometry.search import SearchRun, search_from
from fe_contact.microgeometry.search_methods import Cancel, SequentialLinearProgramming
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.options import Run
from model_studies.progress import Report, unreported
from model_studies.stage_clock import StageClock
from model_studies.workers import InProcess, LocalFallback, Workers, WorkersLost, divided

REFINED = 4
"""Number of designs of a search over that of a further search. A further search follows where the best design
exceeds the limits in the full analysis; it adds the positions of that analysis.
"""

ROUNDS = 3
"""Most further searches. Each adds the positions of the last full analysis to those of all searches before.
"""

LIMITED = 0.25
"""Share of the first two analyses in the confirmation of a search with limits, where one may follow."""

SEARCHED = 0.85
"""Usual share of a further search in its cost with the analysis that follows."""

STEP = 0.05
"""Perturbation of the optimum over the range of a variable that does not scatter."""


@dataclass(frozen=True)
class Choice:
    """Start and optimum after full analyses."""

    problem: DesignProblem
    """Problem of the search that found the optimum."""
    start: ConfirmedDesign
    optimum: ConfirmedDesign
    runs: tuple[SearchRun, ...]
    best: int
    """Index of the search that found the optimum, among the `runs`."""

    @property
    def run(self) -> SearchRun:
        """The search that found the optimum."""
        return self.runs[self.best]


def search_problem(study: DesignStudy, request: OptimizationRequest, memory: Path | None) -> DesignProblem:
    """Return the problem of the search; its scale is the objective of the start design.

    `memory` is a directory of designs that were assessed before. Raises `SolveError`: the contact of the
    start design cannot be solved.
    """
    problem = DesignProblem(
        study.evaluator, request.variables, request.limits, scale=1.0, objective=request.objective
    )
    if memory is not None:
        problem = replace(problem, memory=DesignMemory.of(memory, request, study.evaluator))
    assessed = problem.assess(problem.unit_point(request.start_design))
    if not np.isfinite(assessed.objective) or assessed.objective <= 0.0:
        raise SolveError("the contact of the start design cannot be solved at every position and load")
    return replace(problem, scale=assessed.objective)


def choose(
    problem: DesignProblem,
    runs: tuple[SearchRun, ...],
    request: OptimizationRequest,
    study: DesignStudy,
    clock: StageClock,
    run: Run,
    cancel: Cancel,
) -> Choice:
    """Confirm the start and the best of all runs; search on while the confirmed best exceeds the limits."""
    best = min(range(len(runs)), key=lambda i: runs[i].assessed.order)
    with clock.stage("confirmation"):
        start_values = dict(zip(problem.names, request.start_design, strict=True))
        designs = start_values, problem.values(runs[best].coordinates)
        share = LIMITED if request.limits != NO_LIMITS else 1.0
        workers = to_the_end(run.workers, cancel)
        start, optimum = _confirmed(problem, study, designs, replace(run, workers=workers), share)
    choice = Choice(problem, start, optimum, runs, best)

    def report(fraction: float) -> None:
        run.progress("confirmation", LIMITED + (1.0 - LIMITED) * fraction)

    for number in range(ROUNDS):
        if choice.optimum.violation <= SLACK or choice.run.assessed.violation > SLACK or cancel():
            break
        expected = report if number == 0 else unreported  # one further search is usual
        choice = _refined_choice(choice, request, study, clock, run, cancel, expected)
    return choice


def _confirmed(
    problem: DesignProblem,
    study: DesignStudy,
    designs: tuple[dict[str, float], ...],
    run: Run,
    share: float,
) -> list[ConfirmedDesign]:
    """Analyze designs in full, which is `share` of the stage; workers tell of whole designs alone."""
    part = share / len(designs)

    def report(fraction: float, number: int) -> None:
        run.progress("confirmation", part * (number + fraction))

    if isinstance(run.workers, InProcess):
        return [
            confirm(problem, values, study, run.cache, partial(report, number=number))
            for number, values in enumerate(designs)
        ]
    seconds = len(designs) * study.decision.checked.predicted(study.decision.plan, run.cache).cpu_seconds
    confirmed = []
    for design in divided(run.workers, _confirmed_design, (problem, study, run.cache), designs, seconds):
        confirmed.append(design)
        report(1.0, len(confirmed) - 1)
    return confirmed


def _confirmed_design(
    shared: tuple[DesignProblem, DesignStudy, Path | None], values: dict[str, float]
) -> ConfirmedDesign:
    """Analyze a design in full: one task."""
    problem, study, cache = shared
    return confirm(problem, values, study, cache)


def _refined_choice(
    choice: Choice,
    request: OptimizationRequest,
    study: DesignStudy,
    clock: StageClock,
    run: Run,
    cancel: Cancel,
    report: Report,
) -> Choice:
    """Search on from a design that exceeds the limits between the positions of the search.

    `report`: called with the fraction done of the search and the analysis after it.
    """
    search = request.search
    shorter = replace(
        search,
        method=SequentialLinearProgramming(sample=0),
        evaluations=max(1, search.evaluations // REFINED),
    )
    evaluator = choice.problem.evaluator
    positions = np.union1d(evaluator.position, choice.optimum.harris_map.position)
    problem = replace(choice.problem, evaluator=evaluator.at(positions))
    with clock.stage("search"):
        best, workers = choice.run.coordinates, run.workers

        def searched(fraction: float) -> None:
            report(SEARCHED * fraction)

        further = search_from(problem, shorter, best, search.starts, searched, cancel, workers=workers)
        further = best_on_grid(problem, further, request.grid, cancel)
    with clock.stage("confirmation"):

        def analyzed(fraction: float) -> None:
            report(SEARCHED + (1.0 - SEARCHED) * fraction)

        optimum = confirm(problem, problem.values(further.coordinates), study, run.cache, analyzed)
    return Choice(problem, choice.start, optimum, (*choice.runs, further), len(choice.runs))


def perturbation(best: tuple[DesignProblem, SearchRun, Scatter], variable: DesignVariable) -> Perturbation:
    """Perturb the best design of a run by a step of one variable to both sides: one task."""
    problem, run, scatter = best
    values = problem.values(run.coordinates)
    step = scatter.modification.get(variable.name, STEP * (variable.high - variable.low))
    value = values[variable.name]
    ends = max(variable.low, value - step), min(variable.high, value + step)
    changes = []
    for end in ends:
        evaluation = problem.evaluator.evaluate(values | {variable.name: end})
        changes.append(problem.objective_of(evaluation) - run.assessed.objective)
    return Perturbation(variable.name, *ends, *changes)


def to_the_end(workers: Workers, cancel: Cancel) -> Workers:
    """Return the workers of the steps after a search; once it is cancelled this process does their tasks."""
    if cancel() or isinstance(workers, InProcess):
        return InProcess()

    def raise_unless_cancelled(error: WorkersLost) -> None:
        if not cancel():
            raise error

    return LocalFallback(workers, raise_unless_cancelled)
