"""Campbell diagram: amplitude over speed and frequency, with mesh orders and natural modes."""

from __future__ import annotations

import numpy as np

from dynamics.orders import Waterfall, frequency_waterfall, highest_valid_order
from dynamics.results import RunResult
from service.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    HeatMap,
    Line,
    Panel,
    Reference,
    number,
    unit_of,
)
from service.drawing.mode_lines import CAPTION, ModeLine, mode_lines, mode_table, whirling
from service.runs.run_series import validity
from service.runs.run_signal import run_axis, shown_signal

BLOCKS, LINES, ORDERS, DEPTH = 90, 220, 8, 60.0
ORDER_COLOUR = "#9FB3C8"  # seen on the dark of the map and on paper


def campbell(run: RunResult) -> Figure:
    """Draw spectra of short blocks side by side."""
    signal = shown_signal(run)
    made = frequency_waterfall(run, signal.series, 2.0 * float(run.time[-1]) / BLOCKS)
    amplitude = signal.of(made.amplitude)
    axis, along = run_axis(run, made.time)
    valid = highest_valid_order(run)
    last = max(min(ORDERS, valid), 1)
    top = min((last + 0.5) * float(made.mesh_frequency.max()), float(made.line[-1]))
    modes = mode_lines(run, made.mesh_frequency, top)
    return Figure(
        key="campbell",
        title=f"Campbell diagram of the {signal.name}",
        caption="Color: amplitude of each block's spectrum (Hann window), in dB below the largest. Dotted: "
        f"multiples of the mesh frequency. {CAPTION[whirling(run)]}, one for those that lie together. "
        f"{validity(valid, float(run.mesh_frequency[0].max()))}",
        alternative=_words(made, amplitude, along, axis, modes),
        content=(_panel(made, amplitude, axis, along, top, modes),),
        table=mode_table(run, top, ORDERS),
    )


def _panel(
    made: Waterfall, amplitude: FloatArray, axis: Axis, along: FloatArray, top: float, modes: list[ModeLine]
) -> Panel:
    """Colors, orders and modes."""
    shade = _shade(made, amplitude, along, top)
    ends = (float(shade.x[0]), float(shade.x[-1]))
    lines = []
    for order in range(1, ORDERS + 1):
        height = order * made.mesh_frequency
        seen = np.where(height <= top, height, np.nan)
        lines.append(Line("mesh orders", along, seen, ORDER_COLOUR, "dot", 1.0))
    marks = []
    flat = all(float(np.ptp(mode.frequency)) == 0.0 for mode in modes)
    for index, mode in enumerate(modes):
        lines.append(Line(mode.name, along, mode.frequency, mode.color, "dash", 1.4))
        if flat:
            level = float(mode.frequency[0])
            marks.append(
                Reference(f"{number(level, 4)} Hz", level, "horizontal", 0.99 if index % 2 else 0.12)
            )
    x = Axis(axis.label, limits=ends)
    return Panel(x, Axis("frequency, Hz", limits=(0.0, top)), tuple(lines), tuple(marks), shade=shade)


def _shade(made: Waterfall, amplitude: FloatArray, along: FloatArray, top: float) -> HeatMap:
    """Levels on an even grid of the axis; the loudest of the lines that fall into one cell."""
    kept = np.flatnonzero((made.line > 0.0) & (made.line <= top))
    group = max(int(np.ceil(kept.size / LINES)), 1)
    kept = kept[: kept.size // group * group]
    rows = amplitude[:, kept].reshape(amplitude.shape[0], -1, group).max(axis=-1)
    order = np.argsort(along)
    even = np.linspace(along.min(), along.max(), along.size)
    middle = 0.5 * (along[order][1:] + along[order][:-1])
    columns = rows[order][np.searchsorted(middle, even)]
    level = 20.0 * np.log10(np.maximum(columns / max(float(columns.max()), 1e-300), 1e-12))
    z = np.clip(level + DEPTH, 0.0, None).T
    height = made.line[kept].reshape(-1, group).mean(axis=-1)
    return HeatMap(even, height, z, f"level above −{DEPTH:g} dB of the largest, dB", DEPTH)


def _words(
    made: Waterfall, amplitude: FloatArray, along: FloatArray, axis: Axis, modes: list[ModeLine]
) -> str:
    """Say where the largest amplitude is, and by which mode."""
    block, line = np.unravel_index(int(np.argmax(amplitude[:, 1:])), amplitude[:, 1:].shape)
    frequency = float(made.line[line + 1])
    order = frequency / float(made.mesh_frequency[block])
    where = f"at {number(float(along[block]), 3)} {unit_of(axis.label)}"
    text = (
        f"Largest: {number(float(amplitude[block, line + 1]), 3)} {made.unit} at {number(frequency, 4)} Hz "
    )
    text += f"{where}, mesh order {number(order, 3)}."
    if modes:
        there = [float(mode.frequency[block]) for mode in modes]
        near = min(there, key=lambda value: abs(value - frequency))
        text += f" The nearest natural frequency is {number(near, 4)} Hz."
    return text
