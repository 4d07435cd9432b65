"""Campbell diagram: amplitude over speed and frequency, with mesh orders and natural modes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dynamics.orders import Waterfall, frequency_waterfall, highest_valid_order
from dynamics.results import RunResult
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    Line,
    Note,
    Panel,
    number,
    unit_of,
)
from lineofaction.report.drawing.mode_lines import CAPTION, ModeLine, mode_lines, mode_table, whirling
from lineofaction.report.drawing.note_places import placed
from lineofaction.report.runs.level_map import level_map
from lineofaction.report.runs.run_series import validity
from lineofaction.report.runs.run_view import Signal, run_axis

BLOCKS, ORDERS = 90, 8
ORDER_COLOUR = "#9FB3C8"  # seen on the dark of the map and on paper


def frequency_blocks(run: RunResult, signal: Signal) -> Waterfall:
    """Return spectra over frequency of short blocks along the run."""
    block = 2.0 * float(run.time[-1]) / BLOCKS
    return frequency_waterfall(run, signal.quantity.series, block, 0.5, signal.mesh, signal.window)


def campbell(run: RunResult, signal: Signal, made: Waterfall) -> Figure:
    """Draw spectra of short blocks side by side."""
    amplitude = signal.amplitude(made.amplitude)
    axis, along = run_axis(run, made.time, signal.mesh)
    valid = highest_valid_order(run, signal.mesh)
    top = top_frequency(run, signal, made)
    modes = mode_lines(run, made.mesh_frequency, top)
    return Figure(
        key="campbell",
        title=f"Campbell diagram of the {signal.name}",
        caption="Color: amplitude of each block's spectrum, in dB below the largest. Dotted: "
        f"multiples of the mesh frequency. {CAPTION[whirling(run)]}, one for those that lie together. "
        f"{validity(valid, float(run.mesh_frequency[signal.mesh].max()))}",
        alternative=_words(signal, made, amplitude, (axis, along), modes),
        content=(_panel(made, amplitude, axis, along, top, modes),),
        table=mode_table(run, top, ORDERS),
    )


def top_frequency(run: RunResult, signal: Signal, made: Waterfall) -> float:
    """Return the upper end of the diagram, Hz: above the highest order that the run resolves."""
    last = max(min(ORDERS, highest_valid_order(run, signal.mesh)), 1)
    return min((last + 0.5) * float(made.mesh_frequency.max()), float(made.line[-1]))


def _panel(
    made: Waterfall, amplitude: FloatArray, axis: Axis, along: FloatArray, top: float, modes: list[ModeLine]
) -> Panel:
    """Colors, orders and modes."""
    shade = level_map(along, made.line, amplitude, top)
    ends = (float(shade.x[0]), float(shade.x[-1]))
    lines = [_order(made, along, order, top) for order in range(1, ORDERS + 1)]
    lines += [Line(mode.name, along, mode.frequency, mode.color, "dash", 1.4) for mode in modes]
    notes = [*_order_notes(made, along, top), *_mode_notes(along, modes)]
    x, y = Axis(axis.label, limits=ends), Axis("frequency, Hz", limits=(0.0, top))
    return Panel(x, y, tuple(lines), shade=shade, notes=placed(notes, x, y, (0.0, top)))


def _order(made: Waterfall, along: FloatArray, order: int, top: float) -> Line:
    """Draw a multiple of the mesh frequency."""
    height = order * made.mesh_frequency
    return Line("mesh orders", along, np.where(height <= top, height, np.nan), ORDER_COLOUR, "dot", 1.0)


def _order_notes(made: Waterfall, along: FloatArray, top: float) -> Iterator[Note]:
    """Name every order where it ends."""
    for order in range(1, ORDERS + 1):
        height = order * made.mesh_frequency
        last = int(np.argmax(np.where(height <= 0.97 * top, height, -1.0)))
        if 0.0 < height[last] <= top:
            yield Note(float(along[last]), float(height[last]), f"{order}×", left=True)


def _mode_notes(along: FloatArray, modes: list[ModeLine]) -> Iterator[Note]:
    """Name every mode where the run is slowest: what moves most, and its frequency there."""
    start = int(np.argmin(along))
    for mode in modes:
        at = float(mode.frequency[start])
        yield Note(float(along[start]), at, f"{mode.moves} {number(at, 4)} Hz")


def _words(
    signal: Signal,
    made: Waterfall,
    amplitude: FloatArray,
    over: tuple[Axis, FloatArray],
    modes: list[ModeLine],
) -> str:
    """Say where the largest amplitude is, and by which mode."""
    axis, along = over
    block, line = np.unravel_index(int(np.argmax(amplitude[:, 1:])), amplitude[:, 1:].shape)
    frequency = float(made.line[line + 1])
    order = frequency / float(made.mesh_frequency[block])
    where = f"at {number(float(along[block]), 3)} {unit_of(axis.label)}"
    text = (
        f"Largest: {number(float(amplitude[block, line + 1]), 3)} {signal.unit} at {number(frequency, 4)} Hz "
    )
    text += f"{where}, mesh order {number(order, 3)}."
    if modes:
        there = [float(mode.frequency[block]) for mode in modes]
        near = min(there, key=lambda value: abs(value - frequency))
        text += f" The nearest natural frequency is {number(near, 4)} Hz."
    return text
