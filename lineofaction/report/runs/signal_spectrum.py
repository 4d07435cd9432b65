"""Spectrum of the shown quantity near the end of a run, with the orders of the mesh marked."""

from __future__ import annotations

import numpy as np

from dynamics.orders import highest_valid_order, order_frequency, spectrum
from dynamics.results import RunResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table, number
from lineofaction.report.runs.run_series import counted_by, validity
from lineofaction.report.runs.run_view import Signal

WINDOW = (0.9, 0.95)  # of the duration
ORDERS = 8
LEAST_SAMPLES = 8  # of a window
TOO_SHORT = f"Too short for a spectrum: 90 to 95 % of the duration holds fewer than {LEAST_SAMPLES} samples."
_NAMES = {"hann": "Hann", "rectangular": "rectangular", "flat_top": "flat top"}


def signal_spectrum(run: RunResult, signal: Signal) -> Figure:
    """Draw the amplitude spectrum."""
    window = spectrum_window(run.time)
    frequency, amplitude = amplitude_spectrum(run, signal, window)
    whole, of = order_frequency(run, signal.mesh), counted_by(run)
    mesh = whole[window]
    valid = highest_valid_order(run, signal.mesh)
    first, last = (number(float(run.time[at]), 3) for at in (window.start, window.stop - 1))
    return Figure(
        key="spectrum",
        title=f"Spectrum of the {signal.name}",
        caption=f"From {first} to {last} s, "
        f"{_NAMES[signal.window]} window, {signal.scale} values. "
        f"Dashed: the {of} frequency in the middle of the window and its multiples. "
        f"{validity(valid, float(whole.max()), of)}",
        alternative=_words(signal, frequency, amplitude, mesh, of),
        content=(_panel(signal, frequency, amplitude, float(np.median(mesh)), valid),),
        table=_table(signal, frequency, amplitude, mesh, (of, valid)),
    )


def has_spectrum(run: RunResult) -> bool:
    """Whether a run is long enough for one: its window holds a line beside the mean."""
    window = spectrum_window(run.time)
    return len(run.time[window]) >= LEAST_SAMPLES


def spectrum_window(time: FloatArray) -> slice:
    """Return the samples between 90 and 95 % of the duration."""
    first, last = (int(share * (len(time) - 1)) for share in WINDOW)
    return slice(first, last + 1)


def amplitude_spectrum(run: RunResult, signal: Signal, window: slice) -> tuple[FloatArray, FloatArray]:
    """Return frequencies in Hz and amplitudes of a stretch in the signal's unit, without the mean."""
    values = getattr(run, signal.quantity.series)[..., window]
    made = spectrum(values, run.sample_rate, window=signal.window)
    return made.frequency[1:], signal.amplitude(made.amplitude)[1:]


def order_amplitudes(
    frequency: FloatArray, amplitude: FloatArray, mesh: FloatArray
) -> list[tuple[float, float]]:
    """Return frequency and amplitude of the largest line in the band that each mesh order sweeps."""
    peaks = []
    spacing = float(frequency[0])  # the first line stands one spacing above zero
    for order in range(1, ORDERS + 1):
        low, high = order * float(mesh.min()) - spacing, order * float(mesh.max()) + spacing
        band = np.flatnonzero((frequency >= low) & (frequency <= high))
        if band.size == 0:
            break
        peak = band[np.argmax(amplitude[band])]
        peaks.append((float(frequency[peak]), float(amplitude[peak])))
    return peaks


def _panel(signal: Signal, frequency: FloatArray, amplitude: FloatArray, mesh: float, valid: int) -> Panel:
    """Draw up to a little beyond the last order marked, as far as it is valid."""
    last = max(min(ORDERS, valid), 1)
    end = float(np.clip((last + 0.5) * mesh or np.inf, frequency[0], frequency[-1]))  # a line at least
    shown = frequency <= end
    orders = [Reference(f"{k}×", k * mesh) for k in range(1, last + 1) if k * mesh < end]
    line = Line(signal.name, frequency[shown], np.maximum(amplitude[shown], 1e-12), palette.BLUE, width=1.2)
    top = float(amplitude[shown].max())
    y = Axis(f"amplitude, {signal.unit}", "log", (1e-5 * top, 3.0 * top))
    return Panel(Axis("frequency, Hz", limits=(0.0, end)), y, (line,), tuple(orders))


def _words(signal: Signal, frequency: FloatArray, amplitude: FloatArray, mesh: FloatArray, of: str) -> str:
    """Name the largest line and where the frequency of the orders is."""
    peak = int(np.argmax(amplitude))
    low, high = number(float(mesh.min()), 3), number(float(mesh.max()), 3)
    runs = f"is {low} Hz" if low == high else f"runs from {low} to {high} Hz"
    return (
        f"The largest line is {number(float(amplitude[peak]), 3)} {signal.unit} at "
        f"{number(float(frequency[peak]), 4)} Hz; the {of} frequency {runs}."
    )


def _table(
    signal: Signal, frequency: FloatArray, amplitude: FloatArray, mesh: FloatArray, orders: tuple[str, int]
) -> Table:
    """Largest line near every valid order of what they count by."""
    of, valid = orders
    rows = tuple(
        (str(order), number(where, 4), number(size, 3))
        for order, (where, size) in enumerate(order_amplitudes(frequency, amplitude, mesh)[:valid], start=1)
    )
    head = ("order", "frequency, Hz", f"amplitude, {signal.unit}")
    return Table(f"Largest line in the band of each {of} order", head, rows)
