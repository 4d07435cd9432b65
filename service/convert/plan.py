"""The plan of a run at the boundary."""

from __future__ import annotations

from pathlib import Path

from fe_contact.analysis.run_plan import RunPlan, plan_run
from service.convert.case import analysis_arguments, boundary_errors, gear_pair
from service.schemas import Case

_LEFT_ASIDE = ("receipt", "on_violation")


def plan_of(case: Case, time_budget_s: float | None, cache: Path | None) -> RunPlan:
    """Plan a case; `time_budget_s` stands beside a tolerance of the case.

    Raises
    ------
    BadInput
        No such pair, or a wish that no plan can meet.
    """
    pair = gear_pair(case)
    # what a minimal receipt saves is the error estimate, which the plan lists by itself
    arguments = {name: value for name, value in analysis_arguments(case).items() if name not in _LEFT_ASIDE}
    if time_budget_s is not None:
        arguments["time_budget"] = time_budget_s
    with boundary_errors():
        return plan_run(pair, **arguments, cache=cache)
