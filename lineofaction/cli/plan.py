"""``loa plan``: the cost of a table and its effects, before it is computed."""

from __future__ import annotations

from bounds import engineering
from fe_contact.analysis.run_plan import PlannedLevel, RunPlan
from host.directories import cache_home
from lineofaction.cli.analyze import show_effects
from lineofaction.cli.assessed_case import assessed_case
from lineofaction.cli.output import EMPHASIS, console, print_json, table
from lineofaction.gearbox.convert.plan import plan_json, plan_of
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.units import UM


def run_plan(file: InputFile, time_budget_s: float | None, *, as_json: bool) -> None:
    """Plan, print."""
    plan = plan_of(assessed_case(file), time_budget_s, cache_home() / "compliance")
    if as_json:
        print_json(plan_json(plan))
    else:
        _show_plan(plan)


def _show_plan(plan: RunPlan) -> None:
    out, cost = console(), plan.chosen.cost
    model = plan.plan.discretization.to_json()["model"].replace("_", " ")
    positions = plan.plan.positions or f"about {cost.positions}, placed where the curve bends"
    seconds = sum(entry.cost.cpu_seconds for entry in plan.passes)
    memory = max(entry.cost.memory_bytes for entry in plan.passes)
    size = f"{engineering(seconds, 2)} CPU s, {engineering(memory / 2**30, 2)} GiB"
    meshes = ", then ".join(_mesh(entry, plan.chosen) for entry in plan.passes)
    out.print(f"{meshes}: {size}; nothing is computed yet", style=EMPHASIS)
    out.print(f"model {model}; positions {positions}; mesh {plan.choice.option.name}: {plan.choice.reason}")
    if plan.conflict or not plan.choice.met:
        out.print(plan.conflict or f"cannot be had: {plan.choice.reason}")
    if bias := plan.chosen.error.bias:
        out.print(bias.text, soft_wrap=True)
    out.print()
    head = ["mesh", "CPU s", "GiB", "numerical", "plane", "method", "mean µm", "p-p µm"]
    rows = [_row(entry, plan) for entry in plan.levels]
    out.print(table(head, rows, "Cost, and errors in % and as a whole"))
    show_effects(out, plan_json(plan)["effect_ledger"])


def _row(entry: PlannedLevel, plan: RunPlan) -> list[str]:
    """Return the row of a mesh: its cost and its errors; those of the run begin with ``>``."""
    error = entry.error
    return [
        f"{'> ' if entry in plan.passes else ''}{_mesh(entry, plan.chosen)}",
        engineering(entry.cost.cpu_seconds, 2),
        f"{entry.cost.memory_bytes / 2**30:.1f}",
        engineering(100.0 * error.numerical, 2),
        "bias" if error.bias else engineering(100.0 * error.plane, 2),
        engineering(100.0 * error.method, 2),
        # in µm, since per cent of a small ripple mean little; blank if not known
        *("" if size is None else engineering(size / UM, 2) for size in (error.mean, error.peak_to_peak)),
    ]


def _mesh(entry: PlannedLevel, level: PlannedLevel) -> str:
    """Name a mesh, and its model where that is not the chosen one."""
    model = [] if entry.model == level.model else [entry.model]
    slices = [] if entry.slices == 1 else [f"{entry.slices} slices"]
    return ", ".join([*model, entry.level, *slices])
