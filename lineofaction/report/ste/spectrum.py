"""The spectrum of the transmission error: of one load, and over torque."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fe_contact.ste import Curve, SteDatabase
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Bars,
    Figure,
    FloatArray,
    Panel,
    Table,
    um,
)
from lineofaction.report.ste.curves import load_curve, load_labels, middle_load

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
    names = [f"order {one:.4g}" for one in order] if curve.period == 1 else curve.spectrum.names
    chosen = np.sort(np.argsort(-amplitude, kind="stable")[:ORDERS])
    rows = tuple((names[k].removeprefix("order "), um(amplitude[k], 3), um(error[k], 2)) for k in chosen)
    return Figure(
        key="ste_spectrum",
        title=f"Spectrum of the transmission error at {label}",
        caption="Order 1 is the mesh frequency. Amplitudes in the gray are below their stated "
        "error."
        + (
            " Orders between the whole ones come from deviations of single teeth, run-out or waves."
            if database.period > 1
            else ""
        ),
        alternative=_spectrum_words(label, names, amplitude, error),
        content=(_panel(order, amplitude, error),),
        table=Table("Orders of the transmission error", ("mesh order", "amplitude, µm", "error, µm"), rows),
    )


def _spectrum_of(curve: Curve) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return orders (K,), amplitudes and errors, m: the mesh harmonics, or all orders of a long period."""
    if curve.period == 1:
        values = np.array([[e.value, e.error] for e in curve.harmonics[:ORDERS]])
        return np.arange(1.0, len(values) + 1.0), values[:, 0], values[:, 1]
    lines = curve.spectrum
    shown = lines.order <= LONG_ORDERS + 1e-9
    return lines.order[shown], lines.amplitude[shown], lines.error[shown]


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


def _spectrum_words(label: str, names: Sequence[str], amplitude: FloatArray, error: FloatArray) -> str:
    most = int(np.argmax(amplitude))
    size = f"{um(amplitude[most], 3)} µm"
    text = f"At {label} {names[most]} is the largest, {size}"
    if np.isnan(error).all():
        return f"{text}; the errors were not estimated."
    above = int(np.count_nonzero(amplitude > error))
    return f"{text}; {above} of {amplitude.size} orders exceed their error."
