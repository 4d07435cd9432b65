"""Static transmission error over two base pitches at every load of the database."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import SteDatabase
from fe_contact.types import Estimate
from service.report.aligned import (
    load_curve,
    load_labels,
    load_lines,
    pitches_shown,
    position_axis,
    shown_loads,
    ste_shown,
)
from service.report.figure import Axis, Figure, FloatArray, Panel, Table, number
from service.report.pairs_in_contact import pairs_in_words, steps_with_pairs

_TONES = 3
_FAR = 0.7  # lowest over highest value
_MARGIN = 0.2


def ste_curves(database: SteDatabase) -> Figure:
    """Draw STE against position, one line per load."""
    position, values = ste_shown(database)
    y = Axis("static transmission error, µm", limits=_limits(values * 1e6))
    panel = Panel(position_axis(database), y, load_lines(database, position, values * 1e6))
    return Figure(
        key="ste",
        title=f"Static transmission error over {_pitches(database)}",
        caption="Displacement on the transverse line of action by which the driven gear lags, relative to "
        f"conjugate motion. {_carriers(database)}" + _period(database),
        alternative=_words(database),
        content=(panel,),
        table=_table(database),
    )


def _limits(values: FloatArray) -> tuple[float, float]:
    """Return the ends of the axis: from zero, unless the curves lie so far above it that no ripple shows."""
    top, low = float(np.nanmax(values)), float(np.nanmin(values))
    if low > _FAR * top:
        return low - _MARGIN * (top - low), top + _MARGIN * (top - low)
    return 1.05 * min(low, 0.0), 1.05 * top


def _pitches(database: SteDatabase) -> str:
    """Say how many pitches are shown."""
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
    return f" The teeth have pitch errors: everything repeats after {database.period} base pitches."


def _words(database: SteDatabase) -> str:
    """Say what the plot shows at its ends."""
    labels, loads = load_labels(database), shown_loads(database)
    ends = [
        f"{_um(load_curve(database, k).peak_to_peak.value, 3)} µm at {labels[k]}"
        for k in (loads[0], loads[-1])
    ]
    if len(loads) == 1:
        return f"One periodic curve; peak to peak {ends[0]}."
    return f"{len(loads)} periodic curves rise with load; peak to peak from {ends[0]} to {ends[1]}."


def _table(database: SteDatabase) -> Table:
    """Mean, peak to peak and the first harmonics with their error estimates at every load."""
    rows = []
    for load, label in enumerate(load_labels(database)):
        curve = load_curve(database, load)
        band = [_band(e) for e in (curve.mean, curve.peak_to_peak)]
        tones = [_um(e.value, 3) for e in curve.harmonics[:_TONES]]
        rows.append((label, number(float(database.force[load]), 5), *band, *tones))
    head = ("torque", "normal force, N", "mean, µm", "peak to peak, µm")
    orders = tuple(f"harmonic {k}, µm" for k in range(1, _TONES + 1))
    return Table("Static transmission error by load", head + orders, tuple(rows))


def _band(estimate: Estimate) -> str:
    """Write a number in micrometres, with its error if that was estimated."""
    value = _um(estimate.value)
    return value if np.isnan(estimate.error) else f"{value} ± {_um(estimate.error, 2)}"


def _um(value: float, digits: int = 4) -> str:
    """Write metres as micrometres."""
    return number(value * 1e6, digits)
