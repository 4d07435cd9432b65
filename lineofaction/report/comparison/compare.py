"""Comparison of two results, or of one with a measurement, as a page and as plain JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from bounds.types import Json
from dynamics.orders import Waterfall
from dynamics.results import RunResult
from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.project import results_in
from lineofaction.gearbox.result_files import stamped
from lineofaction.gearbox.signals.endings import ENDINGS
from lineofaction.gearbox.signals.recording import Recording, begins_with_time, read_recording
from lineofaction.report.binding import bound
from lineofaction.report.comparison.measured import (
    COLORS,
    Difference,
    MeasuredCurve,
    MeasuredOrders,
    changed_fields,
    differences_table,
    read_measured,
)
from lineofaction.report.comparison.of_tables import compare_tables
from lineofaction.report.comparison.recorded import Measurement, compare_recording
from lineofaction.report.comparison.universal_files import read_universal
from lineofaction.report.document import file_attributes, of_the_store, page_json, read_result, stored_study
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Dash, Figure, Line, Panel, category_lines, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.run.levels import DEPTH, largest_orders, order_blocks
from lineofaction.report.run.signals import ORDERS, amplitude_spectrum, spectrum_window
from lineofaction.report.run.sound import RunSignal, run_signals, sound_of
from lineofaction.report.run.view import SCALES, RunView, along_direction, decibels, run_axis, selected_signal

_DASHES: tuple[Dash, ...] = ("solid", "dash")
_HIGHEST_ORDER = ORDERS + 0.5  # end of the axis of a spectrum
_ERRORS = {"bearing_force": "bearing_force_orders", "dynamic_transmission_error": "transmission_error_orders"}
"""Series whose orders have stated errors, and their name in the receipt of a run."""

_BOUND = "two results of one kind, two folders, or one result and a measurement"
_REMEDY = "For example: loa compare before.nc after.nc, or loa compare ste.nc measured.csv"
NAMES = ("first", "second")


@dataclass(frozen=True)
class _Side(RunSignal):
    """One of the runs, with the run along the direction shown, and blocks over mesh orders."""

    seen: RunResult
    blocks: Waterfall


def compare_runs(runs: dict[str, RunResult], view: RunView, measured: MeasuredOrders | None) -> Page:
    """Return the page that compares two runs by their names, or a run with a measurement."""
    sides = tuple(_side(run_signal) for run_signal in run_signals(runs, view))
    signal = sides[0].signal
    highest = int(min(side.blocks.line[-1] for side in sides))
    selected = signal.orders or largest_orders(signal, sides[0].blocks)
    orders = tuple(order for order in selected if order <= highest)
    differences = tuple(_differences(sides, orders)) if len(sides) == 2 else ()
    figures = (_levels(sides, orders), _spectra(sides, measured))
    difference_tables = (differences_table(differences, tuple(runs)),) if differences else ()
    sections = [Section(signal.heading, figures=figures, tables=difference_tables)]
    differing = changed_fields({name: run.case for name, run in runs.items()})
    if differing.rows:
        sections.append(Section("Scenes", tables=(differing,)))
    headlines = tuple(Headline(change.name, change.between, change.finding) for change in differences[:3])
    durations = ", ".join(f"{run.time[-1]:g} s" for run in runs.values())
    lead = f"{signal.name}; {durations} of motion; errors are those of runs, not of the tables they take"
    return Page(f"{' and '.join(runs)} compared", lead, headlines, tuple(sections))


def _side(source: RunSignal) -> _Side:
    projected = along_direction(source.run, source.signal)
    return _Side(source.name, source.run, source.signal, projected, order_blocks(projected, source.signal))


def _differences(sides: tuple[_Side, ...], orders: tuple[int, ...]) -> Iterator[Difference]:
    largest = (float(side.signal.magnitude(side.blocks.rms).max()) for side in sides)
    unit = f"{sides[0].signal.quantity.unit} rms"
    first, second = (Estimate(value, math.nan, unit) for value in largest)  # no error is stated
    yield Difference("overall", "its largest", first, second)
    for order in orders:
        first, second = (_order(side, order) for side in sides)
        yield Difference(f"mesh order {order}", "its largest", first, second)


def _order(side: _Side, order: int) -> Estimate:
    name = _ERRORS.get(side.signal.quantity.series, "")
    sources = [
        source[name][order - 1]
        for source in side.run.receipt.get("error", {}).values()
        if isinstance(source, dict) and len(source.get(name, ())) >= order
    ]
    factor = side.signal.quantity.factor * SCALES[side.signal.scale]
    error = factor * math.hypot(*sources) if sources else math.nan
    return Estimate(float(side.signal.amplitude(side.blocks.cut(order)).max()), error, side.signal.unit)


def _levels(sides: tuple[_Side, ...], orders: tuple[int, ...]) -> Figure:
    overall = [side.signal.magnitude(side.blocks.rms) for side in sides]
    floor = max(float(values.max()) for values in overall) * 10.0 ** (-DEPTH / 20.0)
    lines = []
    for side, values, dash in zip(sides, overall, _DASHES, strict=False):
        axis, along = run_axis(side.run, side.blocks.time, side.signal.mesh)
        lines.append(Line(f"overall, {side.name}", along, decibels(values, floor), palette.INK, dash, 2.2))
        names = [f"{order}×, {side.name}" for order in orders]
        cuts = [decibels(side.signal.amplitude(side.blocks.cut(order)), floor) for order in orders]
        lines += category_lines(along, names, cuts, dash=dash)
    signal = sides[0].signal
    change = 20.0 * math.log10(float(overall[-1].max()) / float(overall[0].max()))
    dashed = zip(sides, _DASHES, strict=False)  # of one side the first dash alone
    styles = ". ".join(f"{dash.capitalize()}: {side.name}" for side, dash in dashed)
    return Figure(
        key="levels",
        title=f"Overall level and mesh orders of the {signal.name}",
        caption=f"{styles}. Overall: rms. Orders: {signal.scale} values.",
        alternative=f"The largest overall level changes by {change:+.1f} dB." if len(sides) == 2 else "",
        content=(Panel(axis, Axis(f"level, dB re 1 {signal.unit}"), tuple(lines)),),
        sound=sound_of(sides, axis),
    )


def _spectra(sides: tuple[_Side, ...], orders: MeasuredOrders | None) -> Figure:
    lines = []
    for side, color in zip(sides, COLORS, strict=False):
        window = spectrum_window(side.run.time)
        frequency, amplitude = amplitude_spectrum(side.seen, side.signal, window)
        order = frequency / float(np.median(side.run.mesh_frequency[side.signal.mesh, window]))
        inside = order <= _HIGHEST_ORDER
        drawn = np.maximum(amplitude[inside], 1e-12)  # the axis is logarithmic
        lines.append(Line(side.name, order[inside], drawn, color, width=1.2))
    signal = sides[0].signal
    caption = "90 to 95 % of the duration, over multiples of the mesh frequency in its middle; "
    caption += f"{signal.scale} values."
    if orders is not None:
        orders.require(signal.quantity.unit)
        inside = orders.order <= _HIGHEST_ORDER
        order, amplitude = orders.order[inside], orders.amplitude[inside]
        lines.append(Line("measured", order, amplitude, palette.INK, "dash", 1.2))
        caption += " Measured: as read."
    top = max(float(line.y.max()) for line in lines)
    peaks = []
    for line in lines:
        order_of_peak = float(line.x[np.argmax(line.y)])
        peaks.append(f"{line.name} {number(line.y.max(), 3)} at order {order_of_peak:.2f}")
    y = Axis(f"amplitude, {signal.unit}", "log", (1e-5 * top, 3.0 * top))
    return Figure(
        key="spectra",
        title=f"Spectra of the {signal.name} near the end of the runs",
        caption=caption,
        alternative=f"Largest lines, {signal.unit}: {'; '.join(peaks)}.",
        content=(Panel(Axis("mesh order", limits=(0.0, _HIGHEST_ORDER)), y, tuple(lines)),),
    )


def compare(
    files: Sequence[Path],
    view: RunView,
    torque: float | None = None,
    measurement: Measurement = Measurement(),  # noqa: B008 (frozen)
) -> Page:
    """Compare two tables or runs, or one of them with a measurement.

    Two folders are compared by the tables and runs that stand in both under one name. `measurement` adds what
    the file of a recording does not say. Raises `BadInput`: the files are not one or two of a kind with at
    most one measurement, are damaged, or do not hold what is to be compared.
    """
    folders = [file for file in files if file.is_dir()]
    if folders == list(files) and len(files) == 2:
        return _compare_folders(folders, view, torque)
    if folders:
        remedy = f"Of a folder name the file: {', '.join(map(str, results_in(folders[0]))) or _REMEDY}."
        raise BadInput.of("files", ", ".join(map(str, files)), _BOUND, remedy)
    measured = [file for file in files if file.suffix.lower() in ENDINGS]
    results = dict(named_files([file for file in files if file not in measured]))
    counts = len(results), len(measured)
    if counts not in {(1, 1), (2, 0), (2, 1)}:
        raise BadInput.of("files", ", ".join(map(str, files)) or None, _BOUND, _REMEDY)
    recording = _recording(measured[0]) if measured else None
    if recording is not None:
        return _compared_with_recording(results, recording, view, measurement)
    return _compare_results(results, view, measured, torque)


def _recording(file: Path) -> Recording | None:
    """Return the recording in a file; None if a channel is not over time, as an order spectrum."""
    if file.suffix.lower() == ".csv" and not begins_with_time(file):
        return None
    recording = read_recording(file, "measured")
    over_time = [channel for channel in recording.channels if channel.over == "time"]
    return recording if len(over_time) == len(recording.channels) else None


def _compared_with_recording(
    results: dict[str, Path], recording: Recording, view: RunView, measurement: Measurement
) -> Page:
    """Compare the one run of some result files with a recording."""
    results_read = {name: read_result(file) for name, file in results.items()}
    runs = [(name, run) for name, run in results_read.items() if isinstance(run, RunResult) and run.mesh]
    if len(results_read) != 1 or not runs:
        bound = "one run with a mesh beside a recording over time"
        remedy = "For example: loa compare run.nc test.uff --rpm 3000"
        raise BadInput.of("files", ", ".join(results), bound, remedy)
    return _with_warnings(compare_recording(runs[0], recording, view, measurement), results)


def _with_warnings(page: Page, results: dict[str, Path]) -> Page:
    """Return a page whose alarms begin with the warnings of some result files."""
    warnings = dict.fromkeys(entry["message"] for file in results.values() for entry in stamped(file))
    return replace(page, alarms=(*(f"Warning: {text}" for text in warnings), *page.alarms))


def _compare_folders(folders: Sequence[Path], view: RunView, torque: float | None) -> Page:
    by_folder = {name: _comparable(folder) for name, folder in named_files(folders)}
    first, second = by_folder.values()
    shared = [name for name in first if name in second]
    if not shared:
        text = "; ".join(f"{folder} has {', '.join(files) or 'none'}" for folder, files in by_folder.items())
        kind = "two folders with an STE database or a run of one name"
        raise BadInput.of("files", text, kind, f"Name two files. {_REMEDY}")
    pages = {}
    for name in shared:
        results = {folder: files[name] for folder, files in by_folder.items()}
        pages[name.replace("_", " ")] = _compare_results(results, view, torque=torque)
    unpaired = sorted(first.keys() ^ second.keys())
    rest = f"; in one folder alone: {', '.join(unpaired)}" if unpaired else ""
    page = bound(pages)
    return replace(page, title=f"{' and '.join(by_folder)} compared", lead=f"{page.lead}{rest}")


def _comparable(folder: Path) -> dict[str, Path]:
    """Return the tables and runs in a folder by their names."""
    files = {file.relative_to(folder).with_suffix("").as_posix(): file for file in results_in(folder)}
    return {name: file for name, file in files.items() if stored_study(file_attributes(file)) is None}


def _compare_results(
    results: dict[str, Path], view: RunView, measured: Sequence[Path] = (), torque: float | None = None
) -> Page:
    """Compare result files by their names; parameters and errors as for `compare`."""
    read = {name: read_result(file) for name, file in results.items()}
    return _with_warnings(_page(read, measured, view, torque), results)


def _page(
    read: dict[str, SteDatabase | RunResult], files: Sequence[Path], view: RunView, torque: float | None
) -> Page:
    tables = {name: result for name, result in read.items() if isinstance(result, SteDatabase)}
    runs = {name: result for name, result in read.items() if isinstance(result, RunResult)}
    if tables and runs:
        raise BadInput.of("files", "a table and a run", _BOUND, _REMEDY)
    if tables:
        teeth = next(iter(tables.values())).geometry.teeth[0]
        return compare_tables(tables, _measured(files, teeth, "µm"), torque)
    for name, run in runs.items():
        if not run.mesh:
            raise BadInput.of(name, "a run without meshes", "one with a mesh, of whose frequency orders are")
    first = next(iter(runs.values()))
    driver = first.case["meshes"][0]["driver"]
    teeth = next(int(gear["teeth"]) for gear in first.case["gears"] if gear["name"] == driver)
    measured = _measured(files, teeth, selected_signal(first, view).quantity.unit) if files else None
    if measured is not None and not isinstance(measured, MeasuredOrders):
        raise BadInput.of("measured", "a curve over position", "an order spectrum beside a run")
    return compare_runs(runs, view, measured)


def _measured(files: Sequence[Path], teeth: int, unit: str) -> MeasuredCurve | MeasuredOrders | None:
    """Read the measurement, None without a file; `unit` selects the function of a universal file."""
    if not files:
        return None
    if files[0].suffix.lower() == ".csv":
        return read_measured(files[0], teeth)
    return read_universal(files[0], teeth, unit)


def named_files(files: Sequence[Path]) -> list[tuple[str, Path]]:
    """Name each file by its stem, or all by their paths where two stems are equal."""
    stems = [file.stem for file in files]
    distinct = len(set(stems)) == len(stems)
    return [((file.stem if distinct else "") or str(file), file) for file in files]


def stored_comparison(inputs: Json) -> Json:
    """Compare ``{"files": [...], "printed": bool}``, two tables or two runs; work of the live worker."""
    named = dict(zip(NAMES, map(Path, inputs["files"]), strict=True))
    with of_the_store():
        return page_json(_compare_results(named, RunView()), printed=inputs.get("printed", False))
