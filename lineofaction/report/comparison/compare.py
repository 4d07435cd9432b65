"""From result files to the page that compares them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from dynamics.results import RunResult
from fe_contact.ste import SteDatabase
from lineofaction.gearbox.convert.stamp import stamped
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.comparison.measured import MeasuredCurve, MeasuredOrders, read_measured
from lineofaction.report.comparison.measured_universal import ENDINGS, read_universal
from lineofaction.report.comparison.of_runs import compare_runs
from lineofaction.report.comparison.of_tables import compare_tables
from lineofaction.report.document.inputs import read_result
from lineofaction.report.drawing.page import Page
from lineofaction.report.runs.run_view import RunView, shown_signal

_BOUND = "two results of one kind, or one and a measurement (CSV, universal file)"
_ADVICE = "For example: loa compare before.nc after.nc, or loa compare ste.nc measured.csv"


def compare(files: Sequence[Path], view: RunView, torque: float | None = None) -> Page:
    """Compare one or two tables or runs, and what was measured where one of them is a measurement.

    Raises
    ------
    BadInput
        The files are not one or two of a kind with at most one measurement, are damaged, or do not hold what
        is to be compared.
    """
    measured = [file for file in files if file.suffix.lower() in (".csv", *ENDINGS)]
    results = dict(named_files([file for file in files if file not in measured]))
    if len(measured) > 1 or not results or not len(results) + len(measured) >= 2 or len(results) > 2:
        raise BadInput.of("files", ", ".join(map(str, files)) or None, _BOUND, _ADVICE)
    return compare_results(results, view, measured, torque)


def compare_results(
    results: dict[str, Path], view: RunView, measured: Sequence[Path] = (), torque: float | None = None
) -> Page:
    """Compare result files by their names; parameters and errors as for `compare`."""
    read = {name: read_result(file) for name, file in results.items()}
    warnings = dict.fromkeys(one["message"] for file in results.values() for one in stamped(file))
    page = _page(read, measured, view, torque)
    return replace(page, alarms=(*(f"Warning: {text}" for text in warnings), *page.alarms))


def _page(
    read: dict[str, SteDatabase | RunResult], files: Sequence[Path], view: RunView, torque: float | None
) -> Page:
    """Compare what was read."""
    tables = {name: one for name, one in read.items() if isinstance(one, SteDatabase)}
    runs = {name: one for name, one in read.items() if isinstance(one, RunResult)}
    if tables and runs:
        raise BadInput.of("files", "a table and a run", _BOUND, _ADVICE)
    if tables:
        teeth = next(iter(tables.values())).facts.teeth[0]
        return compare_tables(tables, _measured(files, teeth, "µm"), torque)
    for name, run in runs.items():
        if not run.mesh:
            raise BadInput.of(name, "a run without meshes", "one with a mesh, of whose frequency orders are")
    first = next(iter(runs.values()))
    driver = first.case["meshes"][0]["driver"]
    teeth = next(int(gear["teeth"]) for gear in first.case["gears"] if gear["name"] == driver)
    measured = _measured(files, teeth, shown_signal(first, view).quantity.unit) if files else None
    if measured is not None and not isinstance(measured, MeasuredOrders):
        raise BadInput.of("measured", "a curve over position", "an order spectrum beside a run")
    return compare_runs(runs, view, measured)


def _measured(files: Sequence[Path], teeth: int, unit: str) -> MeasuredCurve | MeasuredOrders | None:
    """Read what was measured, None if nothing was; of a universal file what is in the unit."""
    if not files:
        return None
    if files[0].suffix.lower() in ENDINGS:
        return read_universal(files[0], teeth, unit)
    return read_measured(files[0], teeth)


def named_files(files: Sequence[Path]) -> list[tuple[str, Path]]:
    """Name results by their files: as short as tells them apart."""
    stems = [file.stem for file in files]
    short = len(set(stems)) == len(stems)
    return [(file.stem if short else str(file), file) for file in files]
