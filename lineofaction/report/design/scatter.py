"""Distribution of peak-to-peak transmission error within tolerances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.microgeometry.tolerance_study import ToleranceStudy
from lineofaction.gearbox.convert.errors import boundary_name
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Table, number, thousands
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation

_STEPS = 400


def _scatter_figure(study: ToleranceStudy) -> Figure:
    count = study.peak_to_peak.shape[0]
    last = study.quantiles[-1]
    part, size = f"{100 * last.fraction:g} %", number(last.value[-1] / UM, 3)
    designed = number(study.nominal[-1] / UM, 3)
    return Figure(
        key="scatter",
        title="Peak-to-peak transmission error within tolerances",
        caption=f"{count} pairs sampled within their tolerances. First: part of all up to a ripple. "
        f"Lower: quantiles with bounds of {100 * study.confidence:g} % confidence (dotted), and the "
        "pair as designed (dashed).",
        alternative=f"At the highest torque {part} of all pairs stay below {size} µm; as designed "
        f"{designed} µm.",
        content=(_distribution(study), _over_torque(study)),
        table=_quantile_table(study),
    )


def _distribution(study: ToleranceStudy) -> Panel:
    lines = []
    for k, name in enumerate(thousands(study.torque.tolist())):
        ordered = np.sort(study.peak_to_peak[:, k]) / UM
        part = np.arange(1, ordered.size + 1) / ordered.size
        kept = np.unique(np.linspace(0, ordered.size - 1, min(_STEPS, ordered.size)).astype(int))
        color = palette.ordered(k, study.torque.size)
        lines.append(Line(f"{name} N m", ordered[kept], part[kept], color))
    return Panel(Axis("peak to peak, µm"), Axis("share of all pairs"), tuple(lines), title="Distribution")


def _over_torque(study: ToleranceStudy) -> Panel:
    lines = []
    for k, quantile in enumerate(study.quantiles):
        color, name = palette.category(k), f"{100 * quantile.fraction:g} %"
        lines.append(Line(name, study.torque, quantile.value / UM, color, markers=True))
        for side, bound in (("lower", quantile.low), ("upper", quantile.high)):
            if bound.all() and np.isfinite(bound).all():
                lines.append(Line(f"{name}, {side}", study.torque, bound / UM, color, "dot", 1.0))
    lines.append(Line("as designed", study.torque, study.nominal / UM, palette.INK, "dash", markers=True))
    across = Axis("torque on the driving gear, N m")
    return Panel(across, Axis("peak to peak, µm"), tuple(lines), title="Quantiles")


def _quantile_table(study: ToleranceStudy) -> Table:
    head = ["torque, N m", "as designed, µm", "± µm", "mean, µm", "± µm (1 s)"]
    for quantile in study.quantiles:
        head += [f"{100 * quantile.fraction:g} %, µm", "bounds, µm", "first order, µm"]
    rows = []
    for k, name in enumerate(thousands(study.torque.tolist())):
        row = [name]
        for values, digits in (
            (study.nominal, 3), (study.error, 2), (study.mean, 3), (study.mean_error, 2),
        ):  # fmt: skip
            row.append(number(float(values[k]) / UM, digits))
        for quantile in study.quantiles:
            low, high = float(quantile.low[k]), float(quantile.high[k])
            ends = (number(low / UM, 3) if low else "none", number(high / UM, 3))
            at_once = float(np.quantile(study.first_order[:, k], quantile.fraction))
            row += [number(float(quantile.value[k]) / UM, 3), " to ".join(ends), number(at_once / UM, 3)]
        rows.append(tuple(row))
    count = study.peak_to_peak.shape[0]
    caption = f"Peak to peak of {count} pairs; to first order by the derivatives of the curves as designed"
    return Table(caption, tuple(head), tuple(rows))


def _influence_table(study: ToleranceStudy) -> Table:
    """Return the rank correlation of each deviation, the strongest at the highest load first."""
    head = ("deviation", *(f"{name} N m" for name in thousands(study.torque.tolist())))
    order = np.argsort(-np.abs(study.influence[:, -1]), kind="stable")
    rows = tuple(
        (boundary_name(study.names[i]), *(f"{value:+.2f}" for value in study.influence[i])) for i in order
    )
    return Table("Influence: rank correlation of a deviation, or of its size, with peak to peak", head, rows)


def _page(study: ToleranceStudy) -> Page:
    last = study.quantiles[-1]
    heads = (
        Headline("as designed", f"{number(study.nominal[-1] / UM, 3)} µm", "at the highest torque"),
        Headline("mean", f"{number(study.mean[-1] / UM, 3)} µm"),
        Headline(f"{100 * last.fraction:g} % of all pairs below", f"{number(last.value[-1] / UM, 3)} µm"),
    )
    tables = (_quantile_table(study), _influence_table(study))
    section = Section("Distribution", "", (replace(_scatter_figure(study), table=None),), tables)
    lead = f"{study.peak_to_peak.shape[0]} pairs sampled within their tolerances"
    return Page("Transmission error within tolerances", lead, heads, (section,))


PAGE = Presentation(_scatter_figure, _page, lambda study: (_quantile_table(study), _influence_table(study)))
