"""A study of scenes: maps and curves over the grid, distributions, influences, worst and failed runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds import engineering
from dynamics.study import Study
from lineofaction.gearbox.studies.study.run import in_boundary_units
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Line, Panel, Table, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation
from model_studies.spread import quantiles

MAX_RESPONSES, MAX_CURVES, MAX_FACTORS = 4, 6, 12
BAR = 9.0
"""Width of the bars of a tornado, pixels."""
MAX_ROWS = 12
"""Lines of the tables of worst and failed runs."""


def _label(study: Study, response: int) -> str:
    """Return the title of a response with its unit last."""
    return f"{study.response[response]}, {_unit(study, response)}"


def _unit(study: Study, response: int) -> str:
    """Return the unit of a response as plots have it."""
    symbol, _ = in_boundary_units(study, response)
    return {"um": "µm", "": "ratio"}.get(symbol, symbol)


def _grid_figures(study: Study) -> tuple[Figure, ...]:
    """Draw means over the grid: curves over one factor, a map over two; nothing without a grid."""
    axes = [k for k in _varied(study) if study.kind[k] == "grid"]
    responses = range(min(len(study.response), MAX_RESPONSES))
    if not axes:
        return ()
    if len(axes) == 1:
        return (_curves(study, axes[0], responses),)
    panels = tuple(_map(study, axes[0], axes[1], response) for response in responses)
    caption = "Means over all other factors and samples; colors span least to largest. White: no figures."
    return (
        Figure("study_map", _over(study, axes[:2]), caption, _extreme(study), panels),
        _curves(study, axes[0], responses),
    )


def _over(study: Study, axes: list[int]) -> str:
    return f"Responses over {' and '.join(study.factor[k] for k in axes)}"


def _map(study: Study, across: int, up: int, response: int) -> Panel:
    x, y = (np.unique(study.value[:, axis]) for axis in (across, up))
    _, scale = in_boundary_units(study, response)
    z = np.full((y.size, x.size), np.nan)
    for row, column in np.ndindex(z.shape):
        cell_runs = (study.value[:, across] == x[column]) & (study.value[:, up] == y[row])
        values = study.figure[cell_runs, response]
        if np.isfinite(values).any():
            z[row, column] = np.nanmean(values) / scale
    shade = HeatMap.spanning(x, y, z, _unit(study, response))
    axes = Axis(study.factor[across]), Axis(study.factor[up])
    return Panel(*axes, title=study.response[response], shade=shade)


def _curves(study: Study, axis: int, responses: range) -> Figure:
    """Draw the means over one factor, and the 5 % and 95 % quantiles of sampled runs."""
    panels = []
    for response in responses:
        axes = Axis(study.factor[axis]), Axis(_unit(study, response))
        panels.append(Panel(*axes, _lines(study, axis, response), title=study.response[response]))
    caption = "Mean over all other factors"
    if study.samples > 1:
        caption += " and samples; dotted: 5 % and 95 % of the runs at a level lie below"
    return Figure("study_curves", _over(study, [axis]), f"{caption}.", _extreme(study), tuple(panels))


def _lines(study: Study, axis: int, response: int) -> tuple[Line, ...]:
    _, scale = in_boundary_units(study, response)
    levels, mean = study.level_means(axis, response)
    lines = [Line("mean", levels, mean / scale, palette.BLUE, markers=True)]
    if study.samples > 1:
        for fraction in (0.05, 0.95):
            rows = [study.figure[study.value[:, axis] == level, response] for level in levels]
            ends = np.array([quantiles(row[np.isfinite(row)], fraction) for row in rows])
            name = f"{100 * fraction:g} %"
            lines.append(Line(name, levels, ends / scale, palette.VERMILLION, "dot", 1.2))
    return tuple(lines)


def _distribution_figure(study: Study) -> Figure:
    below = Axis("runs below, %", limits=(0.0, 100.0))
    panels = tuple(
        Panel(Axis(_label(study, response)), below, tuple(_cumulative(study, response)))
        for response in range(min(len(study.response), MAX_RESPONSES))
    )
    population = "the samples of a combination" if study.samples > 1 else "all points"
    caption = f"Share of {population} that lies below a value."
    title = "Distribution of the responses"
    return Figure("study_distribution", title, caption, _extreme(study), panels)


def _cumulative(study: Study, response: int) -> list[Line]:
    """Draw step curves of a few combinations; without samples one curve of all points."""
    _, scale = in_boundary_units(study, response)
    rows = study.column(response) if study.samples > 1 else study.figure[:, response][None]
    chosen = np.unique(np.linspace(0, len(rows) - 1, min(len(rows), MAX_CURVES)).round().astype(int))
    lines = []
    for count, row in enumerate(chosen.tolist()):
        values = np.sort(rows[row][np.isfinite(rows[row])]) / scale
        share = 100.0 * np.arange(values.size + 1) / max(values.size, 1)
        color = palette.ordered(count, len(chosen))
        if values.size:
            # at each value the curve steps from one share up to the next
            steps = np.repeat(values, 2), np.repeat(share, 2)[1:-1]
            lines.append(Line(_combination(study, row), *steps, color))
    return lines


def _combination(study: Study, row: int) -> str:
    if study.samples == 1:
        return "all points"
    value = study.value[row * study.samples]
    levels = [k for k in _varied(study) if study.kind[k] in ("grid", "list")]
    return ", ".join(f"{_short(study, k)} {value[k]:.6g}" for k in levels) or "all samples"


def _varied(study: Study) -> list[int]:
    return [k for k in range(len(study.factor)) if np.unique(study.value[:, k]).size > 1]


def _short(study: Study, factor: int) -> str:
    """Return the last name of a factor's path, or the whole path where another ends with the same name."""
    ends = [path.rpartition(".")[2] for path in study.factor]
    return ends[factor] if ends.count(ends[factor]) == 1 else study.factor[factor]


def _tornado_figure(study: Study) -> Figure:
    """Draw the influence of each factor on the first response: by level means, or by rank correlation."""
    return Figure(
        "study_tornado",
        "What matters",
        "Factors by what they do to the first response: those of grid and list by the means of their levels, "
        "sampled ones by Spearman's rank correlation within each combination, of their value or of its "
        "distance from the median.",
        _extreme(study),
        (*_by_levels(study), *_by_samples(study)),
    )


def _by_levels(study: Study) -> list[Panel]:
    """Draw a bar between the means of the levels of each factor; none where none is known."""
    _, scale = in_boundary_units(study, 0)
    bars = []
    for factor in _varied(study):
        if study.kind[factor] in ("grid", "list") and np.isfinite(study.swing(factor, 0)):
            means = study.level_means(factor, 0)[1] / scale
            bars.append((float(np.nanmin(means)), float(np.nanmax(means)), study.factor[factor]))
    return [_bars(bars, f"means of the levels: {_label(study, 0)}")] if bars else []


def _by_samples(study: Study) -> list[Panel]:
    """Draw the rank correlation of each sampled factor as a bar from 0; none where none is known."""
    correlations = zip(study.factor, map(float, study.correlation(0)), strict=True)
    bars = [(min(0.0, c), max(0.0, c), name) for name, c in correlations if np.isfinite(c)]
    return [_bars(bars, f"rank correlation with {study.response[0]}", (-1.0, 1.0))] if bars else []


def _bars(
    bars: list[tuple[float, float, str]], text: str, limits: tuple[float, float] | None = None
) -> Panel:
    ordered = sorted(bars, key=lambda bar: bar[0] - bar[1])[:MAX_FACTORS]
    heights = [float(len(ordered) - k) for k in range(len(ordered))]
    lines = tuple(
        Line(name, np.array([low, high]), np.full(2, height), palette.category(0), width=BAR)
        for (low, high, name), height in zip(ordered, heights, strict=True)
    )
    names = tuple((height, name) for (_, _, name), height in zip(ordered, heights, strict=True))
    # bars stand at heights 1, 2 ...: a margin of 0.6 below the lowest and above the highest
    return Panel(Axis(text, limits=limits), Axis("", limits=(0.4, len(ordered) + 0.6), names=names), lines)


def _extreme(study: Study) -> str:
    """Return a sentence on the point of the largest first response."""
    first = study.figure[:, 0]
    if not np.isfinite(first).any():
        return "No run has figures."
    point = int(np.nanargmax(first))
    _, scale = in_boundary_units(study, 0)
    values = zip(study.factor, study.value[point], strict=True)
    levels = ", ".join(f"{name} = {value:.6g}" for name, value in values)
    largest = f"{number(float(first[point]) / scale, 4)} {_unit(study, 0)}"
    return f"Largest {study.response[0]}: {largest} at {levels}."


def _study_figures(study: Study) -> tuple[Figure, ...]:
    if not study.usable:
        return (_distribution_figure(study),)
    figures = (*_grid_figures(study), _distribution_figure(study), _tornado_figure(study))
    return tuple(figure for figure in figures if figure.content)


def _summary_table(study: Study) -> Table:
    rows = []
    for k in range(len(study.response)):
        _, scale = in_boundary_units(study, k)
        values = study.figure[:, k][np.isfinite(study.figure[:, k])] / scale
        errors = study.error[:, k][np.isfinite(study.error[:, k])] / scale
        texts = ["none"] * 3
        if values.size:
            texts = [number(float(figure), 4) for figure in (values.min(), values.mean(), values.max())]
        rows.append((_label(study, k), *texts, number(errors.mean(), 2) if errors.size else "not stated"))
    head = ("response", "least", "mean", "largest", "stated error, mean")
    return Table("Responses of all runs", head, tuple(rows))


def _extreme_table(study: Study) -> Table:
    first = study.figure[:, 0]
    usable = np.flatnonzero(np.isfinite(first))
    points = usable[np.argsort(-first[usable], kind="stable")][:MAX_ROWS]
    varied, responses = _varied(study), range(len(study.response))
    head = (*(_short(study, k) for k in varied), *(_label(study, k) for k in responses))
    units = [scale for _, scale in (in_boundary_units(study, k) for k in responses)]
    rows = []
    for point in points:
        levels = (f"{study.value[point, k]:.6g}" for k in varied)
        figures = (number(float(study.figure[point, k]) / units[k], 4) for k in responses)
        rows.append((str(point), *levels, *figures, "yes" if point in study.worst else ""))
    caption = f"Worst cases: runs of the largest {study.response[0]}"
    return Table(caption, ("point", *head, "kept in full"), tuple(rows))


def _failed_table(study: Study) -> Table:
    failed = [k for k, reason in enumerate(study.reason) if reason]
    rows = tuple(
        (str(k), *(f"{study.value[k, f]:.6g}" for f in _varied(study)), study.reason[k])
        for k in failed[:MAX_ROWS]
    )
    caption = f"Runs without figures: {len(failed)} of {len(study.reason)}"
    return Table(caption, ("point", *(_short(study, f) for f in _varied(study)), "reason"), rows)


def _page(study: Study) -> Page:
    failed = len(study.reason) - study.usable
    usable = f"{failed} without figures" if failed else "all with figures"
    unit, scale = in_boundary_units(study, 0)
    first = study.figure[:, 0][np.isfinite(study.figure[:, 0])] / scale
    largest = f"{number(first.max(), 4)} {unit}".strip() if first.size else "none"
    heads = (
        Headline("runs", str(len(study.reason)), usable),
        Headline("largest", largest, study.response[0]),
        Headline("cost of a run", f"{1e3 * float(study.seconds[:, 0].mean()):.0f} ms", "CPU time, mean"),
    )
    tables = [_summary_table(study), _extreme_table(study)]
    if failed:
        tables.append(_failed_table(study))
    figures = tuple(replace(figure, table=None) for figure in _study_figures(study))
    sections = (Section("Responses", "", figures), Section("Figures", "", (), tuple(tables)))
    without = ", ".join(study.metadata["neglected"])
    samples = f" {study.samples} samples of each combination." if study.samples > 1 else ""
    over = ", ".join(study.factor[k] for k in _varied(study))
    lead = f"{len(study.reason)} runs over {over}.{samples} Neglected in the runs: {without}."
    sentences = (f"{line[:1].upper()}{line[1:]}." for line in _effect_lines(study))
    return Page("Many scenes", " ".join([lead, *sentences]), heads, sections)


def _effect_lines(study: Study) -> Iterator[str]:
    """Yield lines on the effects of all runs; files of versions without a decision on them have none."""
    effects = study.metadata.get("effects")
    if not effects or not effects["points"]:
        return
    names = ", ".join(name.replace("_", " ") for name in effects["neglected"]) or "none of known influence"
    yield f"effects decided once for all runs, at {effects['points']} points; off: {names}"
    if largest := effects["largest"]:
        size = f"{engineering(largest['decibels'], 2)} {largest['unit']}"
        yield f"largest influence of an effect that is off: {size} by {largest['effect'].replace('_', ' ')}"


def _text(study: Study) -> Iterator[Table | str]:
    yield _summary_table(study)
    yield _extreme_table(study)
    if study.usable < len(study.reason):
        yield _failed_table(study)
    yield f"neglected in the runs: {', '.join(study.metadata['neglected'])}"
    yield from _effect_lines(study)
    yield f"cost {engineering(1e3 * float(study.seconds[:, 0].mean()), 3)} ms CPU a run"


PAGE = Presentation(lambda study: _study_figures(study)[0], _page, _text)
