"""Dynamic against static transmission error at several speeds of a run."""

from __future__ import annotations

import numpy as np

from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number
from lineofaction.report.runs.run_series import RunSeries
from lineofaction.report.runs.speed_window import PITCHES, is_steady, speed_window, window_speeds

_X = Axis("travel of the driving gear within the window, base pitches", limits=(0, PITCHES))


def dynamic_error(run: RunSeries) -> Figure:
    """Draw three base pitches of both errors at each of several speeds that the run passes."""
    speeds = window_speeds(run.speed_rpm)
    windows = [speed_window(run.position, run.speed_rpm, speed) for speed in speeds]
    return Figure(
        key="dynamic_error",
        title="Dynamic and static transmission error",
        caption="The static curve is the table at the nominal force and the same position; the dynamic one "
        "responds to its steps as an oscillating system.",
        alternative=_words(run, speeds, windows),
        content=tuple(_panel(run, s, w) for s, w in zip(speeds, windows, strict=True)),
        table=_table(run, speeds, windows),
    )


def _panel(run: RunSeries, speed: float, window: slice) -> Panel:
    position = run.position[window] - np.floor(run.position[window][0] + 1e-6)
    lines = (
        Line("dynamic", position, 1e6 * run.dynamic_error[window], palette.BLUE),
        Line("static", position, 1e6 * run.static_error[window], palette.VERMILLION, "dash"),
    )
    passed = "" if is_steady(run.speed_rpm) else "passed "
    title = f"{number(speed, 3)} rpm, {passed}at {number(float(run.time[window].mean()), 3)} s"
    return Panel(_X, Axis("transmission error, µm"), lines, title=title)


def _words(run: RunSeries, speeds: tuple[float, ...], windows: list[slice]) -> str:
    """Give the swing at each speed."""
    swings = [
        f"{_um(np.ptp(run.dynamic_error[w]))} (static {_um(np.ptp(run.static_error[w]))}) at {s:g} rpm"
        for s, w in zip(speeds, windows, strict=True)
    ]
    return f"Peak to peak in µm: {'; '.join(swings)}."


def _table(run: RunSeries, speeds: tuple[float, ...], windows: list[slice]) -> Table:
    """Mean and peak-to-peak of both errors and the extremes of the mesh force at each speed."""
    rows = []
    for speed, window in zip(speeds, windows, strict=True):
        errors = (run.dynamic_error[window], run.static_error[window])
        cells = [_um(value) for error in errors for value in (np.mean(error), np.ptp(error))]
        least, largest = run.least_force[window].min(), run.largest_force[window].max()
        cells += [number(float(v), 4) for v in (least, run.mesh_force[window].mean(), largest)]
        rows.append((number(speed, 3), *cells))
    head = (
        "speed, rpm", "DTE mean, µm", "DTE peak to peak, µm", "STE mean, µm", "STE peak to peak, µm",
        "least mesh force, N", "mean mesh force, N", "largest mesh force, N",
    )  # fmt: skip
    return Table("Transmission error and mesh force by speed", head, tuple(rows))


def _um(value: np.floating) -> str:
    return number(1e6 * float(value))
