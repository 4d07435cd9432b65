"""The spectrum of the transmission error: of one load, and over torque.

Axes of arrays: K orders, F loads, n cells of the map. Orders count in mesh frequencies.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bounds.error_digits import to_error
from fe_contact.ste import Curve, SteDatabase
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Bars,
    Figure,
    FloatArray,
    HeatMap,
    Panel,
    Table,
    largest,
    um,
)
from lineofaction.report.drawing.marks import TORQUE
from lineofaction.report.ste.curves import drawn_loads, headline_load, load_curve, load_labels

ORDERS = 20
LONG_ORDERS = 4  # highest mesh order over a period of N pitches, where N lines belong to each
_UM = 1e6
_DEPTH = 10.0  # range drawn below the least error, or below the least relevant level if none is known, dB
_UNKNOWN = -80.0  # lowest level re the largest if no error is known, dB
_CELLS = 480  # across the map: a line of one of them is still seen
_RANGE = 60.0  # range of levels between the ends of the colors, dB
_COLUMNS = 8  # most columns of the table


def ste_spectrum(database: SteDatabase, force: float | None = None) -> Figure:
    """Draw the amplitude of every order at the middle load, veiled below its error."""
    load = headline_load(database, force)
    curve, label = load_curve(database, load), load_labels(database)[load]
    order, amplitude, error = _spectrum_of(curve)
    names = _order_names(curve, order)
    drawn = np.sort(np.argsort(-amplitude, kind="stable")[:ORDERS])
    rows = tuple(
        (names[k].removeprefix("order "), to_error(_UM * amplitude[k], _UM * error[k]), um(error[k], 2))
        for k in drawn
    )
    caption = "Order 1 is the mesh frequency. Amplitudes in the gray are below their stated error."
    if database.period > 1:
        caption += " Orders between the whole ones come from deviations of single teeth, run-out or waves."
    return Figure(
        key="ste_spectrum",
        title=f"Spectrum of the transmission error at {label}",
        caption=caption,
        alternative=_spectrum_text(label, names, amplitude, error),
        content=(_panel(order, amplitude, error),),
        table=Table("Orders of the transmission error", ("mesh order", "amplitude, µm", "error, µm"), rows),
    )


def _spectrum_of(curve: Curve) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return orders (K,), amplitudes and errors, m: the mesh harmonics, or all orders of a long period."""
    if curve.period == 1:
        values = np.array([[e.value, e.error] for e in curve.harmonics[:ORDERS]])
        return np.arange(1.0, len(values) + 1.0), values[:, 0], values[:, 1]
    lines = curve.spectrum
    inside = lines.order <= LONG_ORDERS + 1e-9
    return lines.order[inside], lines.amplitude[inside], lines.error[inside]


def _panel(order: FloatArray, amplitude: FloatArray, error: FloatArray) -> Panel:
    level, limit = _level(amplitude), _level(error)
    top = float(np.nanmax(np.concatenate([level, limit])))
    minimum = np.nanmin(limit) if np.isfinite(limit).any() else top + _UNKNOWN
    base = float(np.floor((minimum - _DEPTH) / 10.0) * 10.0)
    spacing = float(order[0])  # lines stand at multiples of the first
    bars = Bars("amplitude", order, np.maximum(level, base), base, 0.6 * spacing, palette.BLUE)
    veil = Bars("below its error", order, np.maximum(limit, base), base, spacing, palette.MUTED, veiled=True)
    x = Axis("mesh order", limits=(float(order[0]) - spacing, float(order[-1]) + spacing))
    return Panel(x, Axis("amplitude, dB re 1 µm", limits=(base, top + 5.0)), bars=(bars, veil))


def _level(values: FloatArray) -> FloatArray:
    """Return lengths in dB re 1 µm; NaN for zero and for unknown lengths."""
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 20.0 * np.log10(_UM * values)
    return np.where(np.isfinite(level), level, np.nan)


def _spectrum_text(label: str, names: Sequence[str], amplitude: FloatArray, error: FloatArray) -> str:
    maximum = int(np.argmax(amplitude))
    size = f"{um(amplitude[maximum], 3)} µm"
    text = f"At {label} {names[maximum]} is the largest, {size}"
    if np.isnan(error).all():
        return f"{text}; the errors were not estimated."
    above = int(np.count_nonzero(amplitude > error))
    return f"{text}; {above} of {amplitude.size} orders exceed their error."


def ste_waterfall(database: SteDatabase) -> Figure:
    """Draw the level of every order at every load; a level below its error stays blank."""
    loads = drawn_loads(database)
    curves = [load_curve(database, load) for load in loads]
    orders, amplitudes, errors = zip(*map(_spectrum_of, curves), strict=True)
    order, amplitude, error = orders[0], np.stack(amplitudes), np.stack(errors)
    known = ~(error >= amplitude) & (amplitude > 0.0)  # also where no error was estimated
    level = np.where(known, _level(amplitude), np.nan)
    names = _order_names(curves[0], order)
    middles, cells = _in_cells(order, level)
    torque = database.torque[list(loads)]
    top = float(np.nanmax(level)) if known.any() else 0.0
    label = "amplitude, dB re 1 µm"
    shade = HeatMap(middles, torque, np.maximum(cells, top - _RANGE), label, top, top - _RANGE)
    x = Axis("mesh order", limits=(0.5 * float(order[0]), float(order[-1] + 0.5 * order[0])))
    return Figure(
        key="ste_waterfall",
        title="Spectrum of the transmission error over torque",
        caption=_waterfall_caption(order, middles, error),
        alternative=_waterfall_text(database, names, level),
        content=(Panel(x, Axis.over(TORQUE, torque), shade=shade),),
        table=_waterfall_table(database, names, level),
    )


def _order_names(curve: Curve, order: FloatArray) -> Sequence[str]:
    return [f"order {value:.4g}" for value in order] if curve.period == 1 else curve.spectrum.names


def _in_cells(order: FloatArray, level: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the middles of at most `_CELLS` cells (n,), and the largest levels in them (F, n)."""
    count = -(-order.size // _CELLS)  # orders to a cell, rounded up
    starts = np.arange(0, order.size, count)
    width = np.minimum(starts + count, order.size) - starts
    return order[starts] + 0.5 * (width - 1) * order[0], np.fmax.reduceat(level, starts, axis=1)


def _waterfall_caption(order: FloatArray, cells: FloatArray, error: FloatArray) -> str:
    unknown = "their errors were not estimated" if np.isnan(error).all() else "blank: below the stated error"
    shared = -(-order.size // cells.size)  # orders to a cell, rounded up
    caption = (
        f"Colors: amplitudes of the orders, {unknown}; the darkest are {_RANGE:g} dB and more below the "
        "largest. The color of a stored load reaches half the way to the next."
    )
    return f"{caption} A cell is as wide as {shared} orders and shows the largest." if shared > 1 else caption


def _waterfall_text(database: SteDatabase, names: Sequence[str], level: FloatArray) -> str:
    if np.isnan(level).all():
        return "No order exceeds its error at any load."
    load, order = divmod(int(np.nanargmax(level)), level.shape[1])
    label = load_labels(database)[drawn_loads(database)[load]]
    text = f"{names[order]} at {label} is the largest: {level[load, order]:.1f} dB re 1 µm."
    return f"{text[0].upper()}{text[1:]}"


def _waterfall_table(database: SteDatabase, names: Sequence[str], level: FloatArray) -> Table:
    """List the orders that are largest at any load."""
    maximum = np.nan_to_num(np.fmax.reduce(level, axis=0), nan=-np.inf)
    columns = [k for k in largest(maximum, _COLUMNS) if np.isfinite(maximum[k])]
    labels = load_labels(database)
    rows = []
    for load, row in zip(drawn_loads(database), level[:, columns], strict=True):
        cells = ("below its error" if np.isnan(value) else f"{value:.1f}" for value in row)
        rows.append((labels[load], *cells))
    head = ("torque", *(names[k] for k in columns))
    return Table("Levels of the largest orders, dB re 1 µm", head, tuple(rows))
