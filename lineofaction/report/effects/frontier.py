"""Page of an accuracy study: the choice, the knee, the plot, every fidelity, and fidelities not run.

A peer is another program whose cost and error are drawn beside the fidelities, here of full contact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from dynamics.accuracy import Frontier as SceneFrontier
from fe_contact.analysis.studies.frontier import Frontier
from fe_contact.analysis.studies.full_contact_cost import ORIGIN
from fe_contact.analysis.studies.full_contact_record import PLANE, PROGRAM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Note, Panel, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.drawing.placing import placed
from lineofaction.report.presentation import Presentation

RECORDED = "full contact of this pair, recorded"
_IN_PLANE = ("plane_strain", "corrected_draft", "corrected", "corrected_fine")
Study = Frontier | SceneFrontier


@dataclass(frozen=True)
class _Peer:
    """Points of a peer in the plot."""

    name: str
    """Name in the legend."""
    titles: tuple[str, ...]
    """Names of the n points in the table."""
    time: FloatArray
    """CPU seconds. Shape (n,)."""
    errors: Mapping[str, FloatArray]
    """Relative errors by the names of the figures. Shape (n,) each."""
    mark: str
    """Text of all points in the last column of the table."""
    color: str
    width: float
    """Width of the line that joins the points; 0: no line."""
    note: str = ""
    """Text beside each point in the plot."""


class _ErrorPanel(NamedTuple):
    """A panel of the plot and its column of the table, for one kind of error."""

    figure: str
    """Attribute of a result that is the error."""
    title: str
    axis: str
    """Label of the axis of errors."""
    head: str
    """Head of the column."""


class _Family(NamedTuple):
    """Fidelities that have one color in the plot."""

    name: str
    """Name in the legend."""
    members: tuple[str, ...]
    """Values of the attribute `member` of the results that belong to it."""
    color: str


def _peers(study: Frontier) -> list[_Peer]:
    """Return full contact by its known errors for this pair, and by its recorded curves."""
    peers = []
    measured = study.full_contact
    levels = study.known_full_contact
    if levels:
        titles = tuple(f"full contact, {level.unknowns // 1000} k unknowns" for level in levels)
        time = np.array([level.seconds(study.solves) for level in levels])
        errors = {"mean_error": np.array([level.relative_error for level in levels])}
        known = _Peer("full contact, 2-D", titles, time, errors, "known cost", palette.VERMILLION, 1.8)
        peers.append(known)
    if measured is not None:
        titles = (f"full contact, recorded, {measured.record.unknowns // 1000} k unknowns",)
        mark = f"{measured.solved} of {measured.solves} positions x loads solved"
        names = ("mean_error", "peak_to_peak_error")
        errors = {name: np.array([getattr(measured, name)]) for name in names}
        time = np.array([measured.seconds(study.solves)])
        peers.append(_Peer(RECORDED, titles, time, errors, mark, palette.PURPLE, 0.0, "full contact"))
    return peers


def _peer_caption(study: Frontier) -> str:
    """Return a sentence on the source of the points, and on the measured values."""
    times = f"Peer: {ORIGIN}; times for the same {study.solves} positions x loads."
    known = f"{times} " if study.known_full_contact else ""
    measured = study.full_contact
    if measured is None:
        return known.strip()
    record, plane_error = measured.record, measured.plane_strain_mean
    meshes = record.mesh_error
    plane = ", and hold what plane strain leaves out" if record.solved_in == PLANE else ""
    remarks = ""
    if np.isfinite(meshes):
        remarks = f" Its own meshes differ by at most {number(100.0 * meshes, 2)} %."
    if np.isfinite(plane_error):
        remarks += f" Our plane strain differs from it by {number(100.0 * plane_error, 2)} % of the mean."
    return (
        f"{known}Recorded curves: {PROGRAM} of version {record.version} solved {record.position.size} "
        f"positions under {record.torque.size} loads in {record.solved_in} "
        f"({record.unknowns // 1000} k unknowns, "
        f"{number(measured.cpu_seconds, 3)} CPU s): its errors are those at these positions, the worst of "
        f"all loads{plane}; its time is extrapolated, the mean of a position and load times "
        f"{study.solves}.{remarks}"
    )


@dataclass(frozen=True)
class _Look:
    """The texts, panels and columns that show an accuracy study."""

    key: str
    title: str
    """`key`, `title`: Key and title of the plot."""
    time: str
    """Label of the axis of time."""
    panels: tuple[_ErrorPanel, ...]
    member: str
    """Attribute of a result by which it belongs to a family."""
    families: tuple[_Family, ...]
    further: tuple[tuple[str, Callable[[Any], str]], ...]
    """Head and text of the columns of the table behind the errors."""
    table: str
    """Caption of the table."""
    chosen: str
    """Meaning of the mark "chosen"."""
    lead: Callable[[Any], str]
    """Text on what was compared."""
    caption: Callable[[Any], str]
    """Caption of the plot."""
    peers: Callable[[Any], Sequence[_Peer]] = lambda _study: ()
    """Points of other programs in the plot."""


def _case_caption(study: Frontier) -> str:
    return (
        f"Largest relative difference to the finest fidelity ({study.reference.title}) over all curves of "
        f"the table of {study.solves} positions x loads; the point of that fidelity is what its mesh leaves "
        f"by its convergence, and nothing below it can be told apart. {_peer_caption(study)}".strip()
    )


def _scene_caption(study: SceneFrontier) -> str:
    return (
        f"Root of the sum of squared differences to the finest fidelity ({study.reference.title}), "
        f"relative, over {study.blocks} blocks of the run and {study.orders} mesh orders; the point of that "
        "fidelity is what its steps leave, by the rate at which errors fall towards it. All fidelities share "
        "the tables: a third of what every second position node changes is their own error."
    )


_CASE = _Look(
    key="frontier",
    title="Error of each fidelity over its CPU time, this case",
    time="CPU time of the table, s",
    panels=(
        _ErrorPanel("mean_error", "Mean", "error of the mean, %", "mean error, %"),
        _ErrorPanel(
            "peak_to_peak_error", "Peak to peak", "error of peak to peak, %", "peak-to-peak error, %"
        ),
    ),
    member="name",
    families=(
        _Family("closed forms", ("iso6336", "thin_slices"), palette.ORANGE),
        _Family("2-D finite elements", _IN_PLANE, palette.BLUE),
        _Family("3-D finite elements", ("3d_draft", "3d_standard", "3d_fine"), palette.GREEN),
    ),
    further=(("memory, MiB", lambda result: number(result.peak_memory_bytes / 2**20, 3)),),
    table="Accuracy study",
    chosen="chosen for the requested accuracy",
    lead=lambda study: f"{len(study.results)} fidelities, tables of {study.solves} positions x loads",
    caption=_case_caption,
    peers=_peers,
)
_SCENE = _Look(
    key="run_frontier",
    title="Error of each fidelity over its CPU time, this scene",
    time="CPU time of the run, s",
    panels=(
        _ErrorPanel("rms_error", "Transmission error, rms", "error of the rms, %", "DTE rms error, %"),
        _ErrorPanel(
            "transmission_error_orders",
            "Transmission error, orders",
            "error of the orders, %",
            "DTE orders error, %",
        ),
        _ErrorPanel(
            "bearing_force_orders",
            "Bearing forces, orders",
            "error of the orders, %",
            "bearing-force orders error, %",
        ),
    ),
    member="family",
    families=(
        _Family("fewer effects", ("model",), palette.ORANGE),
        _Family("fewer position nodes", ("table",), palette.GREEN),
        _Family("step tolerance", ("steps",), palette.BLUE),
    ),
    further=(),
    table="Accuracy study of the scene",
    chosen="the scene's own setting",
    lead=lambda study: (
        f"{len(study.results)} fidelities of the vibration: {study.blocks} blocks, {study.orders} orders"
    ),
    caption=_scene_caption,
)


def _look_of(study: Study) -> _Look:
    return _CASE if isinstance(study, Frontier) else _SCENE


def _frontier_figure(study: Study) -> Figure:
    look = _look_of(study)
    peers = look.peers(study)
    times = [result.cpu_seconds for result in study.results]
    times += [time for peer in peers for time in peer.time]
    time_axis = Axis(look.time, "log", (0.5 * min(times), 3.0 * max(times)))  # room for texts beside points
    return Figure(
        key=look.key,
        title=look.title,
        caption=look.caption(study),
        alternative=_quickest(study),
        content=tuple(_panel(study, look, peers, time_axis, panel) for panel in look.panels),
        table=_frontier_table(study),
    )


def _frontier_table(study: Study) -> Table:
    look = _look_of(study)
    figures = [panel.figure for panel in look.panels]
    rows = []
    for result in study.results:
        errors = [_per_cent(getattr(result, figure)) for figure in figures]
        further = [cell(result) for _, cell in look.further]
        cells = (*errors, *further, _mark(study, result.name))
        rows.append((result.title, number(result.cpu_seconds, 3), *cells))
    for peer in look.peers(study):
        for k, title in enumerate(peer.titles):
            errors = [_per_cent(peer.errors[name][k]) if name in peer.errors else "" for name in figures]
            rows.append((title, number(peer.time[k], 3), *errors, *("" for _ in look.further), peer.mark))
    heads = [*(panel.head for panel in look.panels), *(head for head, _ in look.further)]
    return Table(look.table, ("fidelity", "CPU time, s", *heads, "mark"), tuple(rows))


def _frontier_page(study: Study) -> Page:
    look, table = _look_of(study), _frontier_table(study)
    by_name = {result.name: result for result in study.results}
    heads = []
    for text, name in ((look.chosen, study.chosen), ("knee", study.knee)):
        result = None if name is None else by_name.get(name)
        if result is not None:
            heads.append(Headline(text, result.title, f"{number(result.cpu_seconds, 2)} CPU s"))
    tables = [table]
    if study.omitted:
        omitted = tuple(study.omitted.items())
        tables.append(Table("Fidelities that were not run", ("fidelity", "because"), omitted))
    figure = replace(_frontier_figure(study), table=None)
    section = Section(table.caption, "", (figure,), tuple(tables))
    return Page("Error over CPU time", look.lead(study), tuple(heads), (section,))


def _panel(study: Study, look: _Look, peers: Sequence[_Peer], time_axis: Axis, panel: _ErrorPanel) -> Panel:
    """Return one panel: points by family, peers, and the marks."""
    drawn = [(result, 100.0 * getattr(result, panel.figure)) for result in study.results]
    drawn = [(result, error) for result, error in drawn if error > 0.0]
    lines = []
    for family in look.families:
        points = [(r.cpu_seconds, error) for r, error in drawn if getattr(r, look.member) in family.members]
        if points:
            time, errors = np.array(points).T
            lines.append(Line(family.name, time, errors, family.color, width=0, markers=True))
    notes = []
    for result, error in drawn:
        label, marks = result.name.replace("_", " "), _mark(study, result.name)
        notes.append(Note(result.cpu_seconds, error, f"{label} ({marks})" if marks else label))
    for peer in peers:
        errors = 100.0 * peer.errors.get(panel.figure, np.zeros(0))
        if np.any(errors > 0.0):
            lines.append(Line(peer.name, peer.time, errors, peer.color, width=peer.width, markers=True))
            notes += [Note(*point, peer.note) for point in zip(peer.time, errors, strict=True) if peer.note]
    if not lines:
        return Panel(time_axis, Axis(panel.axis, "log"), title=panel.title)
    values = np.concatenate([line.y for line in lines])
    limits = 0.6 * float(values.min()), 1.7 * float(values.max())  # room for the outermost points' texts
    error_axis = Axis(panel.axis, "log", limits)
    placed_notes = placed(notes, time_axis, error_axis, limits)
    return Panel(time_axis, error_axis, tuple(lines), title=panel.title, notes=placed_notes)


def _mark(study: Study, name: str) -> str:
    marks = (("knee", study.knee), ("chosen", study.chosen), ("reference", study.reference.name))
    return ", ".join(mark for mark, marked in marks if marked == name)


def _per_cent(value: float) -> str:
    """Write a relative error in per cent; nothing if it is not known."""
    return number(100.0 * value, 2) if np.isfinite(value) else ""


def _quickest(study: Study) -> str:
    parts = []
    for limit, text in ((0.01, "1 %"), (0.001, "0.1 %")):
        good = [result for result in study.results[:-1] if result.error <= limit]  # without the finest
        if good:
            best = min(good, key=lambda result: result.cpu_seconds)
            parts.append(f"within {text}: {best.title}, {number(best.cpu_seconds, 2)} CPU s")
    return f"Fastest fidelity {'; '.join(parts)}." if parts else "No fidelity comes within 1 % of the finest."


def _text(study: Study) -> Iterator[Table | str]:
    yield _frontier_table(study)
    for name, reason in study.omitted.items():
        yield f"not run: {name}: {reason}"


PAGE = Presentation(_frontier_figure, _frontier_page, _text)
