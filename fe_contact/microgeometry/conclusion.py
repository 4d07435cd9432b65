"""What came of an optimization, in words: the gain, how it ended, and what was not tried."""

from __future__ import annotations

import numpy as np

from fe_contact.microgeometry.choice import SLACK, Choice
from fe_contact.microgeometry.design_study import DesignStudy
from fe_contact.microgeometry.optimization import Outcome
from fe_contact.microgeometry.request import OptimizationRequest
from fe_contact.microgeometry.scatter import MISALIGNMENT
from fe_contact.microgeometry.search import Ended
from fe_contact.microgeometry.variables import GEARS, QUANTITIES

AT_BOUND = 1e-3
"""A variable this near to a bound, in parts of its range, lies on it."""


def conclusion(choice: Choice, asked: OptimizationRequest) -> tuple[Outcome, str]:
    """Return the outcome and the reason for it."""
    start, optimum, ended = choice.start, choice.optimum, _ended(choice, asked)
    gain = start.objective.value - optimum.objective.value
    error = start.objective.error + optimum.objective.error
    if optimum.violation > SLACK:
        over = f"{100.0 * optimum.violation:.2g} % of them, or of the load on tip edges"
        return Outcome.LIMITS_EXCEEDED, f"the best design exceeds the limits by {over}; {ended}"
    moved = "falls" if gain >= 0.0 else "rises"
    told = f"expected peak-to-peak {moved} by {1e6 * abs(gain):.3g} um, errors {1e6 * error:.2g} um"
    if gain > error:
        return Outcome.IMPROVED, f"{told}; {ended}"
    if start.violation > SLACK:
        return Outcome.LIMITS_KEPT, f"the limits are kept, which the start exceeds; {told}; {ended}"
    outcome = Outcome.WITHIN_ERROR if gain > 0.0 else Outcome.NOT_IMPROVED
    return outcome, f"{told}; {_why_not(choice, asked, error)}{ended}"


def _ended(choice: Choice, asked: OptimizationRequest) -> str:
    """Say how the search ended; one that was interrupted may have had more to find in any of its starts."""
    cut = any(run.ended is Ended.CANCELLED for run in choice.runs)
    if cut or len(choice.runs) < asked.search.starts:
        count = sum(run.evaluations for run in choice.runs)
        most = asked.search.starts * asked.search.evaluations
        return f"the search was interrupted after {count} of at most {most} designs"
    return "the search converged" if choice.run.converged else "the search used all its evaluations"


def _why_not(choice: Choice, asked: OptimizationRequest, error: float) -> str:
    """Say why nothing was won, where the search shows it."""
    if asked.outside:
        return f"the start lies beyond the bounds of {', '.join(asked.outside)}; "
    spread = max(run.spread for run in choice.runs)
    if choice.run.converged and spread <= error:
        return f"what is varied makes no difference: all designs lie within {1e6 * spread:.2g} um; "
    return ""


def not_tried(choice: Choice, asked: OptimizationRequest, study: DesignStudy) -> tuple[str, ...]:
    """Say what the design is the best without: what did not vary, what did not scatter, what was left out."""
    free = {one.name for one in asked.variables}
    kept = [f"{gear}.{name}" for gear in GEARS for name in QUANTITIES if f"{gear}.{name}" not in free]
    spread = (*((MISALIGNMENT,) if asked.scatter.misalignment else ()), *asked.scatter.modification)
    off = [name for name, choice_of in study.decided.checked.decided.items() if choice_of == "off"]
    bounds = _on_bounds(choice, asked)
    starts = "one start" if asked.search.starts == 1 else f"{asked.search.starts} starts"
    found = [
        f"wider bounds of {', '.join(bounds)}, which the optimum lies on" if bounds else "",
        f"other values of {', '.join(kept)}" if kept else "",
        f"scatter of anything but {', '.join(spread)}" if spread else "scatter of anything",
        f"neglected effects: {', '.join(off)}" if off else "",
        f"other searches than {starts} of {asked.search.method.to_json()['method'].replace('_', ' ')}; "
        "ripple has many local minima",
        "other center distances, and torques but those that count",
    ]
    return tuple(one for one in found if one)


def _on_bounds(choice: Choice, asked: OptimizationRequest) -> list[str]:
    """Variables whose optimum lies on a bound that is not the end of what there is: nothing removed."""
    found = []
    for one, part in zip(asked.variables, np.asarray(choice.run.place), strict=True):
        low, high = part <= AT_BOUND, part >= 1.0 - AT_BOUND
        if high or (low and one.low != 0.0):
            found.append(one.name)
    return found
