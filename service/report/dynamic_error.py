"""Dynamic against static transmission error at several speeds of a run."""

from __future__ import annotations

import math

import numpy as np

from fe_contact.ste import SteDatabase
from service.report import palette
from service.report.aligned import aligned
from service.report.figure import Axis, Figure, FloatArray, Line, Panel, Table, number
from service.report.run_series import RunSeries
from service.report.speed_window import PITCHES, speed_window, window_speeds

_X = Axis("position of the driving gear within the window, base pitches", limits=(0, PITCHES))


def dynamic_error(run: RunSeries, database: SteDatabase | None) -> Figure:
    """Draw three base pitches at each of several speeds, with STE where the database is at hand."""
    speeds = window_speeds(run.speed_rpm)
    windows = [speed_window(run.position, run.speed_rpm, speed) for speed in speeds]
    return Figure(
        key="dynamic_error",
        title="Dynamic and static transmission error",
        caption="The static curve is the database at the nominal force. The faster the gears turn, the "
        "less the dynamic error follows the steps of the static one.",
        alternative=_words(run, speeds, windows),
        content=tuple(_panel(run, database, s, w) for s, w in zip(speeds, windows, strict=True)),
        table=_table(run, database, speeds, windows),
    )


def static_error(run: RunSeries, database: SteDatabase, window: slice) -> FloatArray:
    """Return STE in m at the samples of `window` under the nominal force."""
    normal = run.nominal_force / math.cos(database.facts.base_helix_angle)
    return database.ste(run.position[window], normal, *aligned(database))


def _panel(run: RunSeries, database: SteDatabase | None, speed: float, window: slice) -> Panel:
    """Draw one speed."""
    place = np.abs(run.position[window] - run.position[0])
    place = place - np.floor(place[0] + 1e-6)
    lines = [Line("dynamic", place, 1e6 * run.transmission_error[window], palette.BLUE)]
    if database is not None:
        static = 1e6 * static_error(run, database, window)
        lines.append(Line("static", place, static, palette.VERMILLION, "dash"))
    moment = number(float(run.time[window].mean()), 3)
    title = f"{number(speed, 3)} rpm, {moment} s"
    return Panel(_X, Axis("transmission error, µm"), tuple(lines), title=title)


def _words(run: RunSeries, speeds: tuple[float, ...], windows: list[slice]) -> str:
    """Give the swing at each speed."""
    swings = [
        f"{number(float(np.ptp(run.transmission_error[window])) * 1e6, 3)} µm at {number(speed, 3)} rpm"
        for speed, window in zip(speeds, windows, strict=True)
    ]
    return f"Peak to peak of the dynamic error: {', '.join(swings)}."


def _table(
    run: RunSeries, database: SteDatabase | None, speeds: tuple[float, ...], windows: list[slice]
) -> Table:
    """Mean and peak-to-peak of both errors and the extremes of the mesh force at each speed."""
    rows = []
    for speed, window in zip(speeds, windows, strict=True):
        error, force = run.transmission_error[window], run.mesh_force[window]
        static = None if database is None else static_error(run, database, window)
        cells = [_um(np.mean(error)), _um(np.ptp(error))]
        cells += ["", ""] if static is None else [_um(np.mean(static)), _um(np.ptp(static))]
        cells += [number(float(v), 4) for v in (force.min(), force.mean(), force.max())]
        rows.append((number(speed, 3), *cells))
    head = (
        "speed, rpm", "DTE mean, µm", "DTE peak to peak, µm", "STE mean, µm", "STE peak to peak, µm",
        "least mesh force, N", "mean mesh force, N", "largest mesh force, N",
    )  # fmt: skip
    return Table("Transmission error and mesh force by speed", head, tuple(rows))


def _um(value: np.floating) -> str:
    """Write metres as micrometres."""
    return number(1e6 * float(value))
