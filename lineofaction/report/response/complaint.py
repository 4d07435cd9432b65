"""Page of an answered complaint: excitations at its frequency and near it, and modes within reach.

What passes is a harmonic of a mesh, a shaft or a rolling bearing; it has an order, a multiple of the rotation
of the complaint's shaft, and so a frequency. Parts that pass alike, such as the meshes of equal planets, have
one harmonic at one order: they are a group, a tuple whose first member stands for it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bounds import engineering
from dynamics.mechanism.passing import MESH, SAME, Passing
from lineofaction.gearbox.convert.complaint import (
    Complaint,
    cause_words,
    grouped,
    harmonic_label,
    offset_text,
    sentence,
)
from lineofaction.gearbox.studies.complaint.run import AnsweredComplaint
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Dash, Figure, Line, Panel, Reference, Table, number
from lineofaction.report.drawing.page import Headline
from lineofaction.report.presentation import dynamics_presentation

AXIS_ENDS = (0.7, 1.3)
"""Ends of the axes of speed and frequency, as shares of the complaint's speed and frequency."""
MAX_BEYOND = 4
"""Groups of harmonics beyond the tolerance that are drawn and listed."""
MODE_LABELS = (0.15, 0.35, 0.65)
"""Positions of the modes' labels as shares of the width; as many modes are drawn, the most amplified ones."""


class _GroupLine(NamedTuple):
    """A group of excitations near the complaint, and the style of its line in the figure."""

    group: tuple[Passing, ...]
    color: str
    dash: Dash
    width: float


def _figure(answer: AnsweredComplaint) -> Figure:
    complaint = answer.complaint
    if complaint.speed is None or complaint.frequency is None:
        panel = _by_order(complaint)
    else:
        panel = _over_speed(complaint, complaint.speed, complaint.frequency)
    references = [*panel.references]
    for mode, share in zip(answer.modes, MODE_LABELS, strict=False):  # fewer modes, or fewer labels
        name = f"mode {number(mode.frequency)} Hz"
        references.append(Reference(name, mode.frequency, "horizontal", share))
    return Figure(
        key="complaint",
        title="Complaint, and what passes there",
        caption="Lines: harmonics of meshes, shafts and bearings; bold: within "
        f"{engineering(100.0 * complaint.tolerance, 3)} % of the complaint. Dashed: speed and frequency of "
        "the complaint, and the modes within reach.",
        alternative=f"{sentence(complaint)}.",
        content=(replace(panel, references=tuple(references)),),
        table=_passing_table(answer),
    )


def _groups(complaint: Complaint) -> list[tuple[Passing, ...]]:
    """Return the shown groups: within the tolerance, then the nearest of the others."""
    within = complaint.within
    others = grouped(passing for passing in complaint.passing if passing not in within)
    return [*grouped(within), *others[:MAX_BEYOND]]


def _group_lines(complaint: Complaint) -> Iterator[_GroupLine]:
    """Yield the groups that are shown with their looks; bold is within the tolerance."""
    for index, group in enumerate(_groups(complaint)):
        color = palette.category(index)
        if group[0] in complaint.within:
            yield _GroupLine(group, color, "solid", width=2.4)
        else:
            yield _GroupLine(group, color, "dot", width=1.2)


def _over_speed(complaint: Complaint, speed: float, frequency: float) -> Panel:
    """Draw frequencies over the shaft's speed about a complaint at `speed`, rad/s, and `frequency`, Hz."""
    ends = np.array(AXIS_ENDS)
    rpm = ends * speed / RPM
    lines = []
    for line in _group_lines(complaint):
        hertz = line.group[0].order * rpm / 60.0
        lines.append(Line(harmonic_label(line.group), rpm, hertz, line.color, line.dash, line.width))
    low, high = ends * frequency
    x = Axis.over(f"speed of {complaint.shaft}, rpm", rpm)
    return Panel(x, Axis("frequency, Hz", limits=(float(low), float(high))), tuple(lines))


def _by_order(complaint: Complaint) -> Panel:
    """Draw the groups as points at their order and their distance from the complaint."""
    points = []
    for line in _group_lines(complaint):
        order, distance = np.array([line.group[0].order]), np.array([100.0 * line.group[0].distance])
        look = line.color, line.dash
        points.append(Line(harmonic_label(line.group), order, distance, *look, width=0.0, markers=True))
    axes = Axis(f"order of {complaint.shaft}"), Axis("distance from the complaint, %")
    return Panel(*axes, tuple(points), (Reference("complaint", complaint.order),))


def _passing_table(answer: AnsweredComplaint) -> Table:
    complaint = answer.complaint
    forces = dict(zip(complaint.within, answer.forces, strict=True))
    columns = {
        "what": harmonic_label,
        "order": lambda group: number(group[0].order, 5),
        "frequency, Hz": lambda group: number(complaint.hertz(group[0].order) or np.nan, 5),
        "off, %": lambda group: _percent(group[0].distance, 2),
        "within": lambda group: "yes" if group[0] in complaint.within else "no",
        "excites by, N": lambda group: _newtons(max(map(complaint.level, group))),
        "force, N": lambda group: _newtons(forces[group[0]].force if group[0] in forces else np.nan),
        "on bearing": lambda group: forces[group[0]].bearing if group[0] in forces else "",
    }
    return Table.of(f"Orders of {complaint.shaft} beside the complaint", _groups(complaint), columns)


def _percent(distance: float, decimals: int) -> str:
    """Return a relative distance in percent, 0 for the same order."""
    return "0" if abs(distance) < SAME else f"{100.0 * distance:+.{decimals}f}"


def _newtons(force: float) -> str:
    """Return a force in words; an empty cell says that it is not known."""
    return number(force, 3) if np.isfinite(force) else ""


def _mode_table(answer: AnsweredComplaint) -> Table:
    columns = {
        "frequency, Hz": lambda mode: number(mode.frequency, 5),
        "off, %": lambda mode: _percent(mode.distance, 1),
        "damping ratio, %": lambda mode: number(100.0 * mode.damping_ratio, 3),
        "amplification": lambda mode: number(mode.amplification, 3),
        "dB": lambda mode: f"{20.0 * np.log10(mode.amplification):+.1f}",
        "kind": lambda mode: mode.kind,
    }
    return Table.of("Modes within reach: at least 6 dB at the frequency", answer.modes, columns)


def _headlines(answer: AnsweredComplaint) -> tuple[Headline, ...]:
    complaint = answer.complaint
    first, *others = grouped(complaint.within)
    several = any(group[0].excitation.kind == MESH for group in others)
    ranked = f"; the likeliest by distance and {complaint.ranked_by}" if several else ""
    offset = f"{offset_text(complaint, first[0])}{ranked}"
    headlines = [Headline("complaint", cause_words(complaint, first), offset)]
    if others:
        causes = [f"{cause_words(complaint, group)}, {offset_text(complaint, group[0])}" for group in others]
        resolution = _resolution(first[0], [group[0] for group in others])
        headlines.append(Headline("passes there too", "; ".join(causes), resolution))
    meshes = grouped(candidate for candidate in complaint.passing if candidate.excitation.kind == MESH)
    if first[0].excitation.kind != MESH and meshes:
        nearest = meshes[0]
        offset = offset_text(complaint, nearest[0])
        headlines.append(Headline("nearest mesh order", cause_words(complaint, nearest), offset))
    if answer.modes:
        mode = answer.modes[0]
        remark = f"{mode.kind}, {20.0 * np.log10(mode.amplification):+.1f} dB"
        headlines.append(Headline("mode within reach", f"{number(mode.frequency)} Hz", remark))
    return tuple(headlines)


def _resolution(first: Passing, others: Sequence[Passing]) -> str:
    """Return in words how exactly frequency and speed must be known to tell `first` from the others."""
    distances = [abs(other.order / first.order - 1.0) for other in others]
    gaps = [distance for distance in distances if distance > SAME]
    if not gaps:
        return "the same at every speed"
    percent = 100.0 * 0.5 * min(gaps)  # half the distance to the nearest one
    return f"told apart by a frequency and speed known to {engineering(percent, 2)} %"


def _text(answer: AnsweredComplaint) -> Iterator[Table | str]:
    """Yield the tables and lines of the terminal."""
    complaint = answer.complaint
    yield _passing_table(answer)
    for mesh, torque in complaint.torques.items():
        yield f'load: {engineering(torque, 4)} N m on the driving gear of "{mesh}"'
    if answer.modes:
        yield ""
        yield _mode_table(answer)
    elif answer.metadata["effect_ledger"] is None:
        yield "of a pair alone no mode and no force is known: the scene of the gearbox has them"
        return
    elif complaint.frequency is None:
        yield "an order at any speed: no mode is looked for; give a speed"
    else:
        yield "no mode within reach: none amplifies the frequency by 6 dB"
    if answer.metadata.get("parting", 0.0) > 0.0:
        share = engineering(100.0 * answer.metadata["parting"], 2)
        yield (
            f"flanks part: a linear mesh would pull by {share} % of its mean force, so no force here holds; "
            "loa steady and loa simulate have it"
        )
    has_mesh = any(candidate.excitation.kind == MESH for candidate in complaint.within)
    if has_mesh and not np.any(np.isfinite([force.force for force in answer.forces])):
        yield "forces are not known: no speed, or nothing excites the linear response"


PAGE = dynamics_presentation("Complaint", lambda answer: (_figure(answer),), _headlines, _text)
