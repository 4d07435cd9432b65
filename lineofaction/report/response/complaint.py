"""The answer to a complaint: what passes at its frequency, what is near it, and the modes within reach."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from bounds import engineering
from dynamics.mechanism.passing import MESH, SAME, Passing
from lineofaction.gearbox.convert.complaint import Complaint, grouped, harmonic_label, offset_text, sentence
from lineofaction.gearbox.studies.complaint.run import AnsweredComplaint
from lineofaction.gearbox.units import RPM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Dash,
    Figure,
    Line,
    Panel,
    Reference,
    Table,
    number,
)
from lineofaction.report.drawing.page import Headline
from lineofaction.report.presentation import dynamics_presentation

AROUND = (0.7, 1.3)
"""Ends of the axes, over speed and frequency of the complaint."""
OTHERS = 4
"""Harmonics beyond the tolerance that are drawn and listed."""
MODES_AT = (0.15, 0.35, 0.65)
"""Where along the axis the modes that are drawn, the most amplified, have their names."""


def _figure(answer: AnsweredComplaint) -> Figure:
    complaint = answer.complaint
    if complaint.speed is None or complaint.frequency is None:
        panel = _by_order(complaint)
    else:
        panel = _over_speed(complaint, complaint.speed, complaint.frequency)
    return Figure(
        key="complaint",
        title="Complaint, and what passes there",
        caption="Lines: harmonics of meshes, shafts and bearings; bold: within "
        f"{engineering(100.0 * complaint.tolerance, 3)} % of the complaint. Dashed: speed and frequency of "
        "the complaint, and the modes within reach.",
        alternative=f"{sentence(complaint)}.",
        content=(replace(panel, references=(*panel.references, *_modes_in(answer))),),
        table=_passing_table(answer),
    )


def _listed(complaint: Complaint) -> list[tuple[Passing, ...]]:
    """Return what is shown: what is within the tolerance, then the nearest of the others."""
    within = complaint.within
    others = grouped(passing for passing in complaint.passing if passing not in within)
    return [*grouped(within), *others[:OTHERS]]


def _looks(complaint: Complaint) -> Iterator[tuple[tuple[Passing, ...], str, Dash, float]]:
    """Yield what is shown with color, dash and width of its line."""
    for index, alike in enumerate(_listed(complaint)):
        near = alike[0] in complaint.within
        yield alike, palette.category(index), *(("solid", 2.4) if near else ("dot", 1.2))


def _over_speed(complaint: Complaint, speed: float, frequency: float) -> Panel:
    """Draw the frequencies over the speed of the shaft, rad/s, about the complaint."""
    ends = np.array(AROUND)
    rpm = ends * speed / RPM
    lines = tuple(
        Line(harmonic_label(alike), rpm, alike[0].order * rpm / 60.0, color, dash, width)
        for alike, color, dash, width in _looks(complaint)
    )
    low, high = ends * frequency
    x = Axis.over(f"speed of {complaint.shaft}, rpm", rpm)
    return Panel(x, Axis("frequency, Hz", limits=(float(low), float(high))), lines)


def _by_order(complaint: Complaint) -> Panel:
    """Draw what passes as points at its order and its distance."""
    lines = tuple(
        Line(
            harmonic_label(alike),
            np.array([candidate.order]),
            np.array([100.0 * candidate.distance]),
            color,
            dash,
            0.0,
            True,
        )
        for alike, color, dash, _ in _looks(complaint)
        for candidate in alike[:1]
    )
    x, y = Axis(f"order of {complaint.shaft}"), Axis("distance from the complaint, %")
    return Panel(x, y, lines, (Reference("complaint", complaint.order),))


def _modes_in(answer: AnsweredComplaint) -> tuple[Reference, ...]:
    modes = zip(answer.modes, MODES_AT, strict=False)
    return tuple(
        Reference(f"mode {number(mode.frequency)} Hz", mode.frequency, "horizontal", at) for mode, at in modes
    )


def _passing_table(answer: AnsweredComplaint) -> Table:
    complaint = answer.complaint
    forces = dict(zip(complaint.within, answer.forces, strict=True))
    columns = {
        "what": harmonic_label,
        "order": lambda alike: number(alike[0].order, 5),
        "frequency, Hz": lambda alike: number(complaint.hertz(alike[0].order) or np.nan, 5),
        "off, %": lambda alike: f"{100.0 * alike[0].distance:+.2f}",
        "within": lambda alike: "yes" if alike[0] in complaint.within else "no",
        "excites by, N": lambda alike: _newtons(max(map(complaint.level, alike))),
        "force, N": lambda alike: _newtons(forces[alike[0]].force if alike[0] in forces else np.nan),
        "on bearing": lambda alike: forces[alike[0]].bearing if alike[0] in forces else "",
    }
    return Table.of(f"Orders of {complaint.shaft} beside the complaint", _listed(complaint), columns)


def _newtons(force: float) -> str:
    return number(force, 3) if np.isfinite(force) else ""


def _mode_table(answer: AnsweredComplaint) -> Table:
    columns = {
        "frequency, Hz": lambda mode: number(mode.frequency, 5),
        "off, %": lambda mode: f"{100.0 * mode.distance:+.1f}",
        "damping ratio, %": lambda mode: number(100.0 * mode.damping_ratio, 3),
        "amplification": lambda mode: number(mode.amplification, 3),
        "dB": lambda mode: f"{20.0 * np.log10(mode.amplification):+.1f}",
        "kind": lambda mode: mode.kind,
    }
    return Table.of("Modes within reach: at least 6 dB at the frequency", answer.modes, columns)


def _headlines(answer: AnsweredComplaint) -> tuple[Headline, ...]:
    complaint = answer.complaint
    first, *others = grouped(complaint.within)
    several = any(alike[0].excitation.kind == MESH for alike in others)
    ranked = f"; the likeliest by distance and {complaint.ranked_by}" if several else ""
    headlines = [Headline("complaint", harmonic_label(first), offset_text(complaint, first[0]) + ranked)]
    if others:
        names = "; ".join(f"{harmonic_label(alike)} {offset_text(complaint, alike[0])}" for alike in others)
        headlines.append(
            Headline("passes there too", names, _resolution(first[0], [alike[0] for alike in others]))
        )
    nearest = grouped(candidate for candidate in complaint.passing if candidate.excitation.kind == MESH)
    if first[0].excitation.kind != MESH and nearest:
        headlines.append(
            Headline("nearest mesh order", harmonic_label(nearest[0]), offset_text(complaint, nearest[0][0]))
        )
    if answer.modes:
        mode = answer.modes[0]
        remark = f"{mode.kind}, {20.0 * np.log10(mode.amplification):+.1f} dB"
        headlines.append(Headline("mode within reach", f"{number(mode.frequency)} Hz", remark))
    return tuple(headlines)


def _resolution(first: Passing, others: Sequence[Passing]) -> str:
    """Say how well frequency and speed have to be known to tell what passes apart."""
    gaps = [gap for other in others if (gap := abs(other.order / first.order - 1.0)) > SAME]
    if not gaps:
        return "the same at every speed"
    return f"told apart by a frequency and speed known to {engineering(50.0 * min(gaps), 2)} %"


def _text(answer: AnsweredComplaint) -> Iterator[Table | str]:
    complaint = answer.complaint
    yield _passing_table(answer)
    for mesh, torque in complaint.torques.items():
        yield f'load: {number(torque, 4)} N m on the driving gear of "{mesh}"'
    if answer.modes:
        yield ""
        yield _mode_table(answer)
    elif answer.facts["effect_ledger"] is None:
        yield "of a pair alone no mode and no force is known: the scene of the gearbox has them"
        return
    elif complaint.frequency is None:
        yield "an order at any speed: no mode is looked for; give a speed"
    else:
        yield "no mode within reach: none amplifies the frequency by 6 dB"
    if answer.facts.get("parting", 0.0) > 0.0:
        share = engineering(100.0 * answer.facts["parting"], 2)
        yield (
            f"flanks part: a linear mesh would pull by {share} % of its mean force, so no force here holds; "
            "loa steady and loa simulate have it"
        )
    if any(candidate.excitation.kind == MESH for candidate in complaint.within) and not np.any(
        np.isfinite([force.force for force in answer.forces])
    ):
        yield "forces are not known: no speed, or nothing excites the linear response"


PAGE = dynamics_presentation("Complaint", lambda answer: (_figure(answer),), _headlines, _text)
