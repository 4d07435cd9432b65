"""Choose the micro-geometry of a pair: least expected peak-to-peak STE over torques and scatter."""

from __future__ import annotations

from pathlib import Path

from fe_contact.microgeometry.choice import Choice, choose, perturbation, posed
from fe_contact.microgeometry.conclusion import conclusion, not_tried
from fe_contact.microgeometry.design_study import DesignStudy, design_study
from fe_contact.microgeometry.optimization import Optimization, Perturbation
from fe_contact.microgeometry.request import OptimizationRequest
from fe_contact.microgeometry.search import Cancel, never
from fe_contact.microgeometry.search_starts import search_all
from fe_contact.options import Run
from fe_contact.stage_clock import StageClock


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
        Its workers run the searches, one per start.
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
    request.check()
    study = design_study(request.space, request.torques, request.further_torques, clock, run)
    with clock.stage("search"):
        problem = posed(study, request, memory)
        runs = search_all(problem, request.search, request.own, run, cancel)
    choice = choose(problem, runs, request, study, clock, run.cache, cancel)
    run.progress("confirmation", 1.0)
    with clock.stage("sensitivity"):
        aside = tuple(perturbation(choice.problem, choice.run, request.scatter, v) for v in request.variables)
    return _result(request, study, choice, aside, clock)


def _result(
    request: OptimizationRequest,
    study: DesignStudy,
    choice: Choice,
    aside: tuple[Perturbation, ...],
    clock: StageClock,
) -> Optimization:
    """Put the result together."""
    outcome, reason = conclusion(choice, request)
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
        sensitivity=aside,
        not_tried=not_tried(choice, request, study),
        cost=clock.to_json() | {"evaluations": sum(run.evaluations for run in choice.runs)},
        asked=request.to_json(study),
    )
