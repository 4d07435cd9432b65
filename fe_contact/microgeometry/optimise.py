"""Choose the micro-geometry of a pair: least expected peak-to-peak STE over torques and scatter."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fe_contact.analysis.solved_table import Progress
from fe_contact.checks import increasing
from fe_contact.errors import SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.microgeometry.confirmation import ConfirmedDesign, confirm
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.design_study import Accuracies, DesignStudy, check_study, design_study
from fe_contact.microgeometry.objective import NO_LIMITS, Limits, Objective, WeightedMean
from fe_contact.microgeometry.optimisation import Optimisation, Outcome, StepAside
from fe_contact.microgeometry.scatter import NO_SCATTER, Scatter
from fe_contact.microgeometry.search import NelderMead, Search, SearchRun, search_all, search_from
from fe_contact.microgeometry.variables import DesignVariable, check_variables, start_of
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess, Workers

MAP_PARTS = np.arange(1, 11) / 8.0
"""Torques of the Harris map in parts of the largest that counts."""
CLOSE = 0.03
"""Torques of the map this near to one that counts, in parts of the largest, are left out."""
STEP = 0.05
"""Step aside from the optimum in parts of a variable's range, where it does not scatter."""

SLACK = 0.005
"""Limits exceeded by less, in parts of them, are kept: the full analysis has more positions than a search."""
REFINED = 4
"""Where they are exceeded by more, a simplex goes on at those positions, with a quarter of the designs."""


def optimise(
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
    tolerance: float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    effects: Mapping[str, str] | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    progress: Progress | None = None,
    cache: Path | None = None,
) -> Optimisation:
    """Minimise the expected peak-to-peak transmission error over torques under scatter.

    The compliance of both gears is computed once; every design is then a contact solve with other gaps. The
    best design and the one to begin with are analysed in full at the end, and the gain is stated with the
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
        bounds, misaligned as it scatters: all designs are judged by one model.

    workers : Workers
        Who searches from the starts; the result does not depend on it.

    Returns
    -------
    Optimisation

    Raises
    ------
    InputError
        A value that cannot be used, by field name; a variable whose effect is off.
    MeshError, SolveError
        No acceptable mesh, or the contact of one of both designs cannot be solved.
    """
    clock, report = StageClock(), progress or _silent
    variables, accuracy = tuple(variables), Accuracies(tolerance, level, time_budget, model, effects)
    check_optimisation(pair, torques, variables, scatter, misalignment, objective, search, accuracy)
    acting = {one.name: one.acting for one in variables}
    further = _map(torques, map_torques)
    wanted = acting, scatter, misalignment, search.positions, accuracy
    study = design_study(pair, torques, further, *wanted, clock, report, cache)
    own = start_of(pair, variables)
    problem = _problem(study, variables, objective, limits, own)
    with clock.stage("search"):
        runs = search_all(problem, search, own, workers, report)
    best = min(range(len(runs)), key=lambda i: runs[i].judged.order)
    with clock.stage("confirmation"):
        start = confirm(problem, dict(zip(problem.names, own, strict=True)), study, cache)
        optimum = confirm(problem, problem.values(runs[best].place), study, cache)
    if optimum.violation > SLACK and runs[best].judged.violation <= SLACK:
        with clock.stage("search"):
            problem = replace(problem, evaluator=problem.evaluator.at(optimum.harris_map.position))
            runs = (*runs, _refined(problem, search, runs[best]))
            best = len(runs) - 1
        with clock.stage("confirmation"):
            optimum = confirm(problem, problem.values(runs[best].place), study, cache)
    report("confirmation", 1.0)
    with clock.stage("sensitivity"):
        aside = tuple(_aside(problem, runs[best], scatter, one) for one in variables)
    outcome, reason = _outcome(start, optimum, runs[best])
    return Optimisation(
        outcome=outcome,
        reason=reason,
        variables=variables,
        torque=study.torque,
        misalignment=misalignment,
        nodes=study.evaluator.nodes,
        start=start,
        optimum=optimum,
        runs=runs,
        best_run=best,
        sensitivity=aside,
        cost=clock.to_json() | {"evaluations": sum(run.evaluations for run in runs)},
        asked={
            "scatter": scatter.to_json(),
            "objective": objective.to_json(),
            "limits": limits.to_json(),
            "search": search.to_json(),
            "level": study.decided.mesh.level,
            "effects": study.decided.checked.decided,
        },
    )


def check_optimisation(
    pair: ParallelAxes,
    torques: Sequence[float] | FloatArray,
    variables: Sequence[DesignVariable],
    scatter: Scatter,
    misalignment: float,
    objective: Objective,
    search: Search,
    accuracy: Accuracies,
) -> None:
    """Check what `optimise` is given, without computing anything.

    Raises
    ------
    InputError
        As `optimise`.
    """
    check_variables(pair, variables)
    counted = increasing("torques", torques)
    objective.check(counted.size)
    acting = {one.name: one.acting for one in variables}
    check_study(pair, counted, acting, scatter, misalignment, search.positions, accuracy)


def _map(torques: Sequence[float] | FloatArray, asked: Sequence[float] | FloatArray | None) -> FloatArray:
    """Return the torques that only the maps show."""
    if asked is not None:
        return increasing("map_torques", asked)
    counted = np.asarray(torques, dtype=float)
    parts = MAP_PARTS * counted[-1]
    return np.asarray(parts[np.abs(parts[:, None] - counted).min(axis=1) > CLOSE * counted[-1]])


def _problem(
    study: DesignStudy,
    variables: tuple[DesignVariable, ...],
    objective: Objective,
    limits: Limits,
    own: tuple[float, ...],
) -> DesignProblem:
    """Scale the problem by the start inside the bounds.

    Raises
    ------
    SolveError
        Its contact cannot be solved.
    """
    problem = DesignProblem(study.evaluator, variables, objective, limits, 1.0)
    judged = problem.judge(problem.place(own))
    if not np.isfinite(judged.objective) or judged.objective <= 0.0:
        raise SolveError(
            "the contact of the design to begin with cannot be solved at every position and load"
        )
    return DesignProblem(study.evaluator, variables, objective, limits, judged.objective)


def _refined(problem: DesignProblem, search: Search, run: SearchRun) -> SearchRun:
    """Search on from the best design where it exceeds the limits between the positions of the search."""
    shorter = replace(search, method=NelderMead(), evaluations=max(1, search.evaluations // REFINED))
    return search_from(problem, shorter, run.place, search.starts)


def _aside(problem: DesignProblem, run: SearchRun, scatter: Scatter, one: DesignVariable) -> StepAside:
    """Take a step of one variable to both sides."""
    values = problem.values(run.place)
    step = scatter.modification.get(one.name, STEP * (one.high - one.low))
    ends = max(one.low, values[one.name] - step), min(one.high, values[one.name] + step)
    found = []
    for end in ends:
        evaluation = problem.evaluator.evaluate(values | {one.name: end})
        found.append(problem.objective.of(problem.evaluator.expected(evaluation)) - run.judged.objective)
    return StepAside(one.name, *ends, *found)


def _outcome(start: ConfirmedDesign, optimum: ConfirmedDesign, run: SearchRun) -> tuple[Outcome, str]:
    """Say what came of it."""
    gain = start.objective.value - optimum.objective.value
    error = start.objective.error + optimum.objective.error
    ended = "the search converged" if run.converged else "the search used all its evaluations"
    if optimum.violation > SLACK:
        over = f"{100.0 * optimum.violation:.2g} % of them, or of the load on tip edges"
        return Outcome.LIMITS_EXCEEDED, f"the best design exceeds the limits by {over}; {ended}"
    told = f"expected peak-to-peak falls by {1e6 * gain:.3g} um, errors {1e6 * error:.2g} um; {ended}"
    if start.violation > SLACK and gain <= error:
        return Outcome.LIMITS_KEPT, f"the limits are kept, which the start exceeds; {told}"
    if gain > error:
        return Outcome.IMPROVED, told
    return (Outcome.WITHIN_ERROR, told) if gain > 0.0 else (Outcome.NOT_IMPROVED, told)


def _silent(stage: str, fraction: float) -> None:
    """Report no progress."""
