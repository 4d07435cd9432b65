"""The conclusion of an optimization in words: the gain, how the search ended, and what was not tried.

The start is the design before the optimization, the optimum the best design found. Both were analyzed in
full. Their ripple is the peak-to-peak transmission error, expected over the scatter.
"""

from __future__ import annotations

import numpy as np

from bounds import engineering, order_words
from bounds.error_digits import NO_CHANGE, error_text, to_error, with_error
from fe_contact.microgeometry.best_design import Choice
from fe_contact.microgeometry.confirmation import rising
from fe_contact.microgeometry.design_study import DesignStudy
from fe_contact.microgeometry.optimization import (
    OptimizationRequest,
    Outcome,
    excess,
    gain_of,
    level_gain,
    outcome_of,
)
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.search import Ended
from fe_contact.microgeometry.variables import GEARS, LENGTHS, QUANTITIES
from fe_contact.types import Estimate

AT_BOUND = 1e-3
"""Distance from a bound, over the range of the variable, up to which the variable lies on the bound."""
AT_LEAST = "at least "
"""Begin of the size of a fall of which only the least is known."""


def outcome_and_reason(choice: Choice, request: OptimizationRequest) -> tuple[Outcome, str]:
    """Return the outcome of an optimization and its reason, in sentences."""
    outcome = outcome_of(choice.start, choice.optimum)
    end = _end_of_search(choice, request)
    rise = _rise_by_torque(choice)
    if outcome is Outcome.LIMITS_EXCEEDED:
        return outcome, f"the best design exceeds the limits by {excess(choice.optimum)}{rise}; {end}"
    gain = gain_of(choice.start, choice.optimum)
    trend = "falls" if gain.value >= 0.0 else "rises"
    if (harmonic := request.objective.harmonic) is not None:
        change = f"{_harmonic_change(choice, request, harmonic)}{rise}"
    else:
        change = (
            f"expected peak-to-peak {trend} by {1e6 * abs(gain.value):.3g} µm, errors "
            f"{engineering(1e6 * gain.error, 2)} µm{rise}"
        )
    if outcome is Outcome.IMPROVED:
        return outcome, f"{change}; {end}"
    if outcome is Outcome.LIMITS_MET:
        return outcome, f"the limits are kept, which the start exceeds; {change}; {end}"
    return outcome, f"{change}; {_reason_without_gain(choice, request, gain.error)}{end}"


def _harmonic_change(choice: Choice, request: OptimizationRequest, harmonic: int) -> str:
    """Return the change of a harmonic in words: that of its level, and amplitudes with errors."""
    before, after = (design.objective for design in (choice.start, choice.optimum))
    sizes = " to ".join(with_error(1e6 * one.value, 1e6 * one.error, "µm") for one in (before, after))
    teeth = request.pair.pinion.teeth
    torques = ", ".join(engineering(float(torque), 4) for torque in np.atleast_1d(request.torques))
    name = f"{order_words(harmonic * teeth, 'pinion', f'harmonic {harmonic}')}, at {torques} N m"
    size = level_change(before, after)
    verb = "falls" if after.value <= before.value else "rises"
    return f"{name}: {f'{verb} by {size}' if size else f'{NO_CHANGE} beyond the errors'}, {sizes}"


def level_change(before: Estimate, after: Estimate) -> str:
    """Return the size of the change of an amplitude's level with its error, dB; empty: within the errors.

    Of an amplitude that falls below its error only the least fall is known.
    """
    gain = level_gain(before, after)
    if abs(before.value - after.value) <= before.error + after.error:
        return ""
    if after.value <= after.error:
        least = level_gain(before, Estimate(after.value + after.error, 0.0, after.unit))
        return f"{AT_LEAST}{engineering(least.value - least.error, 2)} dB"
    return f"{to_error(abs(gain.value), gain.error)} ± {error_text(gain.value, gain.error)} dB"


def _rise_by_torque(choice: Choice) -> str:
    """Name the torques at which the best design ripples more than the start, torques without weight included.

    Empty if there are none.
    """
    before, after = choice.start.harris_map, choice.optimum.harris_map
    rows = rising(before, after)
    if not rows.size:
        return ""
    torques = ", ".join(f"{torque:.6g}" for torque in before.torque[rows])
    maximum = rows[np.argmax((after.expected - before.expected)[rows])]  # the largest rise
    change = f"{1e6 * before.expected[maximum]:.3g} to {1e6 * after.expected[maximum]:.3g} µm"
    return f"; it rises at {torques} N m, most at {before.torque[maximum]:.6g} N m from {change}"


def _end_of_search(choice: Choice, request: OptimizationRequest) -> str:
    """Return a clause on how the search ended.

    A search is interrupted if one of its starts is, or if some of them never ran.
    """
    cancelled = any(run.ended is Ended.CANCELLED for run in choice.runs)
    if cancelled or len(choice.runs) < request.search.starts:
        count = sum(run.evaluations for run in choice.runs)
        maximum = request.search.starts * request.search.evaluations
        return f"the search was interrupted after {count} of at most {maximum} designs"
    return "the search converged" if choice.run.converged else "the search used all its evaluations"


def _reason_without_gain(choice: Choice, request: OptimizationRequest, error: float) -> str:
    """Return a clause on why nothing was gained, empty if unknown; `error` is that of the gain, m."""
    if request.outside:
        return f"the start lies beyond the bounds of {', '.join(request.outside)}; "
    # differences of ripple between the designs of a search, m: within the error they say nothing
    spread = max(run.spread for run in choice.runs)
    if choice.run.converged and spread <= error:
        return f"the variables have no influence: all designs lie within {engineering(1e6 * spread, 2)} µm; "
    return ""


def untried_steps(choice: Choice, request: OptimizationRequest, study: DesignStudy) -> tuple[str, ...]:
    """Return a clause for every kind of freedom that the optimization did not use."""
    names = _fixed_quantities({variable.name for variable in request.variables})
    scattered = list(request.scatter.modification)
    if request.scatter.misalignment:
        scattered.insert(0, MISALIGNMENT)
    neglected = [name for name, state in study.decision.checked.decision.items() if state == "off"]
    bounds = _on_bounds(choice, request)
    starts = "one start" if request.search.starts == 1 else f"{request.search.starts} starts"
    method = request.search.method.to_json()["method"].replace("_", " ")
    untried = [  # an empty clause does not apply
        f"wider bounds of {', '.join(bounds)}, which the optimum lies on" if bounds else "",
        f"other values of {', '.join(names)}" if names else "",
        f"scatter of anything but {', '.join(scattered)}" if scattered else "scatter of anything",
        f"neglected effects: {', '.join(neglected)}" if neglected else "",
        f"other searches than {starts} of {method}; ripple has many local minima",
        "other center distances, and torques without weight",
    ]
    return tuple(filter(None, untried))


def _fixed_quantities(free: set[str]) -> list[str]:
    """Return the names of the quantities of flanks that did not vary; `free` names the variables.

    Quantities that are fixed on both gears are named once. The length of a relief is named only if the amount
    of the relief varies.
    """
    fixed_names = {
        gear: [
            name
            for name in QUANTITIES
            # a variable is named "gear.quantity", a length "amount_length"
            if f"{gear}.{name}" not in free
            and (name not in LENGTHS or f"{gear}.{name.removesuffix('_length')}" in free)
        ]
        for gear in GEARS
    }
    both = [name for name in QUANTITIES if all(name in fixed for fixed in fixed_names.values())]
    names = [f"{gear}.{name}" for gear, fixed in fixed_names.items() for name in fixed if name not in both]
    return [*names, f"{', '.join(both)} of both gears"] if both else names


def _on_bounds(choice: Choice, request: OptimizationRequest) -> list[str]:
    """Return the variables whose optimum lies on a bound that could be wider.

    A lower bound of 0 could not: no material is removed there.
    """
    names = []
    # `coordinates` are the best design of the search, each variable in parts of its range
    for variable, part in zip(request.variables, np.asarray(choice.run.coordinates), strict=True):
        on_low = part <= AT_BOUND
        on_high = part >= 1.0 - AT_BOUND
        if on_high or (on_low and variable.low != 0.0):
            names.append(variable.name)
    return names
