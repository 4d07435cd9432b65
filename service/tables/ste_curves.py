"""Static transmission error over two base pitches at every load of the database."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from fe_contact.types import Estimate
from service.drawing.figure import Axis, Figure, Line, Panel, Table, number
from service.tables.aligned import (
    load_curve,
    load_labels,
    load_lines,
    pitches_shown,
    position_axis,
    shown_loads,
    ste_shown,
)
from service.tables.pairs_in_contact import pairs_in_words, steps_with_pairs

_TONES = 3


def ste_curves(database: SteDatabase) -> Figure:
    """Draw STE against position, one line per load."""
    ripple = _ripple(database)
    panels = (ripple, _whole(database, ripple)) if len(ripple.lines) > 1 else (ripple,)
    return Figure(
        key="ste",
        title=f"Static transmission error over {_pitches(database)}",
        caption="Displacement on the transverse line of action by which the driven gear lags, relative to "
        f"conjugate motion. {_bands(ripple)}{_carriers(database)}" + _period(database),
        alternative=_words(database),
        content=panels,
        table=_table(database),
    )


def _ripple(database: SteDatabase) -> Panel:
    """Draw the curves less their means, each with the band of its peak-to-peak's error."""
    position, values = ste_shown(database)
    curves = [load_curve(database, load) for load in range(database.force.size)]
    means = np.array([curve.mean.value for curve in curves])
    lines = load_lines(database, position, (values - means) * 1e6)
    shown = [(line, curves[load]) for line, load in zip(lines, shown_loads(database), strict=True)]
    if len(shown) == 1:
        title = f"{lines[0].name}, less its mean of {_um(shown[0][1].mean.value)} µm"
    else:
        title = "less the mean of each load"
    return Panel(
        position_axis(database),
        Axis("STE less its mean, µm"),
        tuple(replace(line, name=_named(line, curve), band=_half_error(curve)) for line, curve in shown),
        title=title,
    )


def _whole(database: SteDatabase, ripple: Panel) -> Panel:
    """Draw the curves from zero, under the names of the panel above."""
    position, values = ste_shown(database)
    lines = load_lines(database, position, values * 1e6)
    named = (replace(line, name=above.name) for line, above in zip(lines, ripple.lines, strict=True))
    limits = (1.05 * min(float(np.nanmin(values)), 0.0) * 1e6, 1.05 * float(np.nanmax(values)) * 1e6)
    return Panel(ripple.x, Axis("STE, µm", limits=limits), tuple(named), title="whole")


def _named(line: Line, curve: Curve) -> str:
    """Name a load with its mean."""
    return f"{line.name}: mean {_um(curve.mean.value)} µm"


def _half_error(curve: Curve) -> float:
    """Half the error of peak-to-peak, µm: two curves within such a band differ by no more."""
    return 0.5e6 * curve.peak_to_peak.error


def _bands(ripple: Panel) -> str:
    """Say what the bands are, where there are any."""
    if not any(line.has_band for line in ripple.lines):
        return ""
    return "Bands: half the error of peak-to-peak on either side. "


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
    """Write a number in micrometers, with its error if that was estimated."""
    value = _um(estimate.value)
    return value if np.isnan(estimate.error) else f"{value} ± {_um(estimate.error, 2)}"


def _um(value: float, digits: int = 4) -> str:
    """Write meters as micrometers."""
    return number(value * 1e6, digits)
