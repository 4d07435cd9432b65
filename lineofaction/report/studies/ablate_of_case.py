"""The change by every effect of a case, beside its estimate."""

from __future__ import annotations

import numpy as np

from fe_contact.analysis.studies.ablation import Ablation, EffectAblation
from fe_contact.effects.influence.estimate import TRIFLE, Influence, signed
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Dash, Line, Note, Panel, Table, number
from lineofaction.report.drawing.placing import placed
from lineofaction.report.studies.ablate_look import Look, over_orders

_HEAD = (
    "effect", "case has it", "mean, µm", "estimated", "mean, %", "estimated", "peak to peak, µm", "estimated",
    "peak to peak, %", "estimated", "first harmonic, µm", "cost, x",
)  # fmt: skip
_SMALLEST = 1e-3  # um; smaller changes are nothing


def _table(ablation: Ablation) -> Table:
    """Return the changes at the nominal load, trifles in one row."""
    ordered = LOOK.ordered(ablation)
    shown = [entry for entry in ordered if not _trifle(ablation, entry)]
    rows = [_row(ablation, entry) for entry in shown]
    if len(shown) < len(ordered):
        names = ", ".join(entry.name for entry in ordered if entry not in shown)
        folded = f"{len(ordered) - len(shown)} below {100 * TRIFLE:g} %: {names}"
        rows.append((folded, *[""] * (len(_HEAD) - 1)))
    caption = f"Change without each effect, computed and estimated, {_where(ablation)}"
    return Table(caption, _HEAD, tuple(rows))


def _where(ablation: Ablation) -> str:
    """Say at which load and misalignment."""
    misalignment = number(1e6 * ablation.misalignment)
    return f"at {number(float(ablation.torque[-1]))} N m, misalignment {misalignment} µm"


def _trifle(ablation: Ablation, entry: EffectAblation) -> bool:
    return ablation.measured(entry).trifle and (entry.estimate is None or entry.estimate.trifle)


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


def _row(ablation: Ablation, entry: EffectAblation) -> tuple[str, ...]:
    pairs = zip(_cells(ablation.measured(entry)), _cells(entry.estimate), strict=True)
    return (
        entry.name,
        "on" if entry.on else "off",
        *(cell for pair in pairs for cell in pair),
        signed(1e6 * float(entry.harmonic_change[-1, 0])),
        number(entry.cost_ratio, 3),
    )


def _scatter(ablation: Ablation, title: str, which: str) -> Panel:
    """Estimated over computed change of one quantity, log-log."""
    points = []
    for entry in ablation.effects:
        if entry.estimate is not None:
            influences = (ablation.measured(entry), entry.estimate)
            sizes = [abs(1e6 * getattr(influence, which)) for influence in influences]
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


def _panels(ablation: Ablation) -> tuple[Panel, ...]:
    """Draw estimated over measured changes, and the harmonics without each effect."""
    return (
        _scatter(ablation, "Mean", "mean"),
        _scatter(ablation, "Peak to peak", "peak_to_peak"),
        over_orders(ablation, lambda figures: figures.harmonics[-1], "Mesh harmonics", "amplitude, µm", 1e6),
    )


LOOK = Look(
    what="case",
    title="Influence of every effect on this case",
    change=lambda ablation, entry: ablation.measured(entry).peak_to_peak,
    signed=signed,
    caption=lambda ablation: (
        "Each effect toggled by itself, all others as decided: change by leaving it out, in "
        f"size, {_where(ablation)}. Between the dotted lines estimates are within a factor 2; changes below "
        f"{_SMALLEST:g} µm are left out."
    ),
    panels=_panels,
    table=_table,
)
