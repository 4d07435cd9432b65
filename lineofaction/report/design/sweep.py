"""Page of a sweep: maps, curves, and least values with the points that are as low within the errors."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bounds.error_digits import error_text, to_error, with_error
from fe_contact.microgeometry.sweep import SweptQuantity
from fe_contact.microgeometry.sweep_request import TORQUE
from lineofaction.gearbox.studies.sweep.run import QUANTITIES, SweepResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Line, Panel, Table, ordered_lines
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.presentation import Presentation

MAX_CURVES = 6
"""Largest number of curves in a panel over one of two axes."""
BEYOND = "by more than the errors"
"""End of the remark on a least value that no other value equals within both errors."""


def _maps(result: SweepResult) -> Figure:
    """Draw each quantity over both axes as colors; the least is marked."""
    over = " and ".join(axis.description for axis in result.axes)
    return Figure(
        "sweep_map",
        f"Map over {over}",
        f"Colors run from the least to the largest value. Dots: {_least_label(result)}.",
        "",
        tuple(_map(result, quantity) for quantity in result.quantities),
    )


def _curves(result: SweepResult) -> Figure:
    """Draw curves over the horizontal axis.

    A sweep of one axis has a panel for each quantity. A sweep of two axes has the first quantity alone, with
    a curve for each of at most `MAX_CURVES` values of the other axis.
    """
    quantities = result.quantities if len(result.axes) == 1 else result.quantities[:1]
    x = Axis(result.axes[result.across].label)
    title = QUANTITIES[result.quantities[0].name].description
    return Figure(
        "sweep_curves",
        f"{title[0].upper()}{title[1:]} over {result.axes[result.across].description}",
        "Bands are the errors.",
        "",
        tuple(
            Panel(x, Axis(QUANTITIES[quantity.name].label), _lines(result, quantity))
            for quantity in quantities
        ),
    )


def _map(result: SweepResult, quantity: SweptQuantity) -> Panel:
    """Draw one quantity over both axes as a panel; a swept torque is the horizontal axis."""
    across = result.across  # index (0 or 1) of the horizontal axis
    x, y = result.levels(across), result.levels(1 - across)
    kind = QUANTITIES[quantity.name]
    z = result.grid(quantity.value) / kind.one  # from SI to the unit of the plot
    shade = HeatMap.spanning(x, y, z, kind.label)
    rows, columns = np.nonzero(result.like_least(quantity))
    marks = Line(_least_label(result), x[columns], y[rows], palette.VERMILLION, width=0.0, markers=True)
    axes = Axis(result.axes[across].label), Axis(result.axes[1 - across].label)
    return Panel(*axes, (marks,), title=kind.description, shade=shade)


def _lines(result: SweepResult, quantity: SweptQuantity) -> tuple[Line, ...]:
    """Return the curves of a quantity over the horizontal axis with their error bands.

    One swept axis gives one curve, two give at most `MAX_CURVES`, whose values of the other axis are spaced
    evenly by index.
    """
    kind = QUANTITIES[quantity.name]
    value, error = (result.grid(values) / kind.one for values in (quantity.value, quantity.error))
    x = result.levels(result.across)
    if len(result.axes) == 1:
        return (Line(kind.description, x, value, palette.BLUE, markers=True, band=error),)
    other = result.axes[1 - result.across]
    levels = result.levels(1 - result.across)
    rows = np.unique(np.linspace(0, levels.size - 1, min(levels.size, MAX_CURVES)).round().astype(int))
    return ordered_lines(x, [f"{levels[row]:.6g} {other.unit}" for row in rows], value[rows], error[rows])


def _least_label(result: SweepResult) -> str:
    """Return the label of the points that equal the least value within both errors."""
    condition = "at the same torque " if TORQUE in result.sweep.axes else ""
    return f"as low as the least {condition}within both errors"


def figure(result: SweepResult) -> Figure:
    """Draw maps over two axes, curves over one."""
    return _figures(result)[0]


def _figures(result: SweepResult) -> tuple[Figure, ...]:
    """Return the figures: of two axes the maps and the curves of the first quantity, of one the curves."""
    texts = [f"{h.name[0].upper()}{h.name[1:]}: {h.value} {h.remark}." for h in _headlines(result)]
    if len(result.axes) == 1:
        return (replace(_curves(result), alternative=" ".join(texts)),)
    least, largest = texts or ("", "")
    return replace(_maps(result), alternative=least), replace(_curves(result), alternative=largest)


def _table(result: SweepResult, quantity: SweptQuantity) -> Table:
    """Return the table of a quantity with its errors.

    Over two axes it has a column for each value of the horizontal axis and a row for each of the other.
    """
    kind, across = QUANTITIES[quantity.name], result.across
    texts = [
        with_error(value / kind.one, error / kind.one) if np.isfinite(value) else "none"
        for value, error in zip(quantity.value, quantity.error, strict=True)
    ]
    x = result.axes[across]
    levels = [f"{level:.6g}" for level in result.levels(across)]
    if len(result.axes) == 1:
        return Table(kind.label, (x.label, kind.label), tuple(zip(levels, texts, strict=True)))
    grid = result.grid(np.array(texts))
    head = (result.axes[1 - across].label, *(f"{level} {x.unit}" for level in levels))
    rows = tuple((f"{level:.6g}", *row) for level, row in zip(result.levels(1 - across), grid, strict=True))
    return Table(f"{kind.label} over {x.description}", head, rows)


def _series(result: SweepResult) -> Table:
    swept = result.sweep
    head = [axis.path for axis in result.axes]
    columns = [swept.point[:, k] / axis.factor for k, axis in enumerate(result.axes)]
    for quantity in swept.quantities:
        kind = QUANTITIES[quantity.name]
        head += [kind.field.format(""), kind.field.format("_error")]
        columns += [quantity.value / kind.one, quantity.error / kind.one]
    rows = tuple(tuple(f"{value:.9g}" for value in row) for row in zip(*columns, strict=True))
    return Table("All points", tuple(head), rows)


def _headlines(result: SweepResult) -> tuple[Headline, ...]:
    """Return the least and the largest value of the first quantity.

    The remark on the least one counts the points that equal it within the errors.
    """
    if not result.sweep.usable:
        return ()
    quantity = result.quantities[0]
    kind = QUANTITIES[quantity.name]
    worst = int(np.nanargmax(quantity.value))
    largest = Headline(f"largest {kind.description}", *_value_and_remark(result, quantity, worst))
    if len(result.axes) == 2 and TORQUE in result.sweep.axes:
        return (_best_level(result, quantity), largest)
    best = Headline(f"least {kind.description}", *_value_and_remark(result, quantity, quantity.minimum))
    equals = int(quantity.like_least.sum()) - 1  # without the least point itself
    others = f"as low within the errors: {equals} others" if equals else f"below all others {BEYOND}"
    return (replace(best, remark=f"{best.remark}; {others}"), largest)


def _value_and_remark(result: SweepResult, quantity: SweptQuantity, point: int) -> tuple[str, str]:
    """Return a value as text with its unit, and its error with the values of the axes at the point."""
    kind = QUANTITIES[quantity.name]
    where = " and ".join(
        f"{axis.description} {result.sweep.point[point, k] / axis.factor:.6g} {axis.unit}"
        for k, axis in enumerate(result.axes)
    )
    value, error = (float(values[point]) / kind.one for values in (quantity.value, quantity.error))
    band = f"± {error_text(value, error)} {kind.unit}".strip()
    return f"{to_error(value, error)} {kind.unit}".strip(), f"{band} at {where}"


def _best_level(result: SweepResult, quantity: SweptQuantity) -> Headline:
    """Return the value of the other axis at which the mean of a quantity over the torques is least."""
    down, kind = 1 - result.across, QUANTITIES[quantity.name]  # the torque is the horizontal axis
    axis, levels = result.axes[down], result.levels(down)
    value, error = (
        result.grid(values).mean(axis=1) / kind.one for values in (quantity.value, quantity.error)
    )
    best = int(np.nanargmin(value))
    within_errors = value - value[best] <= error + error[best]
    within_errors[best] = False
    others = ", ".join(f"{level:.6g}" for level in levels[within_errors])
    also = f"as low within the errors: {others} {axis.unit}" if others else f"below all others {BEYOND}"
    text = f"{to_error(value[best], error[best])} {kind.unit}".strip()
    band = f"± {error_text(value[best], error[best])} {kind.unit}".strip()
    where = f"at {axis.description} {levels[best]:.6g} {axis.unit}"
    return Headline(f"least mean {kind.description} over the torques", text, f"{band} {where}; {also}")


def _page(result: SweepResult) -> Page:
    over = " and ".join(axis.description for axis in result.axes)
    failed = len(result.sweep.reason) - result.sweep.usable
    lead = f"{len(result.sweep.reason)} points over {over}"
    alarms = (f"{failed} points have no figures: the contact was not solved.",) if failed else ()
    tables = tuple(_table(result, quantity) for quantity in result.quantities)
    section = Section(f"Over {over}", "", _figures(result), folded=tables)
    return Page(f"Map over {over}", lead, _headlines(result), (section,), alarms)


def _text(result: SweepResult) -> Iterator[Table | str]:
    yield _table(result, result.quantities[0])
    points, usable = len(result.sweep.reason), result.sweep.usable
    yield f"{points} points, {points - usable} without figures"


PAGE = Presentation(figure, _page, _text, series=_series)
