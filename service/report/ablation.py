"""What every effect of a case or a scene changes, beside what it was estimated at."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dynamics.ablation import Ablation as SceneAblation
from dynamics.ablation import RunFigures
from fe_contact.analysis.ablation import Ablation, EffectAblation
from service.report import palette
from service.report.figure import Axis, Dash, Figure, FloatArray, Line, Note, Panel, Table, number
from service.report.note_places import placed

_CASE_HEAD = (
    "effect", "case has it", "mean, µm", "mean, %", "estimated, %", "peak to peak, µm", "peak to peak, %",
    "estimated, %", "first harmonic, µm", "cost, x",
)  # fmt: skip
_SCENE_HEAD = (
    "effect", "scene has it", "worth, µm", "mean DTE, µm", "estimated", "peak to peak, µm", "estimated",
    "order 1, µm", "bearing force, order 1, N", "cost, x",
)  # fmt: skip
_SMALLEST = 1e-3  # per cent; smaller changes are nothing


def case_ablation_table(found: Ablation) -> Table:
    """Return the changes at the highest load, largest peak-to-peak change first."""
    caption = (
        f"What leaving an effect out changes at {number(float(found.torque[-1]))} N m, misalignment "
        f"{number(1e6 * found.misalignment)} µm"
    )
    return Table(caption, _CASE_HEAD, tuple(_case_row(entry) for entry in _sorted(found)))


def _sorted(found: Ablation) -> list[EffectAblation]:
    """Largest relative change of peak-to-peak first."""
    return sorted(found.effects, key=lambda one: -abs(_percent(one)[1]))


def _percent(entry: EffectAblation) -> tuple[float, float]:
    """Measured changes of mean and peak-to-peak at the highest load, %."""
    whole = entry.with_effect
    mean = 100.0 * entry.mean_change[-1] / whole.mean[-1]
    return float(mean), float(100.0 * entry.peak_to_peak_change[-1] / whole.peak_to_peak[-1])


def _estimated(entry: EffectAblation) -> tuple[float, float] | None:
    """Estimated changes in parts of the computed values, %."""
    if entry.estimate is None:
        return None
    whole = entry.with_effect
    mean = 100.0 * entry.estimate.mean[-1] / whole.mean[-1]
    return float(mean), float(100.0 * entry.estimate.peak_to_peak[-1] / whole.peak_to_peak[-1])


def _case_row(entry: EffectAblation) -> tuple[str, ...]:
    """One effect."""
    measured, estimated = _percent(entry), _estimated(entry)
    told = ("", "") if estimated is None else tuple(_signed(value) for value in estimated)
    return (
        entry.name,
        "on" if entry.on else "off",
        _signed(1e6 * float(entry.mean_change[-1])),
        _signed(measured[0]),
        told[0],
        _signed(1e6 * float(entry.peak_to_peak_change[-1])),
        _signed(measured[1]),
        told[1],
        _signed(1e6 * float(entry.harmonic_change[-1, 0])),
        number(entry.cost_ratio, 3),
    )


def _signed(value: float) -> str:
    """Three digits with a sign; nothing is 0."""
    return "0" if abs(value) < 5e-7 else f"{value:+.3g}"


def case_ablation_figure(found: Ablation) -> Figure:
    """Draw estimated over measured changes, and the harmonics without each effect."""
    return Figure(
        key="ablation",
        title="What every effect is worth on this case",
        caption="Each effect switched over by itself, all others as decided: change by leaving it out, in "
        "size, at the highest load. Between the dotted lines estimates are within a factor 2; changes below "
        f"{_SMALLEST:g} % are left out.",
        alternative="; ".join(
            f"{one.name} {_signed(_percent(one)[1])} % of peak to peak" for one in _sorted(found)
        ),
        content=(
            _scatter(found, "Mean", 0),
            _scatter(found, "Peak to peak", 1),
            _harmonics(found),
        ),
        table=case_ablation_table(found),
    )


def _scatter(found: Ablation, title: str, which: int) -> Panel:
    """Estimated over measured change of one quantity, log-log."""
    points = []
    for entry in found.effects:
        estimated = _estimated(entry)
        if estimated is not None:
            pair = abs(_percent(entry)[which]), abs(estimated[which])
            points += [(*pair, entry.name)] if min(pair) > _SMALLEST else []
    sizes = [value for point in points for value in point[:2]] or [0.1, 10.0]
    ends = np.array([0.5 * min(sizes), 2.0 * max(sizes)])
    marks: tuple[tuple[str, float, Dash], ...] = (
        ("equal", 1.0, "dash"),
        ("factor 2", 2.0, "dot"),
        ("factor 1/2", 0.5, "dot"),
    )
    lines = [Line(name, ends, factor * ends, palette.MUTED, dash, 1.0) for name, factor, dash in marks]
    if points:
        measured, estimated_values = (np.array([point[k] for point in points]) for k in (0, 1))
        lines.append(Line("effects", measured, estimated_values, palette.INK, width=0, markers=True))
    notes = [Note(x, y, name.replace("_", " ")) for x, y, name in points]
    reach = float(ends[0]), float(ends[1])
    axes = Axis("measured change, %", "log", reach), Axis("estimated change, %", "log")
    beside = placed(notes, *axes, (0.5 * reach[0], 2.0 * reach[1]))
    return Panel(*axes, tuple(lines), title=title, notes=beside)


def _harmonics(found: Ablation) -> Panel:
    """Amplitudes of the mesh harmonics with everything as decided and with each effect switched over."""
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
        colour = palette.INK if index == 0 else palette.category(index - 1)
        width = 2.6 if index == 0 else 1.2
        values = np.where(amplitude > 0.0, unit * amplitude, np.nan)
        if np.isnan(values).all():
            continue
        lines.append(Line(name.replace("_", " "), order, values, colour, "solid", width, markers=True))
    return Panel(Axis("mesh order"), Axis(label, "log"), tuple(lines), title=title)


def scene_ablation_table(found: SceneAblation) -> Table:
    """Return the largest changes over meshes and bearings, largest peak-to-peak change first."""
    ordered = sorted(found.effects, key=lambda one: -float(np.abs(one.peak_to_peak_change).max()))
    rows = tuple(
        (
            one.name,
            "on" if one.on else "off",
            number(1e6 * one.worth, 3),
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
    """Draw mesh orders of transmission error and bearing force, with each effect switched over."""

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
        title="What every effect is worth in this scene",
        caption="Each effect switched over by itself in all its parts: largest amplitude of every mesh order "
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
        return first.name, f"{_signed(_percent(first)[1])} %"
    one = max(found.effects, key=lambda each: abs(_most(each.peak_to_peak_change)))
    return one.name, f"{_signed(1e6 * _most(one.peak_to_peak_change))} µm"
