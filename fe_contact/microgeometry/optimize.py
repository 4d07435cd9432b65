"""Choose the micro-geometry of a pair: least expected peak-to-peak STE over torques and scatter.

A search has several starts: the start design of the request, and random designs within the bounds. A search
run is the result of one start. A walk is a descent from one design, with few positions and without scatter.
"""

from __future__ import annotations

from pathlib import Path

from fe_contact.microgeometry.best_design import Choice, choose, perturbation, search_problem, to_the_end
from fe_contact.microgeometry.conclusion import outcome_and_reason, untried_steps
from fe_contact.microgeometry.counted_merit import Cancelled
from fe_contact.microgeometry.design_problem import SearchProblem
from fe_contact.microgeometry.design_study import DesignStudy, design_study
from fe_contact.microgeometry.drawing_grid import best_on_grid
from fe_contact.microgeometry.optimization import Optimization, OptimizationRequest, Perturbation
from fe_contact.microgeometry.search import Ended, Search, SearchRun, search_from
from fe_contact.microgeometry.search_methods import Cancel, never
from fe_contact.options import Run
from fe_contact.types import FloatArray
from model_studies.stage_clock import StageClock
from model_studies.workers import InProcess, divided


def search_all(
    problem: SearchProblem,
    search: Search,
    start_design: tuple[float, ...],
    run: Run,
    cancel: Cancel,
) -> tuple[SearchRun, ...]:
    """Search from every start; `start_design` is the first start, m.

    Returns at least one run: where the search is cancelled before any run ended, the first start itself.
    """
    from scipy.stats import qmc  # noqa: PLC0415 (start-up time)

    first = problem.unit_point(start_design)
    # Sobol points come in powers of two; the first one is left out, as the start design takes its place
    others = qmc.Sobol(first.size, rng=search.seed).random_base2((search.starts - 1).bit_length())[
        1 : search.starts
    ]
    begins = list(enumerate([first, *others]))
    alone = search.starts == 1 or isinstance(run.workers, InProcess)
    search_starts = _local_runs if alone else _remote_runs
    runs = search_starts(problem, search, begins, run, cancel)
    if runs:
        return tuple(runs)
    assessed = problem.assess(first)
    return (SearchRun(first, assessed, evaluations=1, ended=Ended.CANCELLED, cpu_seconds=0.0),)


def _local_runs(
    problem: SearchProblem,
    search: Search,
    begins: list[tuple[int, FloatArray]],
    run: Run,
    cancel: Cancel,
) -> list[SearchRun]:
    runs: list[SearchRun] = []
    for index, start in begins:
        if cancel():
            break

        def report(part: float, index: int = index) -> None:
            run.progress("search", (index + part) / search.starts)

        runs.append(search_from(problem, search, start, index, report, cancel, workers=run.workers))
    return runs


def _remote_runs(
    problem: SearchProblem,
    search: Search,
    begins: list[tuple[int, FloatArray]],
    run: Run,
    cancel: Cancel,
) -> list[SearchRun]:
    """Search on workers, one task per start; a cancelled search returns the runs that have ended.

    A Ctrl-C that cancels may also have ended workers, so their errors are ignored then.
    """
    runs: list[SearchRun] = []
    try:
        for result in run.workers.run(_search_one, (problem, search), begins):
            runs.append(result)
            run.progress("search", len(runs) / search.starts)
            if cancel():
                break
    except Exception:
        if not cancel():
            raise
    return runs


def _search_one(shared: tuple[SearchProblem, Search], begin: tuple[int, FloatArray]) -> SearchRun:
    """Search from one start: one task. An interrupted worker returns its best design so far."""
    problem, search = shared
    index, start = begin
    return search_from(problem, search, start, index, ending=(Cancelled, KeyboardInterrupt))


def optimize(
    request: OptimizationRequest,
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    cancel: Cancel = never,
    memory: Path | None = None,
) -> Optimization:
    """Minimize the expected peak-to-peak transmission error over torques under scatter.

    The compliance of both gears is computed once; every design is a contact solve with other gaps. The best
    design and the start design are analyzed in full at the end, and the gain is stated with the errors of
    both.

    Parameters
    ----------
    request : OptimizationRequest
    run : Run
        Its workers search, one task per start. With one start they assess the designs, and take the walks,
        that do not wait for each other. They analyze the designs at the end.
    cancel : callable
        Asked before every design whether to end the search: the best so far is then analyzed in full, and
        the reason says so. Remote workers end their starts first.
    memory : Path, optional
        Directory of assessed designs: a search that was killed, or is repeated with more evaluations,
        continues with an identical result. Only for searches in this process.

    Raises
    ------
    InputError
        A value that cannot be used, by field name; a variable whose effect is off.
    MeshError, SolveError
        No acceptable mesh, or the contact of one of both designs cannot be solved.
    """
    clock = StageClock(run.workers.cost)
    study = design_study(
        request.space, request.torques, request.further_torques, clock, run, request.checked, request.limits
    )
    with clock.stage("search"):
        problem = search_problem(study, request, memory)
        runs = search_all(problem, request.search, request.start_design, run, cancel)
        runs = tuple(best_on_grid(problem, part, request.grid, cancel) for part in runs)
    choice = choose(problem, runs, request, study, clock, run, cancel)
    with clock.stage("sensitivity"):
        shared = choice.problem, choice.run, request.scatter  # argument of every task
        workers = to_the_end(run.workers, cancel)  # this process, once the search is cancelled
        perturbations = tuple(divided(workers, perturbation, shared, request.variables))
    run.progress("confirmation", 1.0)
    return _result(request, study, choice, perturbations, clock)


def _result(
    request: OptimizationRequest,
    study: DesignStudy,
    choice: Choice,
    perturbations: tuple[Perturbation, ...],
    clock: StageClock,
) -> Optimization:
    outcome, reason = outcome_and_reason(choice, request)
    return Optimization(
        outcome=outcome,
        reason=reason,
        variables=request.variables,
        torque=study.torque,
        misalignment=study.evaluator.misalignment,
        nodes=study.evaluator.nodes,
        start=choice.start,
        optimum=choice.optimum,
        runs=choice.runs,
        best_run=choice.best,
        sensitivity=perturbations,
        not_tried=untried_steps(choice, request, study),
        cost=clock.to_json() | {"evaluations": sum(run.evaluations for run in choice.runs)},
        request=request.to_json(study),
    )
