"""Plots of a sweep: maps over two axes, curves over one with their error bands."""

from __future__ import annotations

import numpy as np

from fe_contact.microgeometry.sweep import SweptQuantity
from fe_contact.microgeometry.sweep_request import TORQUE
from lineofaction.gearbox.studies.sweep.run import QUANTITIES, SweepResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, HeatMap, Line, Panel

MOST_CURVES = 6


def maps(result: SweepResult) -> Figure:
    """Draw each quantity over both axes as colors; the least is marked."""
    over = " and ".join(axis.words for axis in result.axes)
    return Figure(
        "sweep_map",
        f"Map over {over}",
        f"Colors run from the least to the largest value. Dots: {_alike(result)}.",
        "",
        tuple(_map(result, quantity) for quantity in result.quantities),
    )


def curves(result: SweepResult) -> Figure:
    """Draw quantities over one axis; over two the first one, a curve for some values of the other axis."""
    one = len(result.axes) == 1
    quantities = result.quantities if one else result.quantities[:1]
    across = result.across
    return Figure(
        "sweep_curves",
        _title(result),
        "Bands are the errors.",
        "",
        tuple(
            Panel(
                Axis(result.axes[across].label),
                Axis(QUANTITIES[quantity.name].label),
                tuple(_lines(result, quantity)),
            )
            for quantity in quantities
        ),
    )


def _map(result: SweepResult, quantity: SweptQuantity) -> Panel:
    """One quantity over both axes, the torque across."""
    across = result.across
    x, y = result.levels(across), result.levels(1 - across)
    shown = QUANTITIES[quantity.name]
    z = result.grid(quantity.value) / shown.one
    known = z[np.isfinite(z)]
    least, largest = float(known.min()), float(known.max())
    shade = HeatMap(x, y, z, shown.label, largest if largest > least else least + 1.0, least)
    at = np.argwhere(result.like_least(quantity))
    marks = Line(
        _alike(result),
        x[at[:, 1]],
        y[at[:, 0]],
        palette.VERMILLION,
        width=0.0,
        markers=True,
    )
    axes = Axis(result.axes[across].label), Axis(result.axes[1 - across].label)
    return Panel(*axes, (marks,), title=shown.words, shade=shade)


def _lines(result: SweepResult, quantity: SweptQuantity) -> list[Line]:
    """Draw a curve with its band; of two axes one for each of some values of the other."""
    shown = QUANTITIES[quantity.name]
    value, error = (result.grid(values) / shown.one for values in (quantity.value, quantity.error))
    x = result.levels(result.across)
    if len(result.axes) == 1:
        return [Line(shown.words, x, value, palette.BLUE, markers=True, band=error)]
    other = result.axes[1 - result.across]
    levels = result.levels(1 - result.across)
    rows = np.unique(np.linspace(0, levels.size - 1, min(levels.size, MOST_CURVES)).round().astype(int))
    return [
        Line(
            f"{levels[row]:.6g} {other.unit}",
            x,
            value[row],
            palette.ordered(count, rows.size),
            markers=True,
            band=error[row],
            label=f"{levels[row]:.6g} {other.unit}",
        )
        for count, row in enumerate(rows)
    ]


def _alike(result: SweepResult) -> str:
    """Say what the dots of a map stand for."""
    at = "at the same torque " if TORQUE in result.sweep.axes else ""
    return f"as low as the least {at}within both errors"


def _title(result: SweepResult) -> str:
    """Name the first quantity and the axis that runs across."""
    words = QUANTITIES[result.quantities[0].name].words
    return f"{words[0].upper()}{words[1:]} over {result.axes[result.across].words}"
