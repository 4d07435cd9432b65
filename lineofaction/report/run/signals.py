"""A signal of a run over time, over frequency and in bands, and the dynamic transmission error."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.orders import (
    ThirdOctaves,
    Waterfall,
    highest_valid_order,
    order_frequency,
    spectrum,
    third_octaves,
)
from dynamics.results import RunResult
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Line,
    Panel,
    Reference,
    Table,
    number,
    step_line,
    um,
)
from lineofaction.report.drawing.placing import envelope
from lineofaction.report.run.view import (
    PITCHES,
    Signal,
    Travel,
    counted_by,
    decibels,
    is_steady,
    travel,
    validity,
    window_speeds,
)

AXES = "Components in the fixed frame; of a planet bearing in its carrier's."
DETAIL = "Second: less the mean of the window."
WINDOW = (0.9, 0.95)  # start and end of the shown window over the duration
ORDERS = 8
MIN_SAMPLES = 8  # least samples of a window
TOO_SHORT = f"Too short for a spectrum: 90 to 95 % of the duration holds fewer than {MIN_SAMPLES} samples."
_NAMES = {"hann": "Hann", "rectangular": "rectangular", "flat_top": "flat top"}
DEPTH = 80.0
_X = Axis("travel of the driving gear within the window, base pitches", limits=(0, PITCHES))


def signal_over_time(run: RunResult, signal: Signal) -> Figure:
    """Draw the components of the quantity, and less their means over a few base pitches, for the ripple."""
    way = travel(run, signal.mesh)
    speed = window_speeds(way.speed_rpm)[-1]
    window = way.window(speed)
    unit_of_travel = "base pitches" if run.mesh else "turns"
    detail = f"three {unit_of_travel} at {number(speed, 3)} rpm"
    vector = signal.quantity.part == "bearing"
    quantity, _, unit = signal.label.rpartition(", ")
    size = signal.magnitude(getattr(run, signal.quantity.series)[..., window])
    mean, swing = number(size.mean(), 4), number(np.ptp(size), 3)
    written = signal.quantity.unit
    return Figure(
        key="signal",
        title=f"Time history of the {signal.name}",
        caption=f"{AXES} {DETAIL}" if vector else DETAIL,
        alternative=f"Magnitude {mean} {written} on average, {swing} {written} peak to peak.",
        content=(
            _panel(run, signal, slice(None), "whole run", signal.label),
            _panel(run, signal, window, detail, f"{quantity} less its mean, {unit}", about_mean=True),
        ),
        table=_table(run, signal),
    )


def _panel(
    run: RunResult, signal: Signal, window: slice, title: str, label: str, *, about_mean: bool = False
) -> Panel:
    lines = []
    for index, (component, values) in enumerate(signal.components(run).items()):
        selected = values[window]
        if about_mean:
            selected = selected - selected.mean()
        time, decimated = envelope(run.time[window], selected)
        name = component or signal.quantity.noun
        lines.append(Line(name, time, decimated, palette.category(index), width=1.2))
    return Panel(Axis.over("time, s", run.time[window]), Axis(label), tuple(lines), title=title)


def _table(run: RunResult, signal: Signal) -> Table:
    unit = signal.quantity.unit
    values = signal.quantity.factor * getattr(run, signal.quantity.series)
    names = run.bearing if values.ndim == 3 else run.mesh
    parts = ("x", "y", "z") if values.ndim == 3 else ("",)
    # a row for each part: first the means of its components, then the deviations
    moments = np.stack([values.mean(axis=-1), values.std(axis=-1)], axis=1).reshape(len(names), -1)
    rows = [(name, *(number(v, 4) for v in row)) for name, row in zip(names, moments, strict=True)]
    titles = [f"{moment} {part}".rstrip() for moment in ("mean", "deviation") for part in parts]
    head = (signal.quantity.part, *(f"{title}, {unit}" for title in titles))
    return Table("Mean and standard deviation over the run", head, tuple(rows))


def signal_spectrum(run: RunResult, signal: Signal) -> Figure:
    """Draw the amplitude spectrum."""
    window = spectrum_window(run.time)
    frequency, amplitude = amplitude_spectrum(run, signal, window)
    mesh_frequency, base = order_frequency(run, signal.mesh), counted_by(run)  # base: "mesh" or the shaft
    mesh = mesh_frequency[window]
    valid = highest_valid_order(run, signal.mesh)
    first, last = number(run.time[window.start], 3), number(run.time[window.stop - 1], 3)
    return Figure(
        key="spectrum",
        title=f"Spectrum of the {signal.name}",
        caption=f"From {first} to {last} s, "
        f"{_NAMES[signal.window]} window, {signal.scale} values. "
        f"Dashed: the {base} frequency in the middle of the window and its multiples. "
        f"{validity(valid, float(mesh_frequency.max()), base)}",
        alternative=_spectrum_text(signal, frequency, amplitude, mesh, base),
        content=(_spectrum_panel(signal, frequency, amplitude, float(np.median(mesh)), valid),),
        table=_spectrum_table(signal, order_amplitudes(frequency, amplitude, mesh)[:valid], base),
    )


def has_spectrum(run: RunResult) -> bool:
    """Whether a run is long enough for a spectrum: its window resolves a line above the mean."""
    window = spectrum_window(run.time)
    return len(run.time[window]) >= MIN_SAMPLES


def spectrum_window(time: FloatArray) -> slice:
    """Return the samples between 90 and 95 % of the duration."""
    first, last = (int(share * (len(time) - 1)) for share in WINDOW)
    return slice(first, last + 1)


def amplitude_spectrum(run: RunResult, signal: Signal, window: slice) -> tuple[FloatArray, FloatArray]:
    """Return frequencies in Hz and amplitudes in the signal's unit, of a window and without the mean."""
    values = getattr(run, signal.quantity.series)[..., window]
    lines = spectrum(values, run.sample_rate, window=signal.window)
    return lines.frequency[1:], signal.amplitude(lines.amplitude)[1:]


def order_amplitudes(
    frequency: FloatArray, amplitude: FloatArray, mesh: FloatArray
) -> list[tuple[float, float]]:
    """Return frequency (Hz) and amplitude of the largest line of each mesh order, from the first."""
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


def _spectrum_panel(
    signal: Signal, frequency: FloatArray, amplitude: FloatArray, mesh: float, valid: int
) -> Panel:
    last = max(min(ORDERS, valid), 1)
    # half an order beyond the last, all lines where nothing turns, and at least the first line
    end = float(np.clip((last + 0.5) * mesh or np.inf, frequency[0], frequency[-1]))
    inside = frequency <= end
    orders = [Reference(f"{k}×", k * mesh) for k in range(1, last + 1) if k * mesh < end]
    line = Line(signal.name, frequency[inside], np.maximum(amplitude[inside], 1e-12), palette.BLUE, width=1.2)
    top = float(amplitude[inside].max())
    y = Axis(f"amplitude, {signal.unit}", "log", (1e-5 * top, 3.0 * top))
    return Panel(Axis("frequency, Hz", limits=(0.0, end)), y, (line,), tuple(orders))


def _spectrum_text(
    signal: Signal, frequency: FloatArray, amplitude: FloatArray, mesh: FloatArray, base: str
) -> str:
    peak = int(np.argmax(amplitude))
    low, high = number(mesh.min(), 3), number(mesh.max(), 3)
    runs = f"is {low} Hz" if low == high else f"runs from {low} to {high} Hz"
    return (
        f"The largest line is {number(amplitude[peak], 3)} {signal.unit} at "
        f"{number(frequency[peak], 4)} Hz; the {base} frequency {runs}."
    )


def _spectrum_table(signal: Signal, peaks: list[tuple[float, float]], base: str) -> Table:
    orders = enumerate(peaks, start=1)
    rows = tuple((str(order), number(hertz, 4), number(size, 3)) for order, (hertz, size) in orders)
    head = ("order", "frequency, Hz", f"amplitude, {signal.unit}")
    return Table(f"Largest line in the band of each {base} order", head, rows)


def octave_bands(run: RunResult, signal: Signal, blocks: Waterfall) -> Figure | None:
    """Draw the rms of each band over the whole run and in its loudest block; None where no band fits."""
    try:
        bands = third_octaves(blocks, float(run.receipt["sampling"]["pass_frequency"]))
    except InputError:  # the run is too short for a band
        return None
    rms = signal.magnitude(bands.rms)
    mean = np.sqrt(np.mean(rms**2, axis=0))
    maximum = np.max(rms, axis=0)
    floor = float(maximum.max()) * 10.0 ** (-DEPTH / 20.0)
    lines = (
        step_line("loudest block", bands.edges, decibels(maximum, floor), palette.VERMILLION),
        step_line("whole run", bands.edges, decibels(mean, floor), palette.BLUE),
    )
    unit = signal.quantity.unit
    worst = int(np.argmax(mean))
    names = tuple((float(at), _nominal(at)) for at in bands.nominal[bands.band % 3 == 0])
    x = Axis("nominal center of the band, Hz", "log", (float(bands.edges[0]), float(bands.edges[-1])), names)
    return Figure(
        key="octave_bands",
        title=f"One-third-octave levels of the {signal.name}",
        caption=f"Effective values in bands after IEC 61260-1, lines of blocks of "
        f"{number(1.0 / float(blocks.line[1]), 2)} s added in power: over the whole run, and the largest of "
        "any block.",
        alternative=f"The band at {_nominal(bands.nominal[worst])} Hz is the loudest over the run: "
        f"{number(mean[worst], 3)} {unit} rms.",
        content=(Panel(x, Axis(f"level, dB re 1 {unit} rms"), lines),),
        table=_band_table(bands, mean, maximum, unit),
    )


def _nominal(frequency: float) -> str:
    return f"{frequency:g}" if frequency < 1000.0 else f"{frequency / 1000.0:g}k"


def _band_table(bands: ThirdOctaves, mean: FloatArray, maximum: FloatArray, unit: str) -> Table:
    levels = zip(bands.nominal, mean, maximum, strict=True)
    rows = tuple((f"{hertz:g}", number(a, 3), number(b, 3)) for hertz, a, b in levels)
    head = ("band, Hz", f"whole run, {unit} rms", f"loudest block, {unit} rms")
    return Table("One-third-octave bands", head, rows)


def dynamic_error(run: RunResult, mesh: int = 0) -> Figure:
    """Draw three base pitches of both errors at each of several speeds that the run passes."""
    way = travel(run, mesh)
    windows = {speed: way.window(speed) for speed in window_speeds(way.speed_rpm)}
    errors = run.dynamic_transmission_error[mesh], run.static_transmission_error[mesh]
    swings = []
    for speed, window in windows.items():
        dynamic, static = (um(np.ptp(error[window])) for error in errors)
        swings.append(f"{dynamic} (static {static}) at {speed:g} rpm")
    return Figure(
        key="dynamic_error",
        title="Dynamic and static transmission error",
        caption="The static curve is the table at the nominal force and the same position; the dynamic one "
        "responds to its steps as an oscillating system.",
        alternative=f"Peak to peak in µm: {'; '.join(swings)}.",
        content=tuple(_error_panel(run, errors, way, *window) for window in windows.items()),
        table=_error_table(run, mesh, errors, windows),
    )


def _error_panel(
    run: RunResult, errors: tuple[FloatArray, FloatArray], way: Travel, speed: float, window: slice
) -> Panel:
    position = way.position[window] - np.floor(way.position[window][0] + 1e-6)  # from about zero on
    lines = (
        Line("dynamic", position, 1e6 * errors[0][window], palette.BLUE),
        Line("static", position, 1e6 * errors[1][window], palette.VERMILLION, "dash"),
    )
    passed = "" if is_steady(way.speed_rpm) else "passed "
    title = f"{number(speed, 3)} rpm, {passed}at {number(run.time[window].mean(), 3)} s"
    return Panel(_X, Axis("transmission error, µm"), lines, title=title)


def _error_table(
    run: RunResult, mesh: int, errors: tuple[FloatArray, FloatArray], windows: dict[float, slice]
) -> Table:
    """List mean and peak-to-peak of both errors, and the extremes of the mesh force, by speed."""
    rows = []
    for speed, window in windows.items():
        cells = []
        for error in errors:
            cells += [um(float(np.mean(error[window]))), um(float(np.ptp(error[window])))]
        least, largest = run.least_mesh_force[mesh, window].min(), run.largest_mesh_force[mesh, window].max()
        forces = (least, run.mesh_force[mesh, window].mean(), largest)
        rows.append((number(speed, 3), *cells, *(number(force, 4) for force in forces)))
    head = (
        "speed, rpm", "DTE mean, µm", "DTE peak to peak, µm", "STE mean, µm", "STE peak to peak, µm",
        "least mesh force, N", "mean mesh force, N", "largest mesh force, N",
    )  # fmt: skip
    return Table("Transmission error and mesh force by speed", head, tuple(rows))
