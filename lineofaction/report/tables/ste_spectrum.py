"""Mesh orders of the transmission error as bars, beside their errors."""

from __future__ import annotations

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Bars, Figure, FloatArray, Panel, Table, number
from lineofaction.report.tables.aligned import load_curve, load_labels, middle_load

ORDERS = 20
LONG_ORDERS = 4  # over a period of many pitches, where as many lines lie between two mesh orders
_UM = 1e6
_DEPTH = 10.0  # dB below the least error, or below the level that counts where none is known
_UNKNOWN = -80.0  # dB below the largest


def ste_spectrum(database: SteDatabase) -> Figure:
    """Draw the amplitude of every order at the middle load, what is below its error veiled."""
    load = middle_load(database)
    curve, label = load_curve(database, load), load_labels(database)[load]
    order, amplitude, error = _spectrum_of(curve)
    return Figure(
        key="ste_spectrum",
        title=f"Spectrum of the transmission error at {label}",
        caption="Order 1 is the mesh frequency. Amplitudes in the gray are below their stated "
        "error."
        + (" Orders between the whole ones come from the pitch errors." if database.period > 1 else ""),
        alternative=_words(label, order, amplitude, error),
        content=(_panel(order, amplitude, error),),
        table=_table(order, amplitude, error),
    )


def _spectrum_of(curve: Curve) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return orders (K,), amplitudes and errors, m: the mesh harmonics, or all orders of a long period."""
    if curve.period == 1:
        values = np.array([[e.value, e.error] for e in curve.harmonics[:ORDERS]])
        return np.arange(1.0, len(values) + 1.0), values[:, 0], values[:, 1]
    lines = curve.spectrum
    shown = lines.order <= LONG_ORDERS + 1e-9
    return lines.order[shown], lines.amplitude[shown], np.full(np.count_nonzero(shown), lines.error)


def _panel(order: FloatArray, amplitude: FloatArray, error: FloatArray) -> Panel:
    level, limit = _level(amplitude), _level(error)
    top = float(np.nanmax(np.concatenate([level, limit])))
    least = np.nanmin(limit) if np.isfinite(limit).any() else top + _UNKNOWN
    base = float(np.floor((least - _DEPTH) / 10.0) * 10.0)
    spacing = float(order[0])
    bars = Bars("amplitude", order, np.maximum(level, base), base, 0.6 * spacing, palette.BLUE)
    veil = Bars("below its error", order, np.maximum(limit, base), base, spacing, palette.MUTED, veiled=True)
    x = Axis("mesh order", limits=(float(order[0]) - spacing, float(order[-1]) + spacing))
    return Panel(x, Axis("amplitude, dB re 1 µm", limits=(base, top + 5.0)), bars=(bars, veil))


def _level(values: FloatArray) -> FloatArray:
    """Return lengths in dB re 1 µm; NaN for nothing, and for what is not known."""
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 20.0 * np.log10(_UM * values)
    return np.where(np.isfinite(level), level, np.nan)


def _words(label: str, order: FloatArray, amplitude: FloatArray, error: FloatArray) -> str:
    """Say which order is largest, and how many exceed their errors."""
    most = int(np.argmax(amplitude))
    size = f"{number(_UM * amplitude[most], 3)} µm"
    text = f"At {label} order {order[most]:.4g} is the largest, {size}"
    if np.isnan(error).all():
        return f"{text}; the errors were not estimated."
    above = int(np.count_nonzero(amplitude > error))
    return f"{text}; {above} of {order.size} orders exceed their error."


def _table(order: FloatArray, amplitude: FloatArray, error: FloatArray) -> Table:
    """Tabulate the largest twenty orders."""
    chosen = np.sort(np.argsort(-amplitude, kind="stable")[:ORDERS])
    rows = tuple(
        (f"{order[k]:.4g}", number(_UM * amplitude[k], 3), number(_UM * error[k], 2)) for k in chosen
    )
    return Table("Orders of the transmission error", ("mesh order", "amplitude, µm", "error, µm"), rows)
