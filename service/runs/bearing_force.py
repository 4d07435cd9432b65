"""Bearing force over the whole run and over a few base pitches of it."""

from __future__ import annotations

import numpy as np

from service.drawing import palette
from service.drawing.envelope import envelope
from service.drawing.figure import Axis, Figure, Line, Panel, Table, number
from service.runs.run_series import RunSeries
from service.runs.speed_window import speed_window, window_speeds

_COMPONENTS = ("x", "y", "z")


def bearing_force(run: RunSeries) -> Figure:
    """Draw the components of the force on the bearing where it varies most."""
    name = run.loudest_bearing
    speed = window_speeds(run.speed_rpm)[-1]
    window = speed_window(run.position, run.speed_rpm, speed)
    detail = f"three base pitches at {number(speed, 3)} rpm"
    return Figure(
        key="bearing_force",
        title=f"Force on bearing {name}",
        caption="Components in the fixed frame. The bearing shown is the one where the force varies most.",
        alternative=_words(run, name, window),
        content=(_panel(run, name, slice(None), "whole run"), _panel(run, name, window, detail)),
        table=_table(run),
    )


def _panel(run: RunSeries, name: str, window: slice, title: str) -> Panel:
    """Draw one stretch of time; a component that stays at zero is left out."""
    force = run.bearings[name]
    lines = []
    for axis, component in enumerate(_COMPONENTS):
        if np.any(force[:, axis]):
            time, values = envelope(run.time[window], force[window, axis])
            lines.append(Line(component, time, values, palette.category(axis), width=1.2))
    ends = (float(run.time[window][0]), float(run.time[window][-1]))
    return Panel(Axis("time, s", limits=ends), Axis("force, N"), tuple(lines), title=title)


def _words(run: RunSeries, name: str, window: slice) -> str:
    """Give the mean and the swing near the highest speed."""
    size = np.linalg.norm(run.bearings[name][window], axis=1)
    mean, swing = number(float(size.mean()), 4), number(float(np.ptp(size)), 3)
    return f"Magnitude {mean} N on average, {swing} N peak to peak."


def _table(run: RunSeries) -> Table:
    """Mean and standard deviation of every bearing's components over the run."""
    rows = []
    for name, force in run.bearings.items():
        means = [number(float(v), 4) for v in force.mean(axis=0)]
        spreads = [number(float(v), 4) for v in force.std(axis=0)]
        rows.append((name, *means, *spreads))
    head = ("bearing", *(f"mean {c}, N" for c in _COMPONENTS), *(f"deviation {c}, N" for c in _COMPONENTS))
    return Table("Bearing forces over the run", head, tuple(rows))
