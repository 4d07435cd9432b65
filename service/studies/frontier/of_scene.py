"""Error against time of the accuracy study of one scene."""

from __future__ import annotations

import numpy as np

from dynamics.accuracy import Frontier
from service.report import palette
from service.report.figure import Axis, Figure, Line, Note, Panel, Table, number
from service.studies.frontier.marks import mark, marked_name, per_cent, quickest

_HEAD = (
    "rung", "CPU time, s", "DTE rms error, %", "DTE orders error, %", "bearing-force orders error, %", "mark",
)  # fmt: skip
_FAMILIES = (
    ("fewer effects", "model", palette.ORANGE),
    ("fewer position nodes", "table", palette.GREEN),
    ("step tolerance", "steps", palette.BLUE),
)
_PANELS = (
    ("Transmission error, rms", "error of the rms, %", 0),
    ("Transmission error, orders", "error of the orders, %", 1),
    ("Bearing forces, orders", "error of the orders, %", 2),
)


def run_frontier_figure(found: Frontier) -> Figure:
    """Draw the errors of every rung over its time, log-log."""
    reference = found.results[-1]
    return Figure(
        key="run_frontier",
        title="What accuracy costs in time on this scene",
        caption=f"Root of the sum of squared differences to the finest rung ({reference.title}), "
        f"relative, over {found.blocks} blocks of the run and {found.orders} mesh orders; the point of that "
        "rung is what its steps leave, by the rate at which errors fall towards it. All rungs share the "
        "tables: a third of what every second position node changes is their own error.",
        alternative=quickest(found),
        content=tuple(_panel(found, *panel) for panel in _PANELS),
        table=run_frontier_table(found),
    )


def run_frontier_table(found: Frontier) -> Table:
    """Return every rung."""
    rows = [
        (
            result.title,
            number(result.cpu_seconds, 3),
            *(per_cent(error) for error in result.errors),
            mark(found, result.name),
        )
        for result in found.results
    ]
    return Table("Accuracy study of the scene", _HEAD, tuple(rows))


def _panel(found: Frontier, title: str, label: str, which: int) -> Panel:
    """One panel: points by family, and the marks."""
    lines, notes = [], []
    for name, family, color in _FAMILIES:
        points = [r for r in found.results if r.family == family and r.errors[which] > 0.0]
        if points:
            time = np.array([r.cpu_seconds for r in points])
            error = 100.0 * np.array([r.errors[which] for r in points])
            lines.append(Line(name, time, error, color, width=0, markers=True))
        notes += [Note(r.cpu_seconds, 100.0 * r.errors[which], marked_name(found, r.name)) for r in points]
    return Panel(_time_axis(found), Axis(label, "log"), tuple(lines), title=title, notes=tuple(notes))


def _time_axis(found: Frontier) -> Axis:
    """Return one axis for all panels."""
    seconds = [result.cpu_seconds for result in found.results]
    return Axis("CPU time of the run, s", "log", (0.5 * min(seconds), 4.0 * max(seconds)))
