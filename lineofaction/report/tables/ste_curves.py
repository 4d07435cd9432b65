"""Static transmission error less its mean, and the Harris map: curves of the loads set apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from fe_contact.types import Estimate
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Table, number
from lineofaction.report.tables.aligned import (
    few_loads,
    load_curve,
    load_labels,
    load_lines,
    pitches_shown,
    position_axis,
    shown_loads,
    ste_shown,
)
from lineofaction.report.tables.harris_map import MOST_CURVES, HarrisScale, harris_panel
from lineofaction.report.tables.pairs_in_contact import pairs_in_words, steps_with_pairs

_TONES = 3
_LEAST_ROOM, _MOST_ROOM = 0.08, 0.45
"""Of the ripple, above and below it: for its error band, and no more, so that it fills half of the height."""
_FLAT = 1e-3  # µm, the height of a curve without any ripple


def ste_curves(database: SteDatabase) -> Figure:
    """Draw STE less its mean at a few loads, and at more of them as a Harris map."""
    curves = [load_curve(database, load) for load in range(database.force.size)]
    ripple = _ripple(database, curves)
    panels = (ripple, _harris(database, curves)) if len(shown_loads(database)) > 1 else (ripple,)
    return Figure(
        key="ste",
        title=f"Static transmission error over {_pitches(database)}",
        caption="STE: displacement on the transverse line of action by which the driven gear lags, relative "
        f"to conjugate motion; drawn less its mean. {_bands(ripple)}{_carriers(database)}"
        + _period(database),
        alternative=_words(database, curves),
        content=panels,
        table=_table(database, curves),
    )


def _ripple(database: SteDatabase, curves: list[Curve]) -> Panel:
    """Draw the curves less their means, each with the band of its peak-to-peak's error."""
    position, ripple = _less_mean(database, curves)
    lines = tuple(
        replace(line, label=_label(line, curves[load]), band=_half_error(curves[load]))
        for line, load in zip(load_lines(database, position, ripple), few_loads(database), strict=True)
    )
    return Panel(
        position_axis(database),
        Axis("STE less its mean, µm", limits=_ripple_limits(lines)),
        lines,
        title="Ripple",
    )


def _ripple_limits(lines: tuple[Line, ...]) -> tuple[float, float]:
    """Return the ends of an axis that holds the curves and, as far as they fill half of it, their bands."""
    values = np.concatenate([line.y for line in lines])
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    ripple = high - low or _FLAT
    room = np.clip(
        max(float(np.nan_to_num(line.band)) for line in lines), _LEAST_ROOM * ripple, _MOST_ROOM * ripple
    )
    return low - float(room), high + float(room)


def _label(line: Line, curve: Curve) -> str:
    """Name a load with its mean and its ripple."""
    mean, ripple = (_um(e.value, 3) for e in (curve.mean, curve.peak_to_peak))
    return f"{line.name}: mean {mean} µm,\n{ripple} µm peak to peak"


def _harris(database: SteDatabase, curves: list[Curve]) -> Panel:
    """Draw the curves of the loads set apart."""
    position, ripple = _less_mean(database, curves)
    loads, labels = few_loads(database, MOST_CURVES), load_labels(database)
    chosen, names = ripple[:, loads], [labels[k] for k in loads]
    return harris_panel(
        "Harris map", position_axis(database), position, chosen, names, HarrisScale.of(chosen)
    )


def _less_mean(database: SteDatabase, curves: list[Curve]) -> tuple[FloatArray, FloatArray]:
    """Return the positions shown (n,), and STE there less the mean of each load (n, F), µm."""
    position, values = ste_shown(database)
    return position, 1e6 * (values - np.array([curve.mean.value for curve in curves]))


def _half_error(curve: Curve) -> float:
    """Half the error of peak-to-peak, µm: two curves within such a band differ by no more."""
    return 0.5e6 * curve.peak_to_peak.error


def _bands(ripple: Panel) -> str:
    """Say what the bands are, where there are any, and which are cut."""
    if not any(line.has_band for line in ripple.lines):
        return ""
    said = "Bands: half the error of peak-to-peak on either side"
    low, high = ripple.y.limits or (-np.inf, np.inf)
    cut = [
        line.name
        for line in ripple.lines
        if np.nanmax(line.y + line.band) > high or np.nanmin(line.y - line.band) < low
    ]
    return f"{said}, cut by the axis at {', '.join(cut)}. " if cut else f"{said}. "


def _pitches(database: SteDatabase) -> str:
    shown = pitches_shown(database)
    return "two base pitches" if shown == 2 else f"{shown} base pitches"


def _carriers(database: SteDatabase) -> str:
    """Say how many pairs carry the highest load, and whether the curve shows it."""
    load = shown_loads(database)[-1]
    carried = f"At {load_labels(database)[load]} {pairs_in_words(database, load)}"
    return (
        f"{carried}: low where more do, high where fewer."
        if steps_with_pairs(database, load)
        else f"{carried}."
    )


def _period(database: SteDatabase) -> str:
    """Say after how many pitches a table with pitch errors repeats."""
    if database.period == 1:
        return ""
    return f" The teeth have pitch errors: the curve repeats after {database.period} base pitches."


def _words(database: SteDatabase, curves: list[Curve]) -> str:
    """Say how large the ripple is at the ends of the loads."""
    labels, loads = load_labels(database), shown_loads(database)
    ends = {labels[k]: curves[k] for k in (loads[-1], loads[0])}
    parts = [
        f"{_band(curve.peak_to_peak, 3)} µm at {label}, about a mean of {_um(curve.mean.value, 3)} µm"
        for label, curve in ends.items()
    ]
    return f"Peak to peak is {'; '.join(parts)}."


def _table(database: SteDatabase, curves: list[Curve]) -> Table:
    """Mean, peak to peak and the first harmonics with their error estimates at every load."""
    rows = []
    for load, (label, curve) in enumerate(zip(load_labels(database), curves, strict=True)):
        band = [_band(e) for e in (curve.mean, curve.peak_to_peak)]
        tones = [_um(e.value, 3) for e in curve.harmonics[:_TONES]]
        rows.append((label, number(float(database.force[load]), 5), *band, *tones))
    head = ("torque", "normal force, N", "mean, µm", "peak to peak, µm")
    orders = tuple(f"harmonic {k}, µm" for k in range(1, _TONES + 1))
    return Table("Static transmission error by load", head + orders, tuple(rows))


def _band(estimate: Estimate, digits: int = 4) -> str:
    """Write a number in micrometers, with its error if that was estimated."""
    value = _um(estimate.value, digits)
    return value if np.isnan(estimate.error) else f"{value} ± {_um(estimate.error, 2)}"


def _um(value: float, digits: int = 4) -> str:
    return number(value * 1e6, digits)
