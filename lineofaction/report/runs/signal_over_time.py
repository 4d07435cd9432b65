"""The shown quantity over the whole run and over a few base pitches of it."""

from __future__ import annotations

import numpy as np

from dynamics.results import RunResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.envelope import envelope
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number
from lineofaction.report.runs.run_series import RunSeries
from lineofaction.report.runs.run_view import Signal
from lineofaction.report.runs.speed_window import speed_window, window_speeds

AXES = "Components in the fixed frame; of a planet bearing in its carrier's."
DETAIL = "Below: less the mean of the window."


def signal_over_time(run: RunResult, series: RunSeries, signal: Signal) -> Figure:
    """Draw the components of the quantity, over the few base pitches less their means: the ripple is seen."""
    speed = window_speeds(series.speed_rpm)[-1]
    window = speed_window(series.position, series.speed_rpm, speed)
    of = "base pitches" if run.mesh else "turns"
    detail = f"three {of} at {number(speed, 3)} rpm"
    vector = signal.quantity.part == "bearing"
    quantity, _, unit = signal.label.rpartition(", ")
    return Figure(
        key="signal",
        title=f"Time history of the {signal.name}",
        caption=f"{AXES} {DETAIL}" if vector else DETAIL,
        alternative=_words(run, signal, window),
        content=(
            _panel(run, signal, slice(None), "whole run", signal.label),
            _panel(run, signal, window, detail, f"{quantity} less its mean, {unit}", about_mean=True),
        ),
        table=_table(run, signal),
    )


def _panel(
    run: RunResult, signal: Signal, window: slice, title: str, label: str, *, about_mean: bool = False
) -> Panel:
    """Draw one stretch of time."""
    lines = []
    for index, (component, values) in enumerate(signal.components(run).items()):
        own = values[window]
        time, decimated = envelope(run.time[window], own - own.mean() if about_mean else own)
        name = component or signal.quantity.noun
        lines.append(Line(name, time, decimated, palette.category(index), width=1.2))
    ends = (float(run.time[window][0]), float(run.time[window][-1]))
    return Panel(Axis("time, s", limits=ends), Axis(label), tuple(lines), title=title)


def _words(run: RunResult, signal: Signal, window: slice) -> str:
    """Give the mean and the swing near the highest speed."""
    size = signal.magnitude(getattr(run, signal.quantity.series)[..., window])
    mean, swing = number(float(size.mean()), 4), number(float(np.ptp(size)), 3)
    unit = signal.quantity.unit
    return f"Magnitude {mean} {unit} on average, {swing} {unit} peak to peak."


def _table(run: RunResult, signal: Signal) -> Table:
    """Mean and standard deviation of the quantity at every part over the run."""
    unit, values = signal.quantity.unit, signal.quantity.factor * getattr(run, signal.quantity.series)
    names = run.bearing if values.ndim == 3 else run.mesh
    parts = ("x", "y", "z") if values.ndim == 3 else ("",)
    moments = np.stack([values.mean(axis=-1), values.std(axis=-1)], axis=1).reshape(len(names), -1)
    rows = [(name, *(number(float(v), 4) for v in row)) for name, row in zip(names, moments, strict=True)]
    head = (
        signal.quantity.part,
        *(f"mean {part}, {unit}".replace(" ,", ",") for part in parts),
        *(f"deviation {part}, {unit}".replace(" ,", ",") for part in parts),
    )
    return Table("Mean and standard deviation over the run", head, tuple(rows))
