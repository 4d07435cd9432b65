"""The conclusion of an optimization in words: the gain, its end, and what was not tried."""

from __future__ import annotations

import numpy as np

from bounds import engineering
from fe_contact.microgeometry.choice import SLACK, Choice
from fe_contact.microgeometry.design_study import DesignStudy
from fe_contact.microgeometry.harris_map import rising
from fe_contact.microgeometry.optimization import Outcome
from fe_contact.microgeometry.request import OptimizationRequest
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.search import Ended
from fe_contact.microgeometry.variables import GEARS, QUANTITIES

AT_BOUND = 1e-3
"""A variable this near to a bound, in parts of its range, lies on it."""


def conclusion(choice: Choice, request: OptimizationRequest) -> tuple[Outcome, str]:
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


def not_tried(choice: Choice, request: OptimizationRequest, study: DesignStudy) -> tuple[str, ...]:
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
