"""Error against time of the accuracy study of one scene."""

from __future__ import annotations

import numpy as np

from dynamics.accuracy import FidelityResult, Frontier
from service.report import palette
from service.report.figure import Axis, Figure, Line, Note, Panel, Table, number

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
        alternative=_words(found),
        content=tuple(_panel(found, *panel) for panel in _PANELS),
        table=run_frontier_table(found),
    )


def run_frontier_table(found: Frontier) -> Table:
    """Return every rung."""
    rows = [
        (
            result.title,
            number(result.cpu_seconds, 3),
            *(_per_cent(error) for error in result.errors),
            _mark(found, result),
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
        notes += [Note(r.cpu_seconds, 100.0 * r.errors[which], _note(found, r)) for r in points]
    return Panel(_time_axis(found), Axis(label, "log"), tuple(lines), title=title, notes=tuple(notes))


def _time_axis(found: Frontier) -> Axis:
    """Return one axis for all panels."""
    seconds = [result.cpu_seconds for result in found.results]
    return Axis("CPU time of the run, s", "log", (0.5 * min(seconds), 4.0 * max(seconds)))


def _note(found: Frontier, result: FidelityResult) -> str:
    """Name of a rung and its marks."""
    mark, name = _mark(found, result), result.name.replace("_", " ")
    return f"{name} ({mark})" if mark else name


def _mark(found: Frontier, result: FidelityResult) -> str:
    """Knee, chosen, reference."""
    marks = (("knee", found.knee), ("chosen", found.chosen), ("reference", found.results[-1].name))
    return ", ".join(mark for mark, name in marks if name == result.name)


def _per_cent(value: float) -> str:
    """Write a relative error in per cent; nothing if it is not known."""
    return number(100.0 * value, 2) if np.isfinite(value) else ""


def _words(found: Frontier) -> str:
    """Say the quickest rungs below one per cent and one per mille."""
    parts = []
    for limit, text in ((0.01, "1 %"), (0.001, "0.1 %")):
        good = [r for r in found.results[:-1] if r.error <= limit]
        if good:
            best = min(good, key=lambda r: r.cpu_seconds)
            parts.append(f"within {text}: {best.title}, {number(best.cpu_seconds, 2)} CPU s")
    return f"Quickest rung {'; '.join(parts)}." if parts else "No rung comes within 1 % of the finest."
