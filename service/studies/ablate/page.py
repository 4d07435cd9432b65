"""What every effect of a case or a scene changes, beside what it was estimated at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from dynamics.ablation import Ablation as SceneAblation
from dynamics.ablation import RunFigures
from fe_contact.analysis.ablation import Ablation, EffectAblation
from fe_contact.effects.influence.influence import TRIFLE, Influence, signed
from service.report import palette
from service.report.figure import Axis, Dash, Figure, FloatArray, Line, Note, Panel, Table, number
from service.report.note_places import placed
from service.report.page import Headline, Page, Section
from service.studies.presentation import Presentation

_CASE_HEAD = (
    "effect", "case has it", "mean, µm", "estimated", "mean, %", "estimated", "peak to peak, µm", "estimated",
    "peak to peak, %", "estimated", "first harmonic, µm", "cost, x",
)  # fmt: skip
_SCENE_HEAD = (
    "effect", "scene has it", "influence, µm", "mean DTE, µm", "estimated", "peak to peak, µm", "estimated",
    "order 1, µm", "bearing force, order 1, N", "cost, x",
)  # fmt: skip
_SMALLEST = 1e-3  # um; smaller changes are nothing


def case_ablation_table(found: Ablation) -> Table:
    """Return the changes at the nominal load, largest peak-to-peak change first, trifles in one row."""
    ordered = _sorted(found)
    shown = [entry for entry in ordered if not _trifle(found, entry)]
    rows = [_case_row(found, entry) for entry in shown]
    if len(shown) < len(ordered):
        names = ", ".join(entry.name for entry in ordered if entry not in shown)
        folded = f"{len(ordered) - len(shown)} below {100 * TRIFLE:g} %: {names}"
        rows.append((folded, *[""] * (len(_CASE_HEAD) - 1)))
    caption = f"What leaving an effect out changes, computed and estimated, {_place(found)}"
    return Table(caption, _CASE_HEAD, tuple(rows))


def _place(found: Ablation) -> str:
    """Say at which load and misalignment."""
    return f"at {number(float(found.torque[-1]))} N m, misalignment {number(1e6 * found.misalignment)} µm"


def _trifle(found: Ablation, entry: EffectAblation) -> bool:
    """Whether an effect is computed and estimated to change next to nothing."""
    return found.measured(entry).trifle and (entry.estimate is None or entry.estimate.trifle)


def _sorted(found: Ablation) -> list[EffectAblation]:
    """Largest change of peak-to-peak first."""
    return sorted(found.effects, key=lambda one: -abs(found.measured(one).peak_to_peak))


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


def _case_row(found: Ablation, entry: EffectAblation) -> tuple[str, ...]:
    """One effect."""
    pairs = zip(_cells(found.measured(entry)), _cells(entry.estimate), strict=True)
    return (
        entry.name,
        "on" if entry.on else "off",
        *(cell for pair in pairs for cell in pair),
        signed(1e6 * float(entry.harmonic_change[-1, 0])),
        number(entry.cost_ratio, 3),
    )


def _signed(value: float) -> str:
    """Three digits with a sign; nothing is 0."""
    return "0" if abs(value) < 5e-7 else f"{value:+.3g}"


def case_ablation_figure(found: Ablation) -> Figure:
    """Draw estimated over measured changes, and the harmonics without each effect."""
    return Figure(
        key="ablation",
        title="Influence of every effect on this case",
        caption="Each effect toggled by itself, all others as decided: change by leaving it out, in "
        f"size, {_place(found)}. Between the dotted lines estimates are within a factor 2; changes below "
        f"{_SMALLEST:g} µm are left out.",
        alternative="; ".join(
            f"{one.name} {signed(1e6 * found.measured(one).peak_to_peak)} µm of peak to peak"
            for one in _sorted(found)
        ),
        content=(
            _scatter(found, "Mean", "mean"),
            _scatter(found, "Peak to peak", "peak_to_peak"),
            _harmonics(found),
        ),
        table=case_ablation_table(found),
    )


def _scatter(found: Ablation, title: str, which: str) -> Panel:
    """Estimated over computed change of one quantity, log-log."""
    points = []
    for entry in found.effects:
        if entry.estimate is not None:
            sizes = [abs(1e6 * getattr(one, which)) for one in (found.measured(entry), entry.estimate)]
            points += [(*sizes, entry.name)] if min(sizes) > _SMALLEST else []
    reached = [value for point in points for value in point[:2]] or [0.1, 10.0]
    ends = np.array([0.5 * min(reached), 2.0 * max(reached)])
    marks: tuple[tuple[str, float, Dash], ...] = (
        ("equal", 1.0, "dash"),
        ("factor 2", 2.0, "dot"),
        ("factor 1/2", 0.5, "dot"),
    )
    lines = [Line(name, ends, factor * ends, palette.MUTED, dash, 1.0) for name, factor, dash in marks]
    if points:
        measured, estimated = (np.array([point[k] for point in points]) for k in (0, 1))
        lines.append(Line("effects", measured, estimated, palette.INK, width=0, markers=True))
    notes = [Note(x, y, name.replace("_", " ")) for x, y, name in points]
    reach = float(ends[0]), float(ends[1])
    axes = Axis("computed change, µm", "log", reach), Axis("estimated change, µm", "log")
    beside = placed(notes, *axes, (0.5 * reach[0], 2.0 * reach[1]))
    return Panel(*axes, tuple(lines), title=title, notes=beside)


def _harmonics(found: Ablation) -> Panel:
    """Amplitudes of the mesh harmonics with everything as decided and with each effect toggled."""
    states = [("as decided", found.nominal.harmonics[-1])]
    for entry in found.effects:
        other = entry.without_effect if entry.on else entry.with_effect
        states.append((f"{'without' if entry.on else 'with'} {entry.name}", other.harmonics[-1]))
    return _over_orders(states, "Mesh harmonics", "amplitude, µm", 1e6)


def _over_orders(states: list[tuple[str, FloatArray]], title: str, label: str, unit: float) -> Panel:
    """One line per state over the orders."""
    lines = []
    for index, (name, amplitude) in enumerate(states):
        order = np.arange(1, amplitude.size + 1, dtype=float)
        color = palette.INK if index == 0 else palette.category(index - 1)
        width = 2.6 if index == 0 else 1.2
        values = np.where(amplitude > 0.0, unit * amplitude, np.nan)
        if np.isnan(values).all():
            continue
        lines.append(Line(name.replace("_", " "), order, values, color, "solid", width, markers=True))
    return Panel(Axis("mesh order"), Axis(label, "log"), tuple(lines), title=title)


def scene_ablation_table(found: SceneAblation) -> Table:
    """Return the largest changes over meshes and bearings, largest peak-to-peak change first."""
    ordered = sorted(found.effects, key=lambda one: -float(np.abs(one.peak_to_peak_change).max()))
    rows = tuple(
        (
            one.name,
            "on" if one.on else "off",
            number(1e6 * one.influence, 3),
            _signed(1e6 * _most(one.mean_change)),
            "" if one.estimate is None else _signed(1e6 * _most(one.estimate.mean)),
            _signed(1e6 * _most(one.peak_to_peak_change)),
            "" if one.estimate is None else _signed(1e6 * _most(one.estimate.peak_to_peak)),
            _signed(1e6 * _most(one.order_change[:, 0])),
            _signed(_most(one.bearing_order_change[:, 0])) if one.bearing_order_change.size else "",
            number(one.cost_ratio, 3),
        )
        for one in ordered
    )
    caption = (
        "What leaving an effect out changes, second half of the run, the mesh or bearing with the largest"
    )
    return Table(caption, _SCENE_HEAD, rows)


def _most(values: FloatArray) -> float:
    """Return the largest in size."""
    return float(values[np.argmax(np.abs(values))])


def scene_ablation_figure(found: SceneAblation) -> Figure:
    """Draw mesh orders of transmission error and bearing force, with each effect toggled."""

    def panel(title: str, label: str, unit: float, of: Callable[[RunFigures], FloatArray]) -> Panel:
        states = [("as decided", np.max(of(found.nominal), axis=0))]
        for one in found.effects:
            other = one.without_effect if one.on else one.with_effect
            states.append((f"{'without' if one.on else 'with'} {one.name}", np.max(of(other), axis=0)))
        return _over_orders(states, title, label, unit)

    panels = [panel("Transmission error", "amplitude, µm", 1e6, lambda one: one.orders)]
    if found.bearing:
        panels.append(panel("Bearing force", "amplitude, N", 1.0, lambda one: one.bearing_orders))
    return Figure(
        key="ablation",
        title="Influence of every effect in this scene",
        caption="Each effect toggled by itself in all its parts: largest amplitude of every mesh order "
        "over meshes, bearings and the second half of the run. States without any are not drawn.",
        alternative="; ".join(
            f"{one.name} {_signed(1e6 * _most(one.peak_to_peak_change))} µm of peak to peak"
            for one in found.effects
        ),
        content=tuple(panels),
        table=scene_ablation_table(found),
    )


def largest_change(found: Ablation | SceneAblation) -> tuple[str, str]:
    """Return the effect without which peak-to-peak changes most, and by how much."""
    if isinstance(found, Ablation):
        first = _sorted(found)[0]
        return first.name, f"{signed(1e6 * found.measured(first).peak_to_peak)} µm"
    one = max(found.effects, key=lambda each: abs(_most(each.peak_to_peak_change)))
    return one.name, f"{_signed(1e6 * _most(one.peak_to_peak_change))} µm"


def _figure(found: Ablation | SceneAblation) -> Figure:
    """Draw that of a case or of a scene."""
    return case_ablation_figure(found) if isinstance(found, Ablation) else scene_ablation_figure(found)


def _table(found: Ablation | SceneAblation) -> Table:
    """List that of a case or of a scene."""
    return case_ablation_table(found) if isinstance(found, Ablation) else scene_ablation_table(found)


def ablation_page(found: Ablation | SceneAblation) -> Page:
    """Return the page of an ablation."""
    what, figure, rows = "case" if isinstance(found, Ablation) else "scene", _figure(found), _table(found)
    heads = []
    if found.effects:
        name, change = largest_change(found)
        heads.append(Headline(f"without {name.replace('_', ' ')}", change, "of peak to peak, most of all"))
    left = Table("Effects that were not toggled", ("effect", "because"), tuple(found.left_out.items()))
    tables = (rows, *([left] if found.left_out else []))
    section = Section("Effects", "", (replace(figure, table=None),) if found.effects else (), tables)
    lead = f"{len(found.effects)} effects of the {what}, each toggled by itself"
    return Page("What every effect changes", lead, tuple(heads), (section,))


def _text(found: Ablation | SceneAblation) -> Iterator[Table | str]:
    """Every effect, and what was not toggled."""
    yield _table(found)
    for name, reason in found.left_out.items():
        yield f"not toggled: {name}: {reason}"


PAGE = Presentation(_figure, ablation_page, _text)
