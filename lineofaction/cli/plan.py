"""``loa plan``."""

from __future__ import annotations

from bounds import engineering
from fe_contact.analysis.run_plan import PlannedLevel, RunPlan
from fe_contact.planning.cost_model import STAGES
from host.directories import cache_home
from lineofaction.cli.assessed_case import assessed_case
from lineofaction.cli.output import console, print_json, table
from lineofaction.gearbox.convert.effect_lines import ledger_lines
from lineofaction.gearbox.convert.plan import plan_of
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.units import UM


def run_plan(file: InputFile, time_budget_s: float | None, *, as_json: bool) -> None:
    """Plan, print."""
    plan = plan_of(assessed_case(file), time_budget_s, cache_home() / "compliance")
    if as_json:
        print_json(plan.to_json())
    else:
        _show(plan)


def _show(plan: RunPlan) -> None:
    """Print the plan for people."""
    out = console()
    for line in ledger_lines(plan.to_json()["effect_ledger"]):
        out.print(line, highlight=False)
    head = ["mesh", "CPU s", *STAGES, "memory MiB", "error %", "of which model %", "mean um", "p-p um", ""]
    rows = [
        [
            _mesh(entry, plan.chosen),
            engineering(entry.cost.cpu_seconds, 2),
            *(engineering(entry.cost.stages[stage], 2) for stage in STAGES),
            f"{entry.cost.memory_bytes / 2**20:.0f}",
            engineering(100.0 * entry.error.total, 2),
            engineering(100.0 * entry.error.model, 2),
            *(_micrometers(error) for error in (entry.error.mean, entry.error.peak_to_peak)),
            "chosen" if entry is plan.chosen else "",
        ]
        for entry in plan.levels
    ]
    out.print(table(head, rows, "Predicted, nothing computed"))
    model = plan.plan.discretization.to_json()["model"].replace("_", " ")
    positions = plan.plan.positions or f"about {plan.chosen.cost.positions}, placed where the curve bends"
    out.print(
        f"model {model}; positions {positions}; mesh {plan.choice.option.name}: {plan.choice.reason}",
        highlight=False,
    )
    if plan.conflict or not plan.choice.met:
        out.print(plan.conflict or f"cannot be had: {plan.choice.reason}", highlight=False)


def _mesh(entry: PlannedLevel, chosen: PlannedLevel) -> str:
    """Name a mesh, and its model where that is not the chosen one."""
    model = [] if entry.model == chosen.model else [entry.model]
    slices = [] if entry.slices == 1 else [f"{entry.slices} slices"]
    return ", ".join([*model, entry.level, *slices])


def _micrometers(error: float | None) -> str:
    """Return an expected error in um: per cent of a small ripple mean little; none where no size is known."""
    return "" if error is None else engineering(error / UM, 2)
