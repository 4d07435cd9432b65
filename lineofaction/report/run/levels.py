"""Levels of a run over its speed: orders, maps, the Campbell diagram and its modes, the loudest moment."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from dynamics.orders import Waterfall, frequency_waterfall, highest_valid_order, order_waterfall
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.studies.listen.run import PRINCIPAL
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import (
    Axis,
    Figure,
    FloatArray,
    HeatMap,
    Line,
    Note,
    Panel,
    Table,
    category_lines,
    number,
    unit_of,
)
from lineofaction.report.drawing.placing import named_along, stacked
from lineofaction.report.response.mode_lines import (
    MODES_CAPTION,
    ModeLine,
    mode_bars,
    mode_lines,
    mode_table,
    whirling,
)
from lineofaction.report.run.view import SCALES, Signal, along_direction, decibels, run_axis, validity

LINES = 220
"""Largest number of lines of a map over its height."""
MAP_DEPTH, DEPTH = 60.0, 80.0
"""Ranges of levels below the largest one in maps and in curves, dB."""
POINTS, SHORTEST, OVERLAP = 400, 16, 0.75
"""Blocks of orders: their usual number, their least length in base pitches, and their overlap."""
MAPPED, NAMED = 10, 5
"""Numbers of mesh orders in an order map, and of order cuts where the caller names none."""
BLOCKS, ORDERS = 90, 8
"""Numbers of blocks and of mesh orders of a Campbell diagram."""
ORDER_COLOUR = "#9FB3C8"  # seen on the dark of the map and on paper
MIN_PITCHES = 64  # least base pitches of a run whose orders are shown


def level_map(along: FloatArray, line: FloatArray, amplitude: FloatArray, top: float) -> HeatMap:
    """Return levels relative to the largest one on a grid; a cell has the largest amplitude of its lines.

    Parameters
    ----------
    along : (B,) array
        Speed or time of the blocks, rising or falling.
    line : (K,) array
        Frequencies or orders at equal steps from 0; those above 0 and up to `top` are drawn.
    amplitude : (B, K) array
        Amplitude of each line of each block.
    """
    drawn = np.flatnonzero((line > 0.0) & (line <= top))
    group = max(int(np.ceil(drawn.size / LINES)), 1)  # lines in a cell
    drawn = drawn[: drawn.size // group * group]
    rows = amplitude[:, drawn].reshape(amplitude.shape[0], -1, group).max(axis=-1)
    order = np.argsort(along)
    even = np.linspace(along.min(), along.max(), along.size)
    middle = 0.5 * (along[order][1:] + along[order][:-1])
    columns = rows[order][np.searchsorted(middle, even)]  # of the nearest block
    level = 20.0 * np.log10(np.maximum(columns / max(float(columns.max()), 1e-300), 1e-12))
    z = np.clip(level + MAP_DEPTH, 0.0, None).T
    height = line[drawn].reshape(-1, group).mean(axis=-1)
    return HeatMap(even, height, z, f"level above −{MAP_DEPTH:g} dB of the largest, dB", MAP_DEPTH)


def _pitches_passed(run: RunResult, mesh: int) -> float:
    """Return the number of base pitches that a mesh passes; 0: the run has no meshes."""
    return float(np.ptp(np.unwrap(run.position[mesh], period=1.0))) if run.mesh else 0.0


def order_blocks(run: RunResult, signal: Signal) -> Waterfall:
    """Return spectra over mesh orders in blocks of whole base pitches along the run.

    Raises `BadInput`: the run has no mesh, or is shorter than one block.
    """
    highest = max((*signal.orders, min(MAPPED, highest_valid_order(run, signal.mesh)), 1))
    travel = _pitches_passed(run, signal.mesh)
    if travel < SHORTEST:
        bound = f"at least {SHORTEST} base pitches of a mesh, in which its orders are counted"
        raise BadInput.of("run", f"{travel:.4g} base pitches", bound, "Simulate a longer one.")
    pitches = max(SHORTEST, int(travel / POINTS))
    return order_waterfall(run, signal.quantity.series, pitches, highest, signal.mesh, signal.window, OVERLAP)


def levels_over_speed(run: RunResult, signal: Signal, blocks: Waterfall) -> Figure:
    """Draw the overall level and the levels of mesh orders over speed or time, in dB re one unit."""
    axis, abscissa = run_axis(run, blocks.time, signal.mesh)
    orders = signal.orders or largest_orders(signal, blocks)
    cuts = {order: signal.amplitude(blocks.cut(order)) for order in orders}
    overall = signal.magnitude(blocks.rms)
    largest = max(float(overall.max()), *(float(cut.max()) for cut in cuts.values()))
    floor = largest * 10.0 ** (-DEPTH / 20.0)
    names = [f"{order}×" for order in cuts]
    lines = (
        Line("overall, rms", abscissa, decibels(overall, floor), palette.INK, width=2.2),
        *category_lines(abscissa, names, (decibels(cut, floor) for cut in cuts.values())),
    )
    level = Axis(f"level, dB re 1 {signal.unit}")
    valid = highest_valid_order(run, signal.mesh)
    top = float(run.mesh_frequency[signal.mesh].max())
    return Figure(
        key="levels",
        title=f"Overall level and mesh orders of the {signal.name}",
        caption="Overall: rms about the mean in blocks of whole base pitches. Orders: "
        f"{signal.scale} values of those named, or of the {NAMED} largest, resampled to equal steps of "
        f"position. {validity(valid, top)}",
        alternative=_alternative(signal, blocks, abscissa, unit_of(axis.label)),
        content=(Panel(axis, level, lines),),
        table=_table(signal, blocks, overall, cuts, axis.label, abscissa),
    )


def largest_orders(signal: Signal, blocks: Waterfall) -> tuple[int, ...]:
    """Return the orders with the largest peaks over the run, in their order."""
    orders = range(1, int(blocks.line[-1]) + 1)
    largest = sorted(orders, key=lambda order: -float(signal.magnitude(blocks.cut(order)).max()))
    return tuple(sorted(largest[:NAMED]))


def _alternative(signal: Signal, blocks: Waterfall, along: FloatArray, unit: str) -> str:
    overall = signal.magnitude(blocks.rms)
    worst = int(np.argmax(overall))
    orders = range(1, int(blocks.line[-1]) + 1)
    power = {order: 0.5 * float(signal.magnitude(blocks.cut(order))[worst]) ** 2 for order in orders}
    order = max(power, key=lambda key: power[key])
    share = min(power[order] / max(float(overall[worst]) ** 2, 1e-300), 1.0)
    return (
        f"Loudest at {number(along[worst], 3)} {unit}: {number(overall[worst], 3)} "
        f"{signal.quantity.unit} rms, {number(100.0 * share, 2)} % of its power at mesh order {order}."
    )


def _table(
    signal: Signal,
    blocks: Waterfall,
    overall: FloatArray,
    cuts: dict[int, FloatArray],
    label: str,
    abscissa: FloatArray,
) -> Table:
    rows = []
    for order, values in ({0: overall} | cuts).items():  # 0: all orders together
        at = int(np.argmax(values))
        name = f"{order}×" if order else "overall, rms"
        level = f"{20.0 * np.log10(max(float(values[at]), 1e-300)):.1f}"
        hertz = number(order * blocks.mesh_frequency[at], 4) if order else ""
        rows.append((name, number(values[at], 4), level, number(abscissa[at], 4), hertz))
    head = ("mesh order", f"largest, {signal.unit}", "dB", label, "frequency, Hz")
    return Table("Largest value of each line", head, tuple(rows))


def order_map(run: RunResult, signal: Signal, blocks: Waterfall) -> Figure:
    """Draw spectra over mesh orders side by side: a component of the mesh is a horizontal line."""
    valid = highest_valid_order(run, signal.mesh)
    last = max(min(MAPPED, valid), 1)
    amplitude = signal.amplitude(blocks.amplitude)[:, blocks.line <= last]
    axis, along = run_axis(run, blocks.time, signal.mesh)
    shade = level_map(along, blocks.line[blocks.line <= last], amplitude, float(last))
    names = tuple((float(order), f"{order}×") for order in range(1, last + 1))
    orders = Axis("mesh order", limits=(0.0, float(blocks.line[-1])), names=names)
    block, line = np.unravel_index(int(np.argmax(amplitude[:, 1:])), amplitude[:, 1:].shape)
    largest = number(amplitude[block, line + 1], 3)
    where = f"{number(along[block], 3)} {unit_of(axis.label)}"
    return Figure(
        key="order_map",
        title=f"Order map of the {signal.name}",
        caption=f"Color: {signal.scale} amplitude of each block's spectrum over mesh orders, in dB below the "
        f"largest, down to −{MAP_DEPTH:g} dB. "
        f"{validity(valid, float(run.mesh_frequency[signal.mesh].max()))}",
        alternative=f"Largest: {largest} {signal.unit} at order "
        f"{number(blocks.line[line + 1], 4)} and {where}.",
        content=(Panel(Axis.over(axis.label, shade.x), orders, shade=shade),),
    )


def frequency_blocks(run: RunResult, signal: Signal) -> Waterfall:
    """Return spectra over frequency of short blocks along the run."""
    block = 2.0 * float(run.time[-1]) / BLOCKS
    return frequency_waterfall(run, signal.quantity.series, block, 0.5, signal.mesh, signal.window)


def campbell(run: RunResult, signal: Signal, blocks: Waterfall) -> Figure:
    """Draw spectra of short blocks side by side."""
    amplitude = signal.amplitude(blocks.amplitude)
    axis, along = run_axis(run, blocks.time, signal.mesh)
    valid = highest_valid_order(run, signal.mesh)
    top = _top_frequency(run, signal, blocks)
    modes = mode_lines(run, blocks.mesh_frequency, top)
    return Figure(
        key="campbell",
        title=f"Campbell diagram of the {signal.name}",
        caption="Color: amplitude of each block's spectrum, in dB below the largest. Dotted: "
        f"multiples of the mesh frequency. {MODES_CAPTION[whirling(run)]}, one for those that lie together. "
        f"{validity(valid, float(run.mesh_frequency[signal.mesh].max()))}",
        alternative=_campbell_text(signal, blocks, amplitude, (axis, along), modes),
        content=(_panel(blocks, amplitude, axis, along, top, modes),),
        table=mode_table(run, top, ORDERS),
    )


def _top_frequency(run: RunResult, signal: Signal, blocks: Waterfall) -> float:
    """Return the upper end of the diagram, Hz, half an order above the highest valid one."""
    last = max(min(ORDERS, highest_valid_order(run, signal.mesh)), 1)
    return min((last + 0.5) * float(blocks.mesh_frequency.max()), float(blocks.line[-1]))


def _panel(
    blocks: Waterfall, amplitude: FloatArray, axis: Axis, along: FloatArray, top: float, modes: list[ModeLine]
) -> Panel:
    shade = level_map(along, blocks.line, amplitude, top)
    heights = (order * blocks.mesh_frequency for order in range(1, ORDERS + 1))
    visible = (np.where(height <= top, height, np.nan) for height in heights)
    lines = [Line("mesh orders", along, height, ORDER_COLOUR, "dot", 1.0) for height in visible]
    lines += [Line(mode.name, along, mode.frequency, mode.color, "dash", 1.4) for mode in modes]
    x, y = Axis.over(axis.label, shade.x), Axis("frequency, Hz", limits=(0.0, top))
    edge = int(np.argmin(along))
    names = [_mode_note(mode, edge, along) for mode in modes]
    labels = stacked(names, x, y)
    orders = named_along([*_named_orders(blocks, along, top)], x, y, labels)
    return Panel(x, y, tuple(lines), shade=shade, notes=(*labels, *orders))


def _mode_note(mode: ModeLine, edge: int, along: FloatArray) -> Note:
    """Return the name of a mode where its line begins, at the block `edge`."""
    hertz = float(mode.frequency[edge])
    return Note(float(along[edge]), hertz, f"{mode.moves} {number(hertz, 4)} Hz", color=mode.color)


def _named_orders(
    blocks: Waterfall, along: FloatArray, top: float
) -> Iterator[tuple[str, FloatArray, FloatArray]]:
    """Yield the names of the orders and their points below the top, from the highest frequency down."""
    for order in range(1, ORDERS + 1):
        height = order * blocks.mesh_frequency
        visible = np.flatnonzero((height > 0.0) & (height <= 0.97 * top))
        points = visible[np.lexsort((-along[visible], -height[visible]))]
        yield f"{order}×", along[points], height[points]


def _campbell_text(
    signal: Signal,
    blocks: Waterfall,
    amplitude: FloatArray,
    abscissa: tuple[Axis, FloatArray],
    modes: list[ModeLine],
) -> str:
    axis, along = abscissa
    block, line = np.unravel_index(int(np.argmax(amplitude[:, 1:])), amplitude[:, 1:].shape)
    frequency = float(blocks.line[line + 1])
    order = frequency / float(blocks.mesh_frequency[block])
    where = f"at {number(along[block], 3)} {unit_of(axis.label)}"
    text = f"Largest: {number(amplitude[block, line + 1], 3)} {signal.unit} at {number(frequency, 4)} Hz "
    text += f"{where}, mesh order {number(order, 3)}."
    if modes:
        frequencies = [float(mode.frequency[block]) for mode in modes]
        nearest = min(frequencies, key=lambda value: abs(value - frequency))
        text += f" The nearest natural frequency is {number(nearest, 4)} Hz."
    return text


def mode_shares(run: RunResult, signal: Signal, blocks: Waterfall) -> Figure | None:
    """Draw the shares of the parts in the kinetic energy of each mode of the diagram; None without modes."""
    modes = mode_lines(run, blocks.mesh_frequency, _top_frequency(run, signal, blocks))
    with_shares = [mode for mode in modes if mode.shares]
    if not with_shares:
        return None
    names = [f"{number(mode.frequency[0], 4)} Hz" for mode in with_shares]
    where = "whirl modes at the highest speed of the run" if whirling(run) else "natural modes"
    part, share = max(with_shares[0].shares.items(), key=lambda item: item[1])
    return Figure(
        key="mode_shares",
        title="What moves in the modes of the Campbell diagram",
        caption=f"Kinetic energy of the {where} by shaft and kind of motion, named by their frequency "
        "at the start of the run. Parts below a twentieth are among the others.",
        alternative=f"In the lowest mode, {names[0]}, {number(100.0 * share, 2)} % of the kinetic energy are "
        f"of {part}.",
        content=(mode_bars(names, [mode.shares for mode in with_shares], "kinetic energy"),),
    )


@dataclass(frozen=True)
class Loudest:
    """The block of a run with the highest overall level."""

    axis: Axis
    """Axis of speed or time."""
    where: float
    """Position of the block on this axis."""
    time: float
    """Time of the block, s."""
    overall: float
    """Root mean square about the mean, in the unit of the signal."""
    orders: dict[int, float]
    """Root mean square of the mesh orders that the view names, or of the largest orders of the run."""


def has_orders(run: RunResult, mesh: int = 0) -> bool:
    """Whether a run passes enough base pitches for orders over it."""
    return _pitches_passed(run, mesh) >= MIN_PITCHES


def loudest(run: RunResult, signal: Signal) -> Loudest | None:
    """Return the block of a run in which its signal is loudest; None: the run has no orders.

    Raises `BadInput`: the signal does not vary.
    """
    if not has_orders(run, signal.mesh):
        return None
    if signal.quantity.part == "bearing" and not signal.direction:
        signal = replace(signal, direction=PRINCIPAL)
    component = along_direction(run, signal)
    blocks = order_blocks(component, signal)
    axis, along = run_axis(component, blocks.time, signal.mesh)
    overall = signal.magnitude(blocks.rms)
    worst = int(np.argmax(overall))
    orders = signal.orders or largest_orders(signal, blocks)
    cuts = {order: float(signal.magnitude(blocks.cut(order))[worst]) for order in orders}
    rms = {order: SCALES["rms"] * cut for order, cut in cuts.items()}
    return Loudest(axis, float(along[worst]), float(blocks.time[worst]), float(overall[worst]), rms)
