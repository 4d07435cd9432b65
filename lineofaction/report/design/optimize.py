"""Harris maps before and after, ripple over torque with its scatter, and the gain.

A node is one set of deviations of the flanks with its weight: expectations are weighted sums over the nodes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds import engineering
from bounds.error_digits import error_text, to_error
from fe_contact.microgeometry.conclusion import AT_LEAST, level_change
from fe_contact.microgeometry.confirmation import ConfirmedDesign
from fe_contact.microgeometry.optimization import Optimization
from fe_contact.types import Estimate
from lineofaction.gearbox.convert.boundary_names import boundary_name
from lineofaction.gearbox.studies.optimize.result import HeardOptimization
from lineofaction.gearbox.units import UM, factor
from lineofaction.report.design.heard_flanks import LEVELS
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Line,
    Panel,
    Reference,
    Table,
    number,
    thousands,
)
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation
from lineofaction.report.ste.curves import MAX_CURVES, HarrisScale, harris_panel

_POSITION = "position, base pitches"


def _harris(result: Optimization) -> Figure:
    before, after = (_zero_mean_curves(result, design) for design in (result.start, result.optimum))
    scale = HarrisScale.of(before, after)
    maps = (
        _map(result, "before", result.start, before, scale),
        _map(result, "after", result.optimum, after, scale),
    )
    return Figure(
        key="harris_map",
        title="Transmission error before and after optimization",
        caption="Harris maps without scatter, a curve for each torque, less its mean; and peak-to-peak over "
        f"torque. {_scattered(result)} Dotted vertical lines: design torques.",
        alternative=f"{result.reason}.",
        content=(*maps, _ripple(result)),
        table=_ripple_table(result),
    )


def _chosen(result: Optimization) -> list[int]:
    """Return the indices of drawn torques: of the objective, with more ripple than before, some between."""
    torque = result.start.harris_map.torque
    drawn = {*np.flatnonzero(np.isin(torque, result.torque)).tolist(), *result.rising.tolist()}
    even = np.linspace(torque[0], torque[-1], max(2, MAX_CURVES - len(drawn)))
    return sorted(drawn | {int(np.abs(torque - value).argmin()) for value in even})


def _zero_mean_curves(result: Optimization, design: ConfirmedDesign) -> FloatArray:
    """Return the curves of the chosen torques less their means, um. Shape (positions, torques)."""
    values = design.harris_map.ste[:, _chosen(result)] / UM
    return np.asarray(values - values.mean(axis=0))


def _map(
    result: Optimization, name: str, design: ConfirmedDesign, values: FloatArray, scale: HarrisScale
) -> Panel:
    harris = design.harris_map
    names = [f"{text} N m" for text in thousands([float(harris.torque[k]) for k in _chosen(result)])]
    end = float(np.ceil(harris.position[-1] + 1e-12))  # the next whole pitch, also of a position on one
    position = np.append(harris.position, end)
    closed = np.vstack([values, values[:1]])
    axis = Axis(_POSITION, limits=(0.0, end))
    return harris_panel(f"Harris map {name}", axis, position, closed, names, scale)


def _scattered(result: Optimization) -> str:
    count = result.nodes.weight.size
    if count == 1:
        return "Nothing scatters."
    expectation = f"expectation over the {count} nodes of the scatter"
    return f"Thick lines: {expectation}, dotted ones: its least and largest."


def _ripple(result: Optimization) -> Panel:
    lines: list[Line] = []
    designs = ("before", result.start, palette.DESIGNS[0]), ("after", result.optimum, palette.DESIGNS[1])
    for name, design, color in designs:
        harris = design.harris_map
        if result.nodes.weight.size > 1:
            least, largest = harris.peak_to_peak.min(0) / UM, harris.peak_to_peak.max(0) / UM
            lines.append(Line(f"{name}, least", harris.torque, least, color, "dot", 1.0))
            lines.append(Line(f"{name}, largest", harris.torque, largest, color, "dot", 1.0))
            lines.append(Line(f"{name}, no scatter", harris.torque, harris.nominal / UM, color, "dash", 1.0))
        lines.append(Line(name, harris.torque, harris.expected / UM, color, "solid", 2.4, markers=True))
    counted = tuple(Reference("", float(torque)) for torque in result.torque)
    across = Axis("torque on the driving gear, N m")
    return Panel(across, Axis("peak to peak, µm"), tuple(lines), counted, title="Ripple over torque")


def _ripple_table(result: Optimization) -> Table:
    before, after = result.start.harris_map, result.optimum.harris_map
    rows = []
    for k, text in enumerate(thousands(before.torque.tolist())):
        counts = "yes" if before.torque[k] in result.torque else ""
        first, second = before.expected[k], after.expected[k]
        ripples = (*_value(first, before.expected_error[k]), *_value(second, after.expected_error[k]))
        worst = number(after.peak_to_peak[:, k].max() / UM, 3)
        skew = number(result.map_misalignment[k] / UM, 3)
        rows.append((text, skew, counts, *ripples, number(first / second, 3), worst))
    head = (
        "torque, N m", "misalignment, µm", "counts", "before, µm", "± µm", "after, µm", "± µm", "factor",
        "worst node after, µm",
    )  # fmt: skip
    return Table("Expected peak to peak of the transmission error", head, tuple(rows))


def _value(value: float, error: float) -> tuple[str, str]:
    return to_error(value / UM, error / UM), error_text(value / UM, error / UM)


def _optimum_table(result: Optimization) -> Table:
    rows = []
    for var, step in zip(result.variables, result.sensitivity, strict=True):
        name = boundary_name(var.name)
        unit = factor(name)
        values = result.start.values[var.name], result.optimum.values[var.name], var.low, var.high
        changes = (
            f"{engineering(change / UM, 2, '+')} at {number(end / unit, 3)}"
            for change, end in ((step.change_low, step.low), (step.change_high, step.high))
        )
        rows.append((name, *(number(value / unit, 4) for value in values), *changes))
    head = ("variable", "start", "optimum", "least", "most", "lower, µm", "higher, µm")
    return Table("Design, and the change of the objective by a perturbation", head, tuple(rows))


def _node_table(result: Optimization) -> Table:
    head = [*(f"{boundary_name(name)} by" for name in result.nodes.names), "weight"]
    for word in ("before", "after"):
        head += [f"{word}, {torque} N m, µm" for torque in thousands(result.torque.tolist())]
    counted = np.flatnonzero(np.isin(result.start.harris_map.torque, result.torque))
    units = [factor(boundary_name(name)) for name in result.nodes.names]
    rows = []
    for node, weight in enumerate(result.nodes.weight):
        amounts = zip(result.nodes.deviation[node], units, strict=True)
        deviation = (engineering(amount / unit, 3, "+") for amount, unit in amounts)
        ripples = (d.harris_map.peak_to_peak[node, counted] / UM for d in (result.start, result.optimum))
        cells = (number(x, 3) for ripple in ripples for x in ripple)
        rows.append((*deviation, number(weight, 3), *cells))
    return Table("Robustness: peak to peak at every node of the scatter", tuple(head), tuple(rows))


def _run_table(result: Optimization) -> Table:
    rows = []
    for k, run in enumerate(result.runs):
        objective = number(run.assessed.objective / UM, 4)
        explored = f", {run.explored} of them at few positions" if run.explored else ""
        cost = number(run.cpu_seconds, 2)
        rows.append((str(k), objective, f"{run.evaluations}{explored}", run.ended.value, cost))
    return Table("Searches", ("start", "objective, µm", "designs", "ended", "CPU s"), tuple(rows))


def _optimization_page(result: Optimization) -> Page:
    before, after = result.start.objective, result.optimum.objective
    harmonic = result.request["objective"].get("harmonic")  # None: the peak-to-peak counts
    counted = _counted(result)
    heads = [_headline("before", before, counted), _headline("after", after, counted)]
    heads.insert(len(heads) if harmonic is None else 0, _gain(result, harmonic))
    lead = f"{result.reason}; {result.evaluations} designs of {len(result.variables)} variables"
    figure = Section("Harris map", "", (replace(_harris(result), table=None),), (_ripple_table(result),))
    design = Section("Design", "", tables=(_optimum_table(result),))
    tried = f"Not tried: {'; '.join(result.not_tried)}."
    stages = result.cost["stages"].items()
    rows = tuple((name, number(cost["cpu_seconds"], 3)) for name, cost in stages)
    search = Section("Search", tried, tables=(_run_table(result), Table("Cost", ("stage", "CPU s"), rows)))
    robust = Section("Scatter", "", tables=(_node_table(result),))
    what = "transmission error" if harmonic is None else f"harmonic {harmonic}"
    return Page(f"Microgeometry of least {what}", lead, tuple(heads), (figure, design, robust, search))


def _gain(result: Optimization, harmonic: int | None) -> Headline:
    """Return the gain: of a harmonic the change of its level, else that of the peak-to-peak."""
    outcome = result.outcome.replace("_", " ")
    if harmonic is None:
        return Headline("gain", f"{number(result.gain.value / UM, 3)} µm", outcome)
    before, after = result.start.objective, result.optimum.objective
    name = f"{'fall' if after.value <= before.value else 'rise'} of harmonic {harmonic}"
    size = level_change(before, after)
    if not size:
        return Headline(name, "within the errors", outcome)
    if size.startswith(AT_LEAST):
        return Headline(f"least {name}", size.removeprefix(AT_LEAST), outcome)
    value, _, error = size.partition(" ± ")
    return Headline(name, f"{value} dB", f"± {error}, {outcome}")


def _counted(result: Optimization) -> str:
    """Return what of the transmission error counts, and at which loads, in words."""
    objective, torque = result.request["objective"], result.torque
    harmonic = objective.get("harmonic")
    what = "expected peak to peak" if harmonic is None else f"harmonic {harmonic}"
    if torque.size == 1:
        return f"{what} at {thousands(torque.tolist())[0]} N m"
    ends = thousands([float(torque.min()), float(torque.max())])
    over = str(objective["objective"]).replace("_", " ")
    return f"{what}, {over} over {torque.size} loads from {ends[0]} to {ends[1]} N m"


def _headline(name: str, objective: Estimate, counted: str) -> Headline:
    value, error = _value(objective.value, objective.error)
    return Headline(name, f"{value} µm", f"± {error} µm; {counted}")


def _text(result: Optimization) -> Iterator[Table | str]:
    yield _optimum_table(result)
    yield _ripple_table(result)
    for line in result.not_tried:
        yield f"not tried: {line}"
    yield f"{result.outcome.replace('_', ' ')}: {result.reason}; {result.evaluations} designs"


RIPPLE = Presentation(_harris, _optimization_page, _text)


def _presentation(result: Optimization | HeardOptimization) -> Presentation:
    return LEVELS if isinstance(result, HeardOptimization) else RIPPLE


PAGE = Presentation(
    lambda result: _presentation(result).figure(result),
    lambda result: _presentation(result).page(result),
    lambda result: _presentation(result).text(result),
)
