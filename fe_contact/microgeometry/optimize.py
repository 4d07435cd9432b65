"""Choose the micro-geometry of a pair: least expected peak-to-peak STE over torques and scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from fe_contact.allowed_error import AllowedError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.choice import Choice, choose, perturbation, posed
from fe_contact.microgeometry.conclusion import conclusion, not_tried
from fe_contact.microgeometry.design_study import Accuracies, DesignStudy, design_study
from fe_contact.microgeometry.objective import NO_LIMITS, Limits, Objective, WeightedMean
from fe_contact.microgeometry.optimization import Optimization, Perturbation
from fe_contact.microgeometry.request import OptimizationRequest
from fe_contact.microgeometry.scatter import NO_SCATTER, Scatter
from fe_contact.microgeometry.search import Cancel, Search, never
from fe_contact.microgeometry.search_starts import search_all
from fe_contact.microgeometry.variables import DesignVariable
from fe_contact.progress import Progress, silent
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess, Workers


def optimize(
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray,
    variables: Sequence[DesignVariable],
    scatter: Scatter = NO_SCATTER,
    *,
    misalignment: float = 0.0,
    objective: Objective = WeightedMean(),  # noqa: B008 (frozen)
    limits: Limits = NO_LIMITS,
    search: Search = Search(),  # noqa: B008 (frozen)
    map_torques: Sequence[float] | FloatArray | None = None,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    effects: Mapping[str, str] | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    cancel: Cancel | None = None,
    progress: Progress | None = None,
    cache: Path | None = None,
    memory: Path | None = None,
) -> Optimization:
    """Minimize the expected peak-to-peak transmission error over torques under scatter.

    The compliance of both gears is computed once; every design is then a contact solve with other gaps. The
    best design and the one to begin with are analyzed in full at the end, and the gain is stated with the
    errors of both.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Its own modifications are the start; those that are no variables stay.
    torques : sequence of float
        That count, N m on the driving gear, increasing.
    variables : sequence of DesignVariable
    scatter : Scatter
        Of misalignment and modifications, about the design.
    misalignment : float
        About which it scatters, m.
    objective : Objective
        `WeightedMean` or `Worst` of the expectations at the torques.
    limits : Limits
        Pressure, face load factor, load on tip edges.
    search : Search
        Method, seed, starts, evaluations, positions.
    map_torques : sequence of float, optional
        Further torques of the Harris maps, N m; default: up to 1.25 times the largest that counts.
    tolerance, level, time_budget, model, effects, progress, cache
        See `analyze`. Effects are decided once, for a design in which every variable is at the middle of its
        bounds, misaligned as it scatters: all designs are assessed by one model.
    workers : Workers
        Who searches from the starts; the result does not depend on it.
    cancel : callable, optional
        Asked before every design whether to end the search: the best so far is then analyzed in full, and
        the reason says so. Remote workers end their starts first.
    memory : Path, optional
        Directory of designs that were assessed before: a search that was killed, or is repeated with more
        evaluations, goes on where it was, and finds what it would have found without. Only of searches in
        this process.

    Returns
    -------
    Optimization

    Raises
    ------
    InputError
        A value that cannot be used, by field name; a variable whose effect is off.
    MeshError, SolveError
        No acceptable mesh, or the contact of one of both designs cannot be solved.
    """
    clock, report, cancelled = StageClock(), progress or silent, cancel or never
    accuracy = Accuracies(tolerance, level, time_budget, model, effects)
    assessed = scatter, misalignment, objective, limits
    asked = OptimizationRequest(pair, torques, tuple(variables), *assessed, search, accuracy, map_torques)
    asked.check()
    wanted = asked.acting, scatter, misalignment, search.positions, accuracy
    study = design_study(pair, torques, asked.further_torques, *wanted, clock, report, cache)
    with clock.stage("search"):
        problem = posed(study, asked, memory)
        runs = search_all(problem, search, asked.own, workers, report, cancelled)
    choice = choose(problem, runs, asked, study, clock, cache, cancelled)
    report("confirmation", 1.0)
    with clock.stage("sensitivity"):
        aside = tuple(perturbation(choice.problem, choice.run, scatter, one) for one in asked.variables)
    return _result(asked, study, choice, aside, clock)


def _result(
    asked: OptimizationRequest,
    study: DesignStudy,
    choice: Choice,
    aside: tuple[Perturbation, ...],
    clock: StageClock,
) -> Optimization:
    """Put together what was found."""
    outcome, reason = conclusion(choice, asked)
    return Optimization(
        outcome=outcome,
        reason=reason,
        variables=asked.variables,
        torque=study.torque,
        misalignment=asked.misalignment,
        nodes=study.evaluator.nodes,
        start=choice.start,
        optimum=choice.optimum,
        runs=choice.runs,
        best_run=choice.best,
        sensitivity=aside,
        not_tried=not_tried(choice, asked, study),
        cost=clock.to_json() | {"evaluations": sum(run.evaluations for run in choice.runs)},
        asked=asked.to_json(study),
    )
