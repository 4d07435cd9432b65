"""Error against time of the accuracy study, with the peer: full finite-element contact."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_contact.analysis.fidelity_result import FidelityResult
from fe_contact.analysis.frontier import Frontier
from fe_contact.analysis.measured_full_contact import MeasuredFullContact
from service.report import palette
from service.report.figure import Axis, Figure, FloatArray, Line, Note, Panel, Table, number
from service.report.note_places import placed
from service.studies.frontier import full_contact
from service.studies.frontier.marks import mark, marked_name, per_cent, quickest

_HEAD = (
    "rung", "CPU time, s", "mean error, %", "peak-to-peak error, %", "memory, MiB", "mark",
)  # fmt: skip
_FAMILIES = (
    ("closed forms", ("iso6336", "thin_slices"), palette.ORANGE),
    ("2-D finite elements", ("plane_strain", "corrected_draft", "corrected", "corrected_fine"), palette.BLUE),
    ("3-D finite elements", ("3d_draft", "3d_standard", "3d_fine"), palette.GREEN),
)
Assessed = FidelityResult | MeasuredFullContact


def frontier_figure(found: Frontier) -> Figure:
    """Draw the error of mean and peak-to-peak of every rung over its time, log-log."""
    reference = found.reference.title
    return Figure(
        key="frontier",
        title="What accuracy costs in time on this case",
        caption=f"Largest relative difference to the finest rung ({reference}) over all curves of the table "
        f"of {found.solves} positions x loads; the point of that rung is what its mesh leaves by its "
        f"convergence, and nothing below it can be told apart. {full_contact.caption(found)}".strip(),
        alternative=quickest(found),
        content=(
            _panel(found, "Mean", "error of the mean, %", lambda r: r.mean_error, with_peer=True),
            _panel(found, "Peak to peak", "error of peak to peak, %", lambda r: r.peak_to_peak_error),
        ),
        table=frontier_table(found),
    )


def frontier_table(found: Frontier) -> Table:
    """Return every rung, and full contact as far as it is known of this case."""
    rows = [
        (
            result.title,
            number(result.cpu_seconds, 3),
            per_cent(result.mean_error),
            per_cent(result.peak_to_peak_error),
            number(result.peak_memory_bytes / 2**20, 3),
            mark(found, result.name),
        )
        for result in found.results
    ]
    return Table("Accuracy study", _HEAD, (*rows, *full_contact.rows(found)))


def _panel(
    found: Frontier, title: str, label: str, error: Callable[[Assessed], float], *, with_peer: bool = False
) -> Panel:
    """One panel: points by family, the peer, and the marks."""
    lines = []
    for name, members, color in _FAMILIES:
        points = [r for r in found.results if r.name in members and error(r) > 0.0]
        if points:
            time = np.array([r.cpu_seconds for r in points])
            lines.append(Line(name, time, _percent([error(r) for r in points]), color, width=0, markers=True))
    if with_peer:
        lines += full_contact.known_cost(found)
    assessed = float("nan") if found.full_contact is None else error(found.full_contact)
    live, named = full_contact.live_point(found, assessed)
    lines += live
    notes = [
        Note(r.cpu_seconds, 100.0 * error(r), marked_name(found, r.name))
        for r in found.results
        if error(r) > 0.0
    ]
    notes += named
    drawn = np.concatenate([line.y for line in lines])
    limits = 0.6 * float(drawn.min()), 1.7 * float(drawn.max())  # room for the texts of the outermost points
    across, along = _time_axis(found), Axis(label, "log", limits)
    beside = placed(notes, across, along, limits)
    return Panel(across, along, tuple(lines), title=title, notes=beside)


def _time_axis(found: Frontier) -> Axis:
    """Return one axis for both panels, from the quickest rung to the slowest rung or peer."""
    times = [*(result.cpu_seconds for result in found.results), *full_contact.times(found)]
    return Axis("CPU time of the table, s", "log", (0.5 * min(times), 3.0 * max(times)))


def _percent(values: list[float]) -> FloatArray:
    """Per cent."""
    return 100.0 * np.array(values, dtype=float)
