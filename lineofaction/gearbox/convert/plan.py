"""The plan of a run before it starts: discretization and predicted cost."""

from __future__ import annotations

from pathlib import Path

from bounds.types import Json
from fe_contact.analysis.request.model_choice import Decision, decide
from fe_contact.analysis.run_plan import RunPlan, plan_run
from fe_contact.planning.cost_model import Prediction
from lineofaction.gearbox.convert.boundary_errors import boundary_errors
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.units import in_um


def plan_of(case: CheckedCase, time_budget_s: float | None, cache: Path | None) -> RunPlan:
    """Plan a case; `time_budget_s` counts in addition to a tolerance of the case.

    Raises `BadInput`: no such pair, or a request that no plan can meet.
    """
    checked = case.checked
    with boundary_errors():
        return plan_run(checked, time_budget=time_budget_s, cache=cache)


def costs_of(case: CheckedCase, cache: Path | None) -> list[Prediction]:
    """Return the cost of each expected pass of the table of a case; levels without a pass are not predicted.

    Raises `BadInput`: no such pair, or a request that no plan can meet.
    """
    decision = case.request(_decision, cache)
    with boundary_errors():
        return [part.predicted(cache) for part in decision.passes]


def _decision(case: CheckedCase, cache: Path | None) -> Decision:
    return decide(case.checked, cache, tried=True)


def plan_json(plan: RunPlan) -> Json:
    """Return a plan as it is printed and served: errors and influences of effects in um."""
    plain: Json = in_um(plan.to_json())
    return plain
