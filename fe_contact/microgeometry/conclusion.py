"""The conclusion of an optimization in words: the gain, its end, and what was not tried."""

from __future__ import annotations

import numpy as np

from bounds import engineering
from fe_contact.microgeometry.best_design import Choice
from fe_contact.microgeometry.confirmation import rising
from fe_contact.microgeometry.design_study import DesignStudy
from fe_contact.microgeometry.optimization import OptimizationRequest, Outcome, excess, gain_of, outcome_of
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.search import Ended
from fe_contact.microgeometry.variables import GEARS, LENGTHS, QUANTITIES

AT_BOUND = 1e-3
"""A variable this near to a bound, in parts of its range, lies on it."""


def outcome_and_reason(choice: Choice, request: OptimizationRequest) -> tuple[Outcome, str]:
    """Return the outcome of an optimization and its reason, in sentences."""
    outcome, ended = outcome_of(choice.start, choice.optimum), _ended(choice, request)
    if outcome is Outcome.LIMITS_EXCEEDED:
        over = f"{excess(choice.optimum)}{_worse(choice)}"
        return outcome, f"the best design exceeds the limits by {over}; {ended}"
    gain = gain_of(choice.start, choice.optimum)
    trend = "falls" if gain.value >= 0.0 else "rises"
    change = (
        f"expected peak-to-peak {trend} by {1e6 * abs(gain.value):.3g} µm, errors "
        f"{engineering(1e6 * gain.error, 2)} µm{_worse(choice)}"
    )
    if outcome is Outcome.IMPROVED:
        return outcome, f"{change}; {ended}"
    if outcome is Outcome.LIMITS_MET:
        return outcome, f"the limits are kept, which the start exceeds; {change}; {ended}"
    return outcome, f"{change}; {_why_not(choice, request, gain.error)}{ended}"


def _worse(choice: Choice) -> str:
    """Name the torques at which the best design ripples more than the start, whether they count or not."""
    before, after = choice.start.harris_map, choice.optimum.harris_map
    worse = rising(before, after)
    if not worse.size:
        return ""
    torques = ", ".join(f"{torque:.6g}" for torque in before.torque[worse])
    maximum = worse[np.argmax((after.expected - before.expected)[worse])]
    change = f"{1e6 * before.expected[maximum]:.3g} to {1e6 * after.expected[maximum]:.3g} µm"
    return f"; it rises at {torques} N m, most at {before.torque[maximum]:.6g} N m from {change}"


def _ended(choice: Choice, request: OptimizationRequest) -> str:
    """Say how the search ended; one that was interrupted may have had more to find in any of its starts."""
    cut = any(run.ended is Ended.CANCELLED for run in choice.runs)
    if cut or len(choice.runs) < request.search.starts:
        count = sum(run.evaluations for run in choice.runs)
        maximum = request.search.starts * request.search.evaluations
        return f"the search was interrupted after {count} of at most {maximum} designs"
    return "the search converged" if choice.run.converged else "the search used all its evaluations"


def _why_not(choice: Choice, request: OptimizationRequest, error: float) -> str:
    if request.outside:
        return f"the start lies beyond the bounds of {', '.join(request.outside)}; "
    spread = max(run.spread for run in choice.runs)
    if choice.run.converged and spread <= error:
        return f"the variables have no influence: all designs lie within {engineering(1e6 * spread, 2)} µm; "
    return ""


def untried_steps(choice: Choice, request: OptimizationRequest, study: DesignStudy) -> tuple[str, ...]:
    """Say what the design is the best without: what did not vary, what did not scatter, what was left out."""
    names = _not_varied({variable.name for variable in request.variables})
    spread = (*((MISALIGNMENT,) if request.scatter.misalignment else ()), *request.scatter.modification)
    off = [name for name, choice_of in study.decision.checked.decision.items() if choice_of == "off"]
    bounds = _on_bounds(choice, request)
    starts = "one start" if request.search.starts == 1 else f"{request.search.starts} starts"
    untried = [
        f"wider bounds of {', '.join(bounds)}, which the optimum lies on" if bounds else "",
        f"other values of {', '.join(names)}" if names else "",
        f"scatter of anything but {', '.join(spread)}" if spread else "scatter of anything",
        f"neglected effects: {', '.join(off)}" if off else "",
        f"other searches than {starts} of {request.search.method.to_json()['method'].replace('_', ' ')}; "
        "ripple has many local minima",
        "other center distances, and torques without weight",
    ]
    return tuple(filter(None, untried))


def _not_varied(free: set[str]) -> list[str]:
    """Name the figures that stay, those of both gears once; lengths only of amounts that vary."""
    fixed_names = {
        gear: [
            name
            for name in QUANTITIES
            if f"{gear}.{name}" not in free
            and (name not in LENGTHS or f"{gear}.{name.removesuffix('_length')}" in free)
        ]
        for gear in GEARS
    }
    both = [name for name in QUANTITIES if all(name in figures for figures in fixed_names.values())]
    names = [
        f"{gear}.{name}" for gear, figures in fixed_names.items() for name in figures if name not in both
    ]
    return [*names, f"{', '.join(both)} of both gears"] if both else names


def _on_bounds(choice: Choice, request: OptimizationRequest) -> list[str]:
    """Variables whose optimum lies on a bound that is not the end of what there is: nothing removed."""
    names = []
    for variable, part in zip(request.variables, np.asarray(choice.run.place), strict=True):
        low, high = part <= AT_BOUND, part >= 1.0 - AT_BOUND
        if high or (low and variable.low != 0.0):
            names.append(variable.name)
    return names
