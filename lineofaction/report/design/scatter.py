"""Distribution of peak-to-peak transmission error within tolerances."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from bounds.error_digits import error_text, to_error
from fe_contact.microgeometry.order_limit import PairsAbove
from fe_contact.microgeometry.tolerance_study import Quantile, ToleranceStudy, WithinClass
from fe_contact.types import FloatArray
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.convert.operating_point import typed
from lineofaction.gearbox.units import UM
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, Line, Panel, Reference, Table, number, thousands
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation
from model_studies.spread import quantiles

_STEPS = 400
"""Most points of a drawn distribution."""
_HIGHEST = -1
"""Index of the highest torque: torques rise."""
_CAPTION = " Uppermost: the same of the limited order, with its limit."


def _scatter_figure(study: ToleranceStudy) -> Figure:
    count = study.peak_to_peak.shape[0]
    last = study.quantiles[-1]
    part = f"{100 * last.fraction:g} %"
    size = number(last.value[_HIGHEST] / UM, 3)
    limited = () if study.above is None else (_of_order(study, study.above),)
    lines = _shares(study, study.peak_to_peak)
    distribution = Panel(Axis("peak to peak, µm"), Axis("share of all pairs"), lines, title="Distribution")
    designed = number(study.nominal[_HIGHEST] / UM, 3)
    return Figure(
        key="scatter",
        title="Peak-to-peak transmission error within tolerances",
        caption=f"{count} pairs sampled within their tolerances. First: part of all up to a ripple. "
        f"Lower: quantiles with bounds of {100 * study.confidence:g} % confidence (dotted), and the "
        "pair as designed (dashed)." + (_CAPTION if study.above else ""),
        alternative=f"At the highest torque {part} of all pairs stay below {size} µm; as designed "
        f"{designed} µm.",
        content=(*limited, distribution, _over_torque(study)),
        table=_quantile_table(study),
    )


def _of_order(study: ToleranceStudy, above: PairsAbove) -> Panel:
    across = Axis(f"amplitude of {above.limit.name}, µm")
    limit = Reference("limit", above.limit.amplitude / UM)
    lines = _shares(study, above.amplitude)
    return Panel(across, Axis("share of all pairs"), lines, references=(limit,), title="Limited order")


def _shares(study: ToleranceStudy, sample: FloatArray) -> tuple[Line, ...]:
    """Return the part of all pairs up to a length, a line for each torque."""
    lines = []
    for k, name in enumerate(thousands(study.torque.tolist())):
        ordered = np.sort(sample[:, k]) / UM
        part = np.arange(1, ordered.size + 1) / ordered.size
        drawn_points = np.unique(np.linspace(0, ordered.size - 1, min(_STEPS, ordered.size)).astype(int))
        color = palette.ordered(k, study.torque.size)
        lines.append(Line(f"{name} N m", ordered[drawn_points], part[drawn_points], color))
    return tuple(lines)


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
        for values, errors in ((study.nominal, study.error), (study.mean, study.mean_error)):
            value, error = float(values[k]) / UM, float(errors[k]) / UM
            row += [to_error(value, error), error_text(value, error)]
        for quantile in study.quantiles:
            linear = float(quantiles(study.first_order[:, k], quantile.fraction))
            row += [number(float(quantile.value[k]) / UM, 3), _bounds(quantile, k), number(linear / UM, 3)]
        rows.append(tuple(row))
    count = study.peak_to_peak.shape[0]
    caption = f"Peak to peak of {count} pairs; to first order by the derivatives of the curves as designed"
    return Table(caption, tuple(head), tuple(rows))


def _bounds(quantile: Quantile, k: int) -> str:
    """Write the bounds of a quantile at the k-th torque, µm."""
    low, high = float(quantile.low[k]), float(quantile.high[k])
    return f"{number(low / UM, 3) if low else 'none'} to {number(high / UM, 3)}"


def _influence_table(study: ToleranceStudy) -> Table:
    """Return the rank correlation of each deviation, the strongest at the highest load first."""
    head = ("deviation", *(f"{name} N m" for name in thousands(study.torque.tolist())))
    order = np.argsort(-np.abs(study.influence[:, _HIGHEST]), kind="stable")
    rows = []
    for i in order:
        rows.append((boundary_name(study.names[i]), *(f"{value:+.2f}" for value in study.influence[i])))
    caption = "Influence: rank correlation of a deviation, or of its size, with peak to peak"
    return Table(caption, head, tuple(rows))


def _percent(share: float) -> str:
    return f"{number(100.0 * share, 3)} %"


def _amplitude(length: float) -> str:
    """Return an amplitude in µm and in dB re 1 µm."""
    level = f" ({20.0 * math.log10(length / UM):.1f} dB re 1 µm)" if length > 0.0 else ""
    return f"{number(length / UM, 3)} µm{level}"


def _verdict(study: ToleranceStudy) -> tuple[str, ...]:
    """Return sentences on pairs above the limit, decisive deviations, cures, and the model's error."""
    lines = () if study.above is None else tuple(_above_limit(study, study.above))
    if study.within_class is not None:
        lines += (_class_error(study, study.within_class),)
    if study.solved < len(study.peak_to_peak) or study.above is not None:
        misses = []
        for k, torque in enumerate(thousands(study.torque.tolist())):
            rms, maximum = number(study.missed[k] / UM, 2), number(study.missed_largest[k] / UM, 2)
            misses.append(f"{rms} µm at {torque} N m (at most {maximum})")
        lines += (
            f"{study.solved:,} of {len(study.peak_to_peak):,} pairs are analyzed whole; the model of the "
            f"others misses the peak to peak of {study.held:,} that it does not know by {', '.join(misses)}, "
            "root of the mean square.",
        )
    return lines


def _above_limit(study: ToleranceStudy, above: PairsAbove) -> list[str]:
    k, limit = above.load, above.limit
    torque = thousands(study.torque.tolist())[k]
    band = f"{_percent(above.low[k])} to {_percent(above.high[k])} with {100 * study.confidence:g} %"
    lines = [
        f"{_percent(above.share[k])} of all pairs ({band} confidence) are above "
        f"{_amplitude(limit.amplitude)} at {limit.name} and {torque} N m; as designed "
        f"{_amplitude(above.nominal[k])}. The model puts {_percent(above.beyond[k])} of the pairs it is held "
        "against on the other side."
    ]
    if limit.gear:
        alike = "wheel" if limit.gear == "pinion" else "pinion"
        lines.append(
            f"{study.solved} pairs are solved over a revolution of the {limit.gear}, whose teeth are drawn; "
            f"those of the {alike} are alike. Further pairs and what decides are told to first order."
        )
    names = [boundary_name(name) for name in above.names]
    maximum = above.decides
    alone, all_of = (number(100.0 * float(shares[maximum]), 2) for shares in (above.first_order, above.total))
    part = f"it makes {alone} % of the variance of the level alone, {all_of} % with others"
    lines.append(f"{names[maximum]} decides: {part}.")
    if above.cure is None:
        reason = "no pair is above" if not above.share[k] else "no tolerance a class finer lowers the share"
        return [*lines, f"No cure: {reason}."]
    cured = _percent(above.cured[above.cure])
    return [*lines, f"Cheapest cure: {names[above.cure]} a class finer leaves {cured} above."]


def _class_error(study: ToleranceStudy, of_class: WithinClass) -> str:
    """Return what the class says in place of the measured gears."""
    mean, measured = of_class.mean[_HIGHEST] / UM, study.mean[_HIGHEST] / UM
    text = (
        f"Within the class in place of the measured gears the mean is {number(mean, 3)} µm at "
        f"{number(study.torque[_HIGHEST], 3)} N m, where it is {number(measured, 3)} µm"
    )
    if study.above is None:
        return f"{text}."
    k = study.above.load
    decides = boundary_name(study.above.names[study.above.decides])
    other = boundary_name(of_class.decides)
    agreement = "as it does" if other == decides else f"where {decides} does"
    return (
        f"{text}; {_percent(of_class.share[k])} of the pairs would be above the limit, where "
        f"{_percent(study.above.share[k])} are; {other} would decide, {agreement}."
    )


def _limit_tables(study: ToleranceStudy) -> tuple[Table, ...]:
    """Return shares by torque, and indices and cures by deviation, the one that decides first."""
    above = study.above
    if above is None:
        return ()
    torques = thousands(study.torque.tolist())
    by_torque = []
    for k, torque in enumerate(torques):
        bounds = f"{_percent(above.low[k])} to {_percent(above.high[k])}"
        model = (number(above.missed[k] / UM, 2), _percent(above.beyond[k]))
        nominal = number(above.nominal[k] / UM, 3)
        by_torque.append((torque, nominal, _percent(above.share[k]), bounds, *model))
    head = ("torque, N m", "as designed, µm", "above", "bounds", "model ± µm (1 s)", "other side")
    rows = []
    for i in np.argsort(-above.total, kind="stable"):
        indices = (number(above.total[i], 2), number(above.first_order[i], 2))
        rows.append((boundary_name(above.names[i]), *indices, _percent(above.cured[i])))
    caption = f"Pairs above {_amplitude(above.limit.amplitude)} at {above.limit.name}"
    why = "Sobol' indices of the level, and the share above a class finer"
    decides = f"What decides at {torques[above.load]} N m: {why}"
    return (
        Table(caption, head, tuple(by_torque)),
        Table(decides, ("deviation", "with others", "alone", "above, a class finer"), tuple(rows)),
    )


def _tables(study: ToleranceStudy) -> tuple[Table, ...]:
    return (*_limit_tables(study), _quantile_table(study), _influence_table(study))


def _page(study: ToleranceStudy) -> Page:
    last = study.quantiles[-1]
    below = f"{100 * last.fraction:g} % of all pairs below"
    bounds = f"{_bounds(last, _HIGHEST)} with {100 * study.confidence:g} % confidence"
    heads: tuple[Headline, ...] = (
        Headline("as designed", f"{number(study.nominal[_HIGHEST] / UM, 3)} µm"),
        Headline("mean", f"{number(study.mean[_HIGHEST] / UM, 3)} µm"),
        Headline(below, f"{number(last.value[_HIGHEST] / UM, 3)} µm", bounds),
    )
    figure = replace(_scatter_figure(study), table=None)
    section = Section("Distribution", " ".join(_verdict(study)), (figure,), _tables(study))
    if study.above is not None:
        share = _percent(study.above.share[study.above.load])
        heads = (Headline("above the limit", share, study.above.limit.name), *heads)
    lead = f"{study.peak_to_peak.shape[0]} pairs sampled within their tolerances"
    return Page("Transmission error within tolerances", lead, heads, (section,))


def _point(study: ToleranceStudy) -> str:
    return f"at {typed(float(study.torque[_HIGHEST]))} N m, the highest torque of the table"


PAGE = Presentation(_scatter_figure, _page, lambda study: (*_verdict(study), *_tables(study)), point=_point)
