"""The plan of a run at the boundary."""

from __future__ import annotations

from pathlib import Path

from fe_contact.analysis.run_plan import RunPlan, plan_run
from lineofaction.gearbox.convert.case import analysis_options, boundary_errors, gear_pair, table_axes
from lineofaction.gearbox.schemas import Case


def plan_of(case: Case, time_budget_s: float | None, cache: Path | None) -> RunPlan:
    """Plan a case; `time_budget_s` stands beside a tolerance of the case.

    Raises
    ------
    BadInput
        No such pair, or a request that no plan can meet.
    """
    pair = gear_pair(case)
    axes, options = table_axes(case), analysis_options(case)
    with boundary_errors():
        return plan_run(pair, axes, options, time_budget=time_budget_s, cache=cache)
