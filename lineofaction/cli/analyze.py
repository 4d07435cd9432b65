"""``loa analyze``: the tables of case files, from the cache or computed.

What computes a table is loaded when none is in the cache.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.console import Console

from bounds import engineering
from bounds.error_digits import with_error
from fe_contact.ste import SteDatabase
from host.directories import cache_home
from lineofaction.cli.assessed_case import assessed_case
from lineofaction.cli.cached_tables import CachedTables
from lineofaction.cli.output import (
    check_netcdf_output,
    console,
    output_of,
    print_headlines,
    print_json,
    print_written,
    table,
)
from lineofaction.cli.tolerance_lines import NODES, tolerance_lines, tolerance_warnings
from lineofaction.cli.verb_warnings import warn
from lineofaction.gearbox.convert.answers import source_rows, summary_json
from lineofaction.gearbox.convert.checked_case import CheckedCase
from lineofaction.gearbox.convert.effects import (
    assumption_lines,
    by_size,
    influence_point,
    ledger_table,
    trifles_title,
)
from lineofaction.gearbox.input_file import InputFile
from lineofaction.gearbox.problems import JobFailed
from lineofaction.gearbox.progress_bars import progress_bar
from lineofaction.gearbox.units import UM
from lineofaction.report.ste.headlines import static_headlines

_MAX_HARMONICS = 2
_FROM_CACHE = "note: the table of an equal case was in the cache: its cost is of its computation"


def run_analyze(
    file: InputFile, named: Path | None, executor: tuple[int, str | None], *, as_json: bool
) -> None:
    """Find or compute the table, write, print."""
    case = assessed_case(file)
    output = output_of(named, file.project, f"{file.path.stem}.nc")
    check_netcdf_output(output)
    database = CachedTables.find(case.case)
    if database is None:
        database = _computed_database(case, executor)
    elif not as_json:
        print(_FROM_CACHE, file=sys.stderr)  # noqa: T201 (this is the command line)
    warn([*database.metadata.warnings, *tolerance_warnings(database.metadata.receipt)])
    database.to_netcdf(output)
    summary = {"file": str(output), **summary_json(database)}
    if as_json:
        print_json(summary)
    else:
        print_headlines(static_headlines(database))
        several = max(database.misalignment.size, database.center_distance_change.size) > 1
        _show(summary, several_alignments=several)
        print_written([output])
    if database.n_failed:
        remedy = "A finer mesh may solve them: accuracy.level, or accuracy.tolerance without a level."
        raise JobFailed(f"{database.failure_message()}. The table in {output} holds NaN there. {remedy}")


def _computed_database(case: CheckedCase, executor: tuple[int, str | None]) -> SteDatabase:
    """Compute the table of a case, and keep it for verbs that take it."""
    from fe_contact.options import Run  # noqa: PLC0415 (start-up time)
    from lineofaction.cli.computed_tables import computed_table  # noqa: PLC0415 (start-up time)
    from lineofaction.gearbox.executor import open_executor  # noqa: PLC0415 (start-up time)

    with open_executor(*executor) as workers, progress_bar() as report:
        run = Run(workers, cache_home() / "compliance", report)
        return CachedTables(lambda _: computed_table(case, run)).table(case.case)


def _show(summary: dict[str, Any], *, several_alignments: bool) -> None:
    out = console()
    names = [f"harm. {n} µm" for n in range(1, _MAX_HARMONICS + 1)]
    rows = [_row(load) for load in summary["loads"]]
    out.print(table(["torque N m", "force N", "mean µm", "p-p µm", *names], rows, "Transmission error"))
    receipt, load = summary["receipt"], summary["loads"][-1]
    if bias := receipt.get("bias"):
        out.print(bias["words"], soft_wrap=True)
        out.print(_over_face(load), soft_wrap=True)
    if sources := source_rows(receipt, -1):
        rows = [[name, *(engineering(error / UM, 2) for error in errors)] for name, *errors in sources]
        head = ["source", "mean µm", "p-p µm", "harm. 1 µm"]
        where = ", the largest over the alignments" if several_alignments else ""
        out.print(table(head, rows, f"Errors by source at {load['torque_n_m']:.6g} N m{where}"))
    show_effects(out, summary["effect_ledger"])
    for line in assumption_lines(receipt):
        out.print(line)
    out.print()
    for line in _cost(receipt, load["normal_force_n"] / load["torque_n_m"]):
        out.print(line)
    out.print(f"points {summary['points']}, failed {summary['failed_points']}")
    out.print(f"content hash {summary['content_hash']}")


def _over_face(load: dict[str, Any]) -> str:
    """Return mean and peak-to-peak over the face, as text: those of the plane model, corrected."""
    mean, ripple = (
        with_error(load[f"{name}_over_face_um"], load.get(f"{name}_over_face_error_um", math.nan))
        for name in ("mean", "peak_to_peak")
    )
    return f"over the face at {load['torque_n_m']:.6g} N m: mean {mean} µm, peak-to-peak {ripple} µm"


def show_effects(out: Console, ledger: list[dict[str, Any]]) -> None:
    """Print the decision about every effect of relevant size, and the change without the effect."""
    columns, rows = ledger_table(ledger)
    title = f"Effects: estimated change without each, {influence_point(ledger)}".removesuffix(", ")
    out.print()
    out.print(table(columns, rows, title, text_columns=(columns[0], columns[-1])))
    _, trifles = by_size(ledger)
    if trifles:
        names = ", ".join(entry["name"].replace("_", " ") for entry in trifles)
        out.print(f"{trifles_title(trifles)}: {names}")


def _of_cycle(cycle: dict[str, Any]) -> str:
    """Return the number of solved base pitches, or the reason why all were solved, as text."""
    if reason := cycle.get("reason"):
        return f"all {cycle['pitches']} base pitches solved: {reason}"
    solved, pitches = max(cycle["solved"]), cycle["pitches"]
    pressure = engineering(100.0 * cycle["pressure_error_relative"], 2)
    share = engineering(100.0 * cycle["share_error"], 2)
    return (
        f"{solved} of {pitches} base pitches solved, the others by derivatives; load shares within {share} % "
        f"of the load, pressures within {pressure} % of the largest at 99 % of their positions"
    )


def _cost(receipt: dict[str, Any], newton_metre: float) -> Iterator[str]:
    """Yield lines on time by stage, memory, errors and tolerance; `newton_metre`: force of 1 N m, N."""
    stages = [f"{name} {engineering(cost['cpu_seconds'], 2)}" for name, cost in receipt["stages"].items()]
    memory = receipt["peak_memory_bytes"] / 2**20
    yield f"cost {engineering(receipt['cpu_seconds'], 3)} CPU s ({', '.join(stages)}), {memory:.0f} MiB"
    others = receipt.get("elsewhere", {})
    if others.get("tasks"):
        yield f"of these {engineering(others['cpu_seconds'], 3)} CPU s in {others['tasks']} tasks of workers"
    if predicted := receipt.get("predicted"):
        seconds = engineering(predicted["cpu_seconds"], 2)
        yield f"period {predicted['pitches']} base pitches; contact predicted {seconds} CPU s"
    if cycle := receipt.get("cycle"):
        yield _of_cycle(cycle)
    held_out = receipt.get("held_out", {})
    yield from _inserted(held_out, newton_metre)
    if errors_text := _validation_errors(held_out):
        yield f"largest error at held-out points between the nodes: {errors_text} (in the errors there)"
    if allowed := receipt.get("misalignment_range"):
        yield allowed
    yield from tolerance_lines(receipt, newton_metre)
    if outgrown := receipt.get("patch_outgrown_points", 0):
        yield f"contact outgrew its load patch at {outgrown} points: the load is far above usual loads"
    if missing := receipt.get("not_estimated", []):
        yield f"errors NOT estimated: {', '.join(missing).replace('_', ' ')}"


def _inserted(axes: dict[str, Any], newton_metre: float) -> Iterator[str]:
    """Yield the values of each axis that were inserted to meet the tolerance; `newton_metre` in N."""
    for axis, (name, unit, word) in ({"force": ("loads", newton_metre, "N m")} | NODES).items():
        if inserted := axes.get(axis, {}).get("inserted"):
            values = ", ".join(engineering(value / unit, 4) for value in inserted)
            yield f"{name} inserted for interpolation: {values} {word}"


def _validation_errors(axes: dict[str, Any]) -> str:
    texts = []
    for name, measured in axes.items():
        errors = [error for row in measured["error_m"] for error in row]
        worst = "unknown" if None in errors else f"{engineering(max(errors) / UM, 2)} µm"
        texts.append(f"{name.replace('_', ' ')} {worst}")
    return ", ".join(texts)


def _row(load: dict[str, Any]) -> list[str]:
    """Return the row of a load, each figure with its error."""
    values = [load["mean_um"], load["peak_to_peak_um"], *load["harmonics_um"]]
    errors = [math.nan] * len(values)
    if "mean_error_um" in load:
        errors = [load["mean_error_um"], load["peak_to_peak_error_um"], *load["harmonics_error_um"]]
    figures = map(with_error, values[: 2 + _MAX_HARMONICS], errors)
    return [f"{load['torque_n_m']:.6g}", engineering(load["normal_force_n"], 4), *figures]
