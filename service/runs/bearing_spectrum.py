"""Spectrum of a bearing force near the end of a run, with the orders of the mesh marked."""

from __future__ import annotations

import numpy as np

from dynamics.orders import spectrum
from service.drawing import palette
from service.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Reference, Table, number
from service.runs.run_series import RunSeries, validity

WINDOW = (0.9, 0.95)  # of the duration
ORDERS = 8


def bearing_spectrum(run: RunSeries) -> Figure:
    """Draw the amplitude spectrum of the force on the bearing where it varies most."""
    name = run.loudest_bearing
    window = spectrum_window(run)
    frequency, amplitude = amplitude_spectrum(run.time[window], run.bearings[name][window])
    mesh = run.mesh_frequency[window]
    return Figure(
        key="bearing_spectrum",
        title=f"Spectrum of the force on bearing {name}",
        caption=f"From {_moment(run, window.start)} to {_moment(run, window.stop - 1)} s, Hann window, "
        "amplitudes of the three components added in power. Dashed: the mesh frequency in the middle of the "
        f"window and its multiples. {validity(run.valid_order, float(run.mesh_frequency.max()))}",
        alternative=_words(frequency, amplitude, mesh),
        content=(_panel(frequency, amplitude, float(np.median(mesh)), run.valid_order),),
        table=_table(frequency, amplitude, mesh, run.valid_order),
    )


def spectrum_window(run: RunSeries) -> slice:
    """Return the samples between 90 and 95 % of the duration."""
    first, last = (int(share * (len(run.time) - 1)) for share in WINDOW)
    return slice(first, last + 1)


def amplitude_spectrum(time: FloatArray, force: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return frequencies in Hz and amplitudes in N of a force (n, 3) on a uniform grid, without its mean."""
    made = spectrum(force.T, 1.0 / float(time[1] - time[0]), "N")
    amplitude = np.asarray(np.sqrt(np.sum(made.amplitude**2, axis=0)))
    return made.frequency[1:], amplitude[1:]


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


def _panel(frequency: FloatArray, amplitude: FloatArray, mesh: float, valid: int) -> Panel:
    """Draw up to a little beyond the last order marked, as far as it is valid."""
    last = max(min(ORDERS, valid), 1)
    end = min((last + 0.5) * mesh, float(frequency[-1]))
    shown = frequency <= end
    orders = [Reference(f"{k}×", k * mesh) for k in range(1, last + 1) if k * mesh < end]
    line = Line("force", frequency[shown], np.maximum(amplitude[shown], 1e-12), palette.BLUE, width=1.2)
    top = float(amplitude[shown].max())
    y = Axis("amplitude, N", "log", (1e-5 * top, 3.0 * top))
    return Panel(Axis("frequency, Hz", limits=(0.0, end)), y, (line,), tuple(orders))


def _words(frequency: FloatArray, amplitude: FloatArray, mesh: FloatArray) -> str:
    """Name the largest line and where the mesh frequency is."""
    peak = int(np.argmax(amplitude))
    low, high = number(float(mesh.min()), 3), number(float(mesh.max()), 3)
    return (
        f"The largest line is {number(float(amplitude[peak]), 3)} N at "
        f"{number(float(frequency[peak]), 4)} Hz; the mesh frequency runs from {low} to {high} Hz."
    )


def _table(frequency: FloatArray, amplitude: FloatArray, mesh: FloatArray, valid: int) -> Table:
    """Largest line near every valid order."""
    rows = tuple(
        (str(order), number(where, 4), number(size, 3))
        for order, (where, size) in enumerate(order_amplitudes(frequency, amplitude, mesh)[:valid], start=1)
    )
    return Table(
        "Largest line in the band of each mesh order", ("order", "frequency, Hz", "amplitude, N"), rows
    )


def _moment(run: RunSeries, index: int) -> str:
    """Write the time of a sample."""
    return number(float(run.time[index]), 3)
