"""Choose the micro-geometry of a pair: least expected peak-to-peak STE over torques and scatter."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from bounds import engineering
from fe_contact.microgeometry.choice import SLACK, Choice, choose, perturbation, posed
from fe_contact.microgeometry.confirmation import DesignStudy, design_study, rising
from fe_contact.microgeometry.design_problem import DesignProblem
from fe_contact.microgeometry.optimization import Optimization, OptimizationRequest, Outcome, Perturbation
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.search import Cancel, Ended, Search, SearchRun, never, search_from
from fe_contact.microgeometry.search_method import Cancelled
from fe_contact.microgeometry.variables import GEARS, QUANTITIES
from fe_contact.options import Run
from fe_contact.stage_clock import StageClock
from fe_contact.types import FloatArray
from fe_contact.workers import InProcess

# The conclusion of an optimization in words: the gain, its end, and what was not tried.


AT_BOUND = 1e-3
"""A variable this near to a bound, in parts of its range, lies on it."""


def _conclusion(choice: Choice, request: OptimizationRequest) -> tuple[Outcome, str]:
    """Return the outcome and the reason for it."""
    start, optimum, ended = choice.start, choice.optimum, _ended(choice, request)
    gain = start.objective.value - optimum.objective.value
    error = start.objective.error + optimum.objective.error
    if optimum.violation > SLACK:
        over = f"{engineering(100.0 * optimum.violation, 2)} % of them, or of the load on tip edges"
        return (
            Outcome.LIMITS_EXCEEDED,
            f"the best design exceeds the limits by {over}{_worse(choice)}; {ended}",
        )
    moved = "falls" if gain >= 0.0 else "rises"
    change = (
        f"expected peak-to-peak {moved} by {1e6 * abs(gain):.3g} um, errors {engineering(1e6 * error, 2)} um"
        f"{_worse(choice)}"
    )
    if gain > error:
        return Outcome.IMPROVED, f"{change}; {ended}"
    if start.violation > SLACK:
        return Outcome.LIMITS_KEPT, f"the limits are kept, which the start exceeds; {change}; {ended}"
    outcome = Outcome.WITHIN_ERROR if gain > 0.0 else Outcome.NOT_IMPROVED
    return outcome, f"{change}; {_why_not(choice, request, error)}{ended}"


def _worse(choice: Choice) -> str:
    """Name the torques at which the best design ripples more than the start, whether they count or not."""
    before, after = choice.start.harris_map, choice.optimum.harris_map
    worse = rising(before, after)
    if not worse.size:
        return ""
    torques = ", ".join(f"{torque:.6g}" for torque in before.torque[worse])
    most = worse[np.argmax((after.expected - before.expected)[worse])]
    change = f"{1e6 * before.expected[most]:.3g} to {1e6 * after.expected[most]:.3g} um"
    return f"; it rises at {torques} N m, most at {before.torque[most]:.6g} N m from {change}"


def _ended(choice: Choice, request: OptimizationRequest) -> str:
    """Say how the search ended; one that was interrupted may have had more to find in any of its starts."""
    cut = any(run.ended is Ended.CANCELLED for run in choice.runs)
    if cut or len(choice.runs) < request.search.starts:
        count = sum(run.evaluations for run in choice.runs)
        most = request.search.starts * request.search.evaluations
        return f"the search was interrupted after {count} of at most {most} designs"
    return "the search converged" if choice.run.converged else "the search used all its evaluations"


def _why_not(choice: Choice, request: OptimizationRequest, error: float) -> str:
    """Say why nothing was won, where the search shows it."""
    if request.outside:
        return f"the start lies beyond the bounds of {', '.join(request.outside)}; "
    spread = max(run.spread for run in choice.runs)
    if choice.run.converged and spread <= error:
        return f"the variables have no influence: all designs lie within {engineering(1e6 * spread, 2)} um; "
    return ""


def _not_tried(choice: Choice, request: OptimizationRequest, study: DesignStudy) -> tuple[str, ...]:
    """Say what the design is the best without: what did not vary, what did not scatter, what was left out."""
    free = {variable.name for variable in request.variables}
    kept = [f"{gear}.{name}" for gear in GEARS for name in QUANTITIES if f"{gear}.{name}" not in free]
    spread = (*((MISALIGNMENT,) if request.scatter.misalignment else ()), *request.scatter.modification)
    off = [name for name, choice_of in study.decided.checked.decided.items() if choice_of == "off"]
    bounds = _on_bounds(choice, request)
    starts = "one start" if request.search.starts == 1 else f"{request.search.starts} starts"
    untried = [
        f"wider bounds of {', '.join(bounds)}, which the optimum lies on" if bounds else "",
        f"other values of {', '.join(kept)}" if kept else "",
        f"scatter of anything but {', '.join(spread)}" if spread else "scatter of anything",
        f"neglected effects: {', '.join(off)}" if off else "",
        f"other searches than {starts} of {request.search.method.to_json()['method'].replace('_', ' ')}; "
        "ripple has many local minima",
        "other center distances, and torques without weight",
    ]
    return tuple(filter(None, untried))


def _on_bounds(choice: Choice, request: OptimizationRequest) -> list[str]:
    """Variables whose optimum lies on a bound that is not the end of what there is: nothing removed."""
    names = []
    for variable, part in zip(request.variables, np.asarray(choice.run.place), strict=True):
        low, high = part <= AT_BOUND, part >= 1.0 - AT_BOUND
        if high or (low and variable.low != 0.0):
            names.append(variable.name)
    return names


# Searches from several starts, here or by workers; cancelled, what they found so far is kept.


def _search_all(
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
        for result in run.workers.run(_search_one, (bare, search), begins):
            runs.append(result)
            run.progress("search", len(runs) / search.starts)
            if cancel():
                break
    except Exception:
        if not cancel():
            raise
    return runs


def _search_one(shared: tuple[DesignProblem, Search], begin: tuple[int, FloatArray]) -> SearchRun:
    """Search from one start: one task; an interrupted worker gives what it has."""
    return search_from(*shared, begin[1], begin[0], ending=(Cancelled, KeyboardInterrupt))


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
        runs = _search_all(problem, request.search, request.own, run, cancel)
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
    outcome, reason = _conclusion(choice, request)
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
        not_tried=_not_tried(choice, request, study),
        cost=clock.to_json() | {"evaluations": sum(run.evaluations for run in choice.runs)},
        asked=request.to_json(study),
    )
