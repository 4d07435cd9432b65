"""``loa analyze`` and ``loa plan``: case files read and assessed, their tables computed or predicted."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from rich.console import Console

from bounds import engineering
from bounds.types import Json
from fe_contact.analysis.run_plan import PlannedLevel, RunPlan
from fe_contact.ste import SteDatabase
from host.directories import cache_home
from lineofaction.cli.guard import warn
from lineofaction.cli.output import (
    FOUND,
    Report,
    check_netcdf_output,
    console,
    output_of,
    print_headlines,
    print_json,
    print_written,
    progress_bar,
    table,
)
from lineofaction.cli.subjects import KeptTables, assessed_case
from lineofaction.gearbox.convert.answers import draft_line, source_rows, summary_json
from lineofaction.gearbox.convert.case import CheckedCase
from lineofaction.gearbox.convert.effects import (
    assumption_lines,
    by_size,
    influence_place,
    ledger_table,
    trifles_title,
)
from lineofaction.gearbox.convert.live import plan_json, plan_of
from lineofaction.gearbox.executor import open_executor
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import JobFailed
from lineofaction.gearbox.tabled_scene import database_of
from lineofaction.gearbox.units import MM, NM, UM
from lineofaction.report.ste.page import static_headlines
from model_studies.workers import InProcess, Workers

# Lines of `loa analyze` about a tolerance: drafts while it refines, its passes, and whether it is met.

_NODES = {
    "misalignment": ("misalignments", UM, "µm"),
    "center_distance_change": ("center distance changes", MM, "mm"),
}


def _tolerance_lines(receipt: Json, newton_metre: float = 1.0) -> Iterator[str]:
    """Yield whether the tolerance is met as measured, why not, and passes; `newton_metre`: its force, N."""
    kept = receipt.get("tolerance")
    if not kept:
        return
    yield _verdict(kept)
    passes = receipt.get("passes", ())
    if len(passes) > 1:
        yield from (_pass(number, entry) for number, entry in enumerate(passes, 1))
    axes = _NODES | {"force": ("torques", newton_metre, "N m")}
    for beyond in kept.get("between_nodes", ()):
        name, unit, symbol = axes[beyond["axis"]]
        low, high = (f"{value / unit:.6g}" for value in beyond["between"])
        yield (
            f"between the {name} {low} and {high} {symbol} interpolation errs by "
            f"{engineering(beyond['used'], 2)} times the tolerance: {beyond['limit']}"
        )


def _tolerance_warnings(receipt: Json) -> Iterable[Json]:
    """Return one warning where errors were measured and the tolerance is not met."""
    kept = receipt.get("tolerance")
    if not kept or kept["met"] is not False:
        return []
    reason = f" ({kept['reason']})" if kept.get("reason") else ""
    return [{"check": "tolerance", "message": f"{_verdict(kept)}{reason}"}]


def _verdict(kept: Json) -> str:
    tolerance = (
        f"tolerance {engineering(100 * kept['relative'], 3)} % or {engineering(kept['floor_m'] / NM, 3)} nm"
    )
    if kept["met"] is None:
        return f"{tolerance}: errors not estimated"
    numerical = "" if kept["used"] is None else _percent(kept["used"] * kept["relative"], "numerical error")
    lasting = (
        f"{_percent(kept['lasting'], 'of the method')}, which no mesh lowers" if "lasting" in kept else ""
    )
    return f"{tolerance}: {'met' if kept['met'] else 'NOT met'}{numerical}{lasting}"


def _percent(part: float, name: str) -> str:
    return f"; {name} {engineering(100.0 * part, 2)} %"


def _pass(number: int, entry: Json) -> str:
    mesh = entry["level"] if entry["slices"] == 1 else f"{entry['level']}, {entry['slices']} slices"
    used = "failed" if entry["used"] is None else f"used {engineering(entry['used'], 2)}"
    refined = f", refined {', '.join(entry['refined'])}" if entry["refined"] else ""
    return (
        f"pass {number}: {entry['model']}, {mesh}, "
        f"{engineering(entry['cpu_seconds'], 2)} CPU s, {used}{refined}"
    )


# ``loa analyze``.


_SHOWN_HARMONICS = 2


def run_analyze(
    file: InputFile, named: Path | None, executor: tuple[int, str | None], *, as_json: bool
) -> None:
    """Compute, write, print."""
    case = assessed_case(file)
    output = output_of(named, file.project, f"{file.path.stem}.nc")
    check_netcdf_output(output)
    with open_executor(*executor) as workers, progress_bar() as report:
        database = analyzed(case, report, workers)
    KeptTables(lambda _: database).table(case.case)  # for verbs that take it
    warn([*database.metadata.warnings, *_tolerance_warnings(database.metadata.receipt)])
    database.to_netcdf(output)
    summary = {"file": str(output), **summary_json(database)}
    if as_json:
        print_json(summary)
    else:
        print_headlines(static_headlines(database))
        _show(summary)
        print_written([output])
    if database.n_failed:
        raise JobFailed(f"{database.failure_message()}. The table in {output} holds NaN there.")


def analyzed(
    case: CheckedCase,
    report: Report,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SteDatabase:
    """Compute the database of a case in this process; condensed gears are kept in the user's cache.

    Figures of a table that is being refined are printed on standard error: they are progress.
    """

    def print_draft(table: SteDatabase, refining: str) -> None:
        print(draft_line(table, refining), file=sys.stderr, flush=True)  # noqa: T201 (this is the command line)

    return database_of(case, cache_home(), report, workers, print_draft)


def _show(summary: dict[str, Any]) -> None:
    out = console()
    names = [f"harm. {n} µm" for n in range(1, _SHOWN_HARMONICS + 1)]
    rows = [_row(load) for load in summary["loads"]]
    out.print(table(["torque N m", "force N", "mean µm", "p-p µm", *names], rows, "Transmission error"))
    receipt, load = summary["receipt"], summary["loads"][-1]
    if bias := receipt.get("bias"):
        out.print(bias["words"], soft_wrap=True)
        out.print(_over_face(load), soft_wrap=True)
    if sources := source_rows(receipt, -1):
        rows = [[name, *(engineering(error / UM, 2) for error in errors)] for name, *errors in sources]
        head = ["source", "mean µm", "p-p µm", "harm. 1 µm"]
        out.print(table(head, rows, f"Errors by source at {load['torque_n_m']:.6g} N m"))
    _show_effects(out, summary["effect_ledger"])
    for line in assumption_lines(receipt):
        out.print(line)
    out.print(_cost(receipt, load["normal_force_n"] / load["torque_n_m"]))
    out.print(f"points {summary['points']}, failed {summary['failed_points']}")
    out.print(f"content hash {summary['content_hash']}")


def _over_face(load: dict[str, Any]) -> str:
    """Mean and peak-to-peak of the gears of finite width: those of the plane, corrected."""
    errors = "mean_over_face_error_um" in load
    mean, ripple = (
        f"{load[f'{name}_over_face_um']:.4g}"
        + (f" ±{engineering(load[f'{name}_over_face_error_um'], 1)}" if errors else "")
        for name in ("mean", "peak_to_peak")
    )
    return f"over the face at {load['torque_n_m']:.6g} N m: mean {mean} µm, peak-to-peak {ripple} µm"


def _show_effects(out: Console, ledger: list[dict[str, Any]]) -> None:
    """Print the decision about every effect that is not a trifle, and what leaving it out changes."""
    columns, rows = ledger_table(ledger)
    title = f"Effects: estimated change without each, {influence_place(ledger)}".removesuffix(", ")
    out.print()
    out.print(table(columns, rows, title, words=(columns[0], columns[-1])))
    if trifles := by_size(ledger)[1]:
        names = ", ".join(entry["name"].replace("_", " ") for entry in trifles)
        out.print(f"{trifles_title(trifles)}: {names}")


def _of_cycle(cycle: dict[str, Any]) -> str:
    """Return how many base pitches were solved, or why all were."""
    if reason := cycle.get("reason"):
        return f"all {cycle['pitches']} base pitches solved: {reason}"
    solved, pitches = max(cycle["solved"]), cycle["pitches"]
    pressure = engineering(100.0 * cycle["pressure_error_relative"], 2)
    share = engineering(100.0 * cycle["share_error"], 2)
    return (
        f"{solved} of {pitches} base pitches solved, the others by derivatives; load shares within {share} % "
        f"of the load, pressures within {pressure} % of the largest at 99 % of their positions"
    )


def _cost(receipt: dict[str, Any], newton_metre: float = 1.0) -> str:
    """Return time by stage and memory in one line, and what there is to say of the table in others."""
    seconds = {name: spent["cpu_seconds"] for name, spent in receipt["stages"].items()}
    stages = ", ".join(f"{name} {engineering(spent, 2)}" for name, spent in seconds.items())
    memory = receipt["peak_memory_bytes"] / 2**20
    text = f"\ncost {engineering(receipt['cpu_seconds'], 3)} CPU s ({stages}), {memory:.0f} MiB"
    others = receipt.get("elsewhere", {})
    if others.get("tasks"):
        text += (
            f"\nof these {engineering(others['cpu_seconds'], 3)} CPU s in {others['tasks']} tasks of workers"
        )
    if predicted := receipt.get("predicted"):
        pitches, seconds = predicted["pitches"], predicted["cpu_seconds"]
        text += f"\nperiod {pitches} base pitches; contact predicted {engineering(seconds, 2)} CPU s"
    if cycle := receipt.get("cycle"):
        text += f"\n{_of_cycle(cycle)}"
    for line in _inserted(receipt.get("held_out", {}), newton_metre):
        text += f"\n{line}"
    if held_out := _held_out(receipt.get("held_out", {})):
        text += f"\nlargest error at held-out points between the nodes: {held_out} (in the errors there)"
    if allowed := receipt.get("misalignment_range"):
        text += f"\n{allowed}"
    for line in _tolerance_lines(receipt, newton_metre):
        text += f"\n{line}"
    if outgrown := receipt.get("patch_outgrown_points", 0):
        text += f"\ncontact outgrew its load patch at {outgrown} points: the load is far above usual loads"
    missing = receipt.get("not_estimated", [])
    if missing:
        text += f"\nerrors NOT estimated: {', '.join(missing).replace('_', ' ')}"
    return text


def _inserted(axes: dict[str, Any], newton_metre: float) -> Iterator[str]:
    """Yield the values of each axis that were inserted to meet the tolerance; `newton_metre` in N."""
    for axis, (name, unit, word) in ({"force": ("loads", newton_metre, "N m")} | _NODES).items():
        if inserted := axes.get(axis, {}).get("inserted"):
            values = ", ".join(f"{value / unit:.4g}" for value in inserted)
            yield f"{name} inserted for interpolation: {values} {word}"


def _held_out(axes: dict[str, Any]) -> str:
    words = []
    for name, measured in axes.items():
        errors = [error for row in measured["error_m"] for error in row]
        worst = "unknown" if None in errors else f"{engineering(max(errors) / UM, 2)} µm"
        words.append(f"{name.replace('_', ' ')} {worst}")
    return ", ".join(words)


def _row(load: dict[str, Any]) -> list[str]:
    """One load of the table, each figure with its error."""
    values = [load["mean_um"], load["peak_to_peak_um"], *load["harmonics_um"]][: 2 + _SHOWN_HARMONICS]
    figures = [f"{value:.4g}" for value in values]
    if "mean_error_um" in load:
        errors = [load["mean_error_um"], load["peak_to_peak_error_um"], *load["harmonics_error_um"]]
        bands = [engineering(error, 1) for error in errors]
        figures = [f"{figure} ±{band}" for figure, band in zip(figures, bands, strict=False)]
    return [f"{load['torque_n_m']:.6g}", f"{load['normal_force_n']:.6g}", *figures]


# ``loa plan``.


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
    out.print(f"{meshes}: {size}; nothing is computed yet", style=FOUND)
    out.print(f"model {model}; positions {positions}; mesh {plan.choice.option.name}: {plan.choice.reason}")
    if plan.conflict or not plan.choice.met:
        out.print(plan.conflict or f"cannot be had: {plan.choice.reason}")
    if bias := plan.chosen.error.bias:
        out.print(bias.words, soft_wrap=True)
    out.print()
    head = ["mesh", "CPU s", "GiB", "numerical", "plane", "method", "mean µm", "p-p µm"]
    rows = [
        [
            f"{'> ' if entry in plan.passes else ''}{_mesh(entry, plan.chosen)}",
            engineering(entry.cost.cpu_seconds, 2),
            f"{entry.cost.memory_bytes / 2**30:.1f}",
            engineering(100.0 * error.numerical, 2),
            "bias" if error.bias else engineering(100.0 * error.plane, 2),
            engineering(100.0 * error.method, 2),
            # per cent of a small ripple mean little; no size is known without a reference
            *("" if size is None else engineering(size / UM, 2) for size in (error.mean, error.peak_to_peak)),
        ]
        for entry in plan.levels
        for error in (entry.error,)
    ]
    out.print(table(head, rows, "Cost, and errors in % and as a whole"))
    _show_effects(out, plan_json(plan)["effect_ledger"])


def _mesh(entry: PlannedLevel, chosen: PlannedLevel) -> str:
    """Name a mesh, and its model where that is not the chosen one."""
    model = [] if entry.model == chosen.model else [entry.model]
    slices = [] if entry.slices == 1 else [f"{entry.slices} slices"]
    return ", ".join([*model, entry.level, *slices])
