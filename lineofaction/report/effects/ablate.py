"""Page of an ablation: the largest change, the plot, every effect, and effects that were not toggled.

An ablation toggles each effect of a case or a scene by itself. An *entry* is one of its effects, with the
computed and the estimated change. *Trifles* are effects for which both are negligible.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bounds import engineering
from dynamics.ablation import Ablation as SceneAblation
from dynamics.ablation import EffectAblation as SceneEffect
from fe_contact.analysis.studies.ablation import Ablation, EffectAblation
from fe_contact.effects.influence.influence import Influence, signed
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Dash,
    Figure,
    FloatArray,
    Line,
    Note,
    Panel,
    Table,
    number,
)
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.drawing.placing import placed
from lineofaction.report.presentation import Presentation
from model_studies.ablation import TRIFLE

_CASE_HEAD = (
    "effect", "case has it", "mean, µm", "estimated", "mean, %", "estimated", "peak to peak, µm", "estimated",
    "peak to peak, %", "estimated", "first harmonic, µm", "cost, x",
)  # fmt: skip
_SMALLEST = 1e-3  # least change in a log-log plot, um
_ZERO = 5e-7  # change below which it is written as 0, in the unit of the column


@dataclass(frozen=True)
class _Look:
    """The texts and drawings that differ between the ablation of a case and that of a scene."""

    what: str
    """Word for the subject: "case" or "scene"."""
    title: str
    """Title of the figure."""
    change: Callable[[Any, Any], float]
    """``change(ablation, entry)``, the change of peak-to-peak by leaving an effect out, m."""
    signed: Callable[[float], str]
    """Writes a change in um with its sign."""
    caption: Callable[[Any], str]
    """Caption of the figure of an ablation."""
    panels: Callable[[Any], tuple[Panel, ...]]
    """Panels of the figure."""
    table: Callable[[Any], Table]
    """Table of all effects."""

    def change_text(self, ablation: Any, entry: Any) -> str:
        return f"{self.signed(1e6 * self.change(ablation, entry))} µm"

    def ordered(self, ablation: Any) -> list[Any]:
        """Return the effects, the largest change of peak-to-peak first."""
        return sorted(ablation.effects, key=lambda entry: -abs(self.change(ablation, entry)))


def _over_orders(
    ablation: Any, amplitude: Callable[[Any], FloatArray], title: str, label: str, unit: float
) -> Panel:
    """Draw amplitudes over the mesh orders: as decided, and with each effect toggled."""
    states = [("as decided", ablation.nominal)]
    states += [(f"{'without' if row.on else 'with'} {row.name}", row.toggled) for row in ablation.effects]
    lines = []
    for index, (name, figures) in enumerate(states):
        drawn = unit * amplitude(figures)
        order = np.arange(1, drawn.size + 1, dtype=float)
        color, width = (palette.category(index - 1), 1.2) if index else (palette.INK, 2.6)
        values = np.where(drawn > 0.0, drawn, np.nan)  # nothing is drawn where there is no vibration
        lines.append(Line(name.replace("_", " "), order, values, color, "solid", width, markers=True))
    lines = [line for line in lines if not np.isnan(line.y).all()]
    return Panel(Axis("mesh order"), Axis(label, "log"), tuple(lines), title=title)


def _case_table(ablation: Ablation) -> Table:
    """List the changes at the nominal load, trifles in one row."""
    rows, trifles = [], []
    for entry in _CASE.ordered(ablation):
        if ablation.measured(entry).trifle and (entry.estimate is None or entry.estimate.trifle):
            trifles.append(entry.name)
        else:
            rows.append(_case_row(ablation, entry))
    if trifles:
        folded = f"{len(trifles)} below {100 * TRIFLE:g} %: {', '.join(trifles)}"
        rows.append((folded, *[""] * (len(_CASE_HEAD) - 1)))
    caption = f"Change without each effect, computed and estimated, {_where(ablation)}"
    return Table(caption, _CASE_HEAD, tuple(rows))


def _where(ablation: Ablation) -> str:
    misalignment = number(1e6 * ablation.misalignment)
    return f"at {number(ablation.torque[-1])} N m, misalignment {misalignment} µm"


def _cells(influence: Influence | None) -> tuple[str, ...]:
    """Write the changes of mean and peak-to-peak in µm and %; no % of a vanishing ripple."""
    if influence is None:
        return ("",) * 4
    ripple = influence.relative_peak_to_peak
    return (
        signed(1e6 * influence.mean),
        signed(100.0 * influence.relative_mean),
        signed(1e6 * influence.peak_to_peak),
        "" if ripple is None else signed(100.0 * ripple),
    )


def _case_row(ablation: Ablation, entry: EffectAblation) -> tuple[str, ...]:
    pairs = zip(_cells(ablation.measured(entry)), _cells(entry.estimate), strict=True)
    return (
        entry.name,
        "on" if entry.on else "off",
        *(cell for pair in pairs for cell in pair),
        signed(1e6 * float(entry.harmonic_change[-1, 0])),
        number(entry.cost_ratio, 3),
    )


def _scatter(ablation: Ablation, title: str, which: str) -> Panel:
    """Draw the estimated over the computed change of `which`, a field of `Influence`, log-log."""
    points = []
    for entry in ablation.effects:
        if entry.estimate is not None:
            computed = abs(1e6 * getattr(ablation.measured(entry), which))
            estimated = abs(1e6 * getattr(entry.estimate, which))
            if min(computed, estimated) > _SMALLEST:
                points.append((computed, estimated, entry.name))
    sizes = [value for point in points for value in point[:2]] or [0.1, 10.0]  # um, of an empty plot
    ends = np.array([0.5 * min(sizes), 2.0 * max(sizes)])
    marks: tuple[tuple[str, float, Dash], ...] = (
        ("equal", 1.0, "dash"),
        ("factor 2", 2.0, "dot"),
        ("factor 1/2", 0.5, "dot"),
    )
    lines = [Line(name, ends, factor * ends, palette.MUTED, dash, 1.0) for name, factor, dash in marks]
    if points:
        x, y, _ = map(np.array, zip(*points, strict=True))
        lines.append(Line("effects", x, y, palette.INK, width=0, markers=True))
    notes = [Note(x, y, name.replace("_", " ")) for x, y, name in points]
    reach = float(ends[0]), float(ends[1])
    axes = Axis("computed change, µm", "log", reach), Axis("estimated change, µm", "log")
    labels = placed(notes, *axes, (0.5 * reach[0], 2.0 * reach[1]))
    return Panel(*axes, tuple(lines), title=title, notes=labels)


def _case_panels(ablation: Ablation) -> tuple[Panel, ...]:
    return (
        _scatter(ablation, "Mean", "mean"),
        _scatter(ablation, "Peak to peak", "peak_to_peak"),
        _over_orders(ablation, lambda figures: figures.harmonics[-1], "Mesh harmonics", "amplitude, µm", 1e6),
    )


_CASE = _Look(
    what="case",
    title="Influence of every effect on this case",
    change=lambda ablation, entry: ablation.measured(entry).peak_to_peak,
    signed=signed,
    caption=lambda ablation: (
        "Each effect toggled by itself, all others as decided: change by leaving it out, in "
        f"size, {_where(ablation)}. Between the dotted lines estimates are within a factor 2; changes below "
        f"{_SMALLEST:g} µm are left out."
    ),
    panels=_case_panels,
    table=_case_table,
)


def _scene_table(ablation: SceneAblation) -> Table:

    def estimated(entry: SceneEffect, name: str) -> str:
        return "" if entry.estimate is None else _signed(1e6 * _maximum(getattr(entry.estimate, name)))

    head = (
        "effect", "scene has it", "without it", "computed", "mean DTE, µm", "estimated", "peak to peak, µm",
        "estimated", "order 1, µm", "bearing force, N", "estimated", "of order", "cost, x",
    )  # fmt: skip
    rows = []
    for entry in _SCENE.ordered(ablation):
        levels = (entry.level.text, entry.level_change.text)
        mean = _signed(1e6 * _maximum(entry.mean_change)), estimated(entry, "mean")
        ripple = _signed(1e6 * _maximum(entry.peak_to_peak_change)), estimated(entry, "peak_to_peak")
        order = _signed(1e6 * _maximum(entry.order_change[:, 0]))
        forces = (*_bearing_force(entry), number(entry.cost_ratio, 3))
        rows.append((entry.name, "on" if entry.on else "off", *levels, *mean, *ripple, order, *forces))
    caption = "What leaving an effect out changes, second half of the run"
    return Table(f"{caption}, the mesh or bearing with the largest", head, tuple(rows))


def _bearing_force(entry: SceneEffect) -> tuple[str, str, str]:
    """Return the largest change of an order of a bearing force, N, its estimate and the order."""
    forces, estimate = entry.bearing_order_change, entry.estimate
    if not forces.size:
        return "", "", ""
    bearing, order = np.unravel_index(int(np.argmax(np.abs(forces))), forces.shape)
    known = estimate is not None and estimate.bearing_orders.size > 0
    estimate_text = _signed(float(estimate.bearing_orders[bearing, order])) if estimate and known else ""
    return _signed(float(forces[bearing, order])), estimate_text, str(order + 1)


def _scene_panels(ablation: SceneAblation) -> tuple[Panel, ...]:
    def of_error(figures: Any) -> FloatArray:
        return np.asarray(np.max(figures.orders, axis=0))

    def of_force(figures: Any) -> FloatArray:
        return np.asarray(np.max(figures.bearing_orders, axis=0))

    error = _over_orders(ablation, of_error, "Transmission error", "amplitude, µm", 1e6)
    if not ablation.bearing:
        return (error,)
    return error, _over_orders(ablation, of_force, "Bearing force", "amplitude, N", 1.0)


def _maximum(values: FloatArray) -> float:
    """Return the value of the largest magnitude, with its sign."""
    return float(values[np.argmax(np.abs(values))])


def _signed(value: float) -> str:
    """Write three digits with a sign; a change below `_ZERO` is 0."""
    return "0" if abs(value) < _ZERO else engineering(value, 3, "+")


_SCENE = _Look(
    what="scene",
    title="Influence of every effect in this scene",
    change=lambda _ablation, entry: _maximum(entry.peak_to_peak_change),
    signed=_signed,
    caption=lambda _ablation: (
        "Each effect toggled by itself in all its parts: largest amplitude of every mesh order "
        "over meshes, bearings and the second half of the run. States without any are not drawn."
    ),
    panels=_scene_panels,
    table=_scene_table,
)


def _ablation_figure(ablation: Ablation | SceneAblation) -> Figure:
    look = _look(ablation)
    ordered = look.ordered(ablation)
    changes = [f"{entry.name} {look.change_text(ablation, entry)} of peak to peak" for entry in ordered]
    return Figure(
        key="ablation",
        title=look.title,
        caption=look.caption(ablation),
        alternative="; ".join(changes),
        content=look.panels(ablation),
        table=look.table(ablation),
    )


def _ablation_page(ablation: Ablation | SceneAblation) -> Page:
    look = _look(ablation)
    heads: tuple[Headline, ...] = ()
    figures: tuple[Figure, ...] = ()
    if ablation.effects:
        entry = look.ordered(ablation)[0]
        name, change = entry.name.replace("_", " "), look.change_text(ablation, entry)
        heads = (Headline(f"without {name}", change, "of peak to peak, the largest influence"),)
        figures = (replace(_ablation_figure(ablation), table=None),)
    tables = [look.table(ablation)]
    if ablation.omitted:
        omitted = tuple(ablation.omitted.items())
        tables.append(Table("Effects that were not toggled", ("effect", "because"), omitted))
    lead = f"{len(ablation.effects)} effects of the {look.what}, each toggled by itself"
    section = Section("Effects", "", figures, tuple(tables))
    return Page("Influence of every effect", lead, heads, (section,))


def _look(ablation: Ablation | SceneAblation) -> _Look:
    return _CASE if isinstance(ablation, Ablation) else _SCENE


def _text(ablation: Ablation | SceneAblation) -> Iterator[Table | str]:
    yield _look(ablation).table(ablation)
    for name, reason in ablation.omitted.items():
        yield f"not toggled: {name}: {reason}"


PAGE = Presentation(_ablation_figure, _ablation_page, _text)
