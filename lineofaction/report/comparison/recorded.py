"""Comparison of a recording and a run: maps over mesh orders, levels of orders, differences in dB.

The *computed* side is the run, the *measured* side the recording. A waterfall has the spectrum of each of B
blocks along the run-up, over multiples of the mesh frequency.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from dynamics.errors import InputError
from dynamics.orders import PositionedSignal, Waterfall, recorded_waterfall
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.signals.channel import Channel, uniform_rate
from lineofaction.gearbox.signals.recording import Recording
from lineofaction.gearbox.signals.tacho import turns_of_pulses, turns_of_speed
from lineofaction.gearbox.signals.units import ACCELERATION, FORCE, LENGTH, SPEED
from lineofaction.gearbox.units import RPM
from lineofaction.report.comparison.level_differences import LevelDifference, level_differences, levels_table
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Dash, Figure, Line, Panel, category_lines, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.run.levels import (
    DEPTH,
    MAP_DEPTH,
    MAPPED,
    NAMED,
    OVERLAP,
    POINTS,
    SHORTEST,
    level_map,
)
from lineofaction.report.run.view import (
    SCALES,
    RunView,
    Signal,
    along_direction,
    decibels,
    selected_signal,
    speed_axis,
)

FIELD, TACHO = "measured", "tacho"
"""Fields of errors: the recording, and the channel of its speed."""
_QUANTITIES = {
    "bearing_acceleration": ACCELERATION,
    "bearing_force": FORCE,
    "mesh_force": FORCE,
    "dynamic_transmission_error": LENGTH,
}
"""Quantities of sensors by the series of a run that they measure."""
_DASHES: tuple[Dash, ...] = ("solid", "dash")
"""Lines of the computed and of the measured side."""
_ERRORS = {"bearing_force": "bearing_force_orders", "dynamic_transmission_error": "transmission_error_orders"}
"""Key of the errors by order in the receipt of a run, by the series of the run."""
_LEAD = (
    "levels over the speeds that both pass, less the noise beside each order; errors are those of the noise, "
    "two standard deviations, and of the steps of the run where it states them; those of sensors and tables "
    "are not in them"
)


@dataclass(frozen=True)
class Measurement:
    """Properties of a recording that its file does not state."""

    channel: str = ""
    """Name of the compared channel; empty: the only channel of the quantity."""
    unit: str = ""
    """Unit of the channel; empty: the unit in the file."""
    full_scale: float = 1.0
    """Value, in the unit, of 1 in the file, as the full scale of a WAV file."""
    tacho: str = ""
    """Name of the channel of the speed, or of the pulses of a tacho; empty: the only one."""
    tacho_unit: str = ""
    """Unit of that channel; empty: the unit in the file."""
    pulses_per_turn: float = 0.0
    """Pulses of a tacho per turn; 0: the channel is a speed."""
    rpm: float = 0.0
    """Constant speed of a recording without a tacho, rpm; 0: the recording has a channel of the speed."""
    ratio: float = 1.0
    """Speed of the driving gear over the speed of the recorded shaft."""


@dataclass(frozen=True)
class _Side:
    """A waterfall of a run or of a recording, in the unit of the signal."""

    name: str
    blocks: Waterfall
    speed: np.ndarray
    """Speed of the driving gear in each block, rad/s. Shape (B,)."""


def compare_recording(
    named: tuple[str, RunResult], recording: Recording, view: RunView, measurement: Measurement
) -> Page:
    """Compare a recording with a run, both through the same analysis.

    `named` is the run with its name. Raises `BadInput`: no channel measures the quantity of `view`, units or
    speeds are missing, `view` has no direction for a bearing, or run and recording share no speed.
    """
    name, run = named
    signal = selected_signal(run, view)
    channel, direction = _channel(recording, signal, measurement)
    signal = replace(signal, direction=_direction(signal, direction))
    teeth = _driver_teeth(run, signal.mesh)
    computed = _of_run(run, signal)
    measured = _of_channel(channel, recording, signal, measurement, teeth)
    sides = _sides((name, computed), (recording.name, measured), signal, teeth)
    orders = _orders(sides, signal)
    receipt = _receipt_errors(run, signal, orders)
    differences = level_differences((sides[0].blocks, sides[1].blocks), orders, receipt, OVERLAP)
    if not differences:
        spans = " and ".join(_span(side) for side in sides)
        bound = "a recording at speeds that the run passes too"
        raise BadInput.of(FIELD, spans, bound, "Simulate the speeds of the recording, or check --ratio.")
    return _page(sides, signal, differences)


def _channel(recording: Recording, signal: Signal, measurement: Measurement) -> tuple[Channel, str]:
    """Return the channel of the shown quantity, and the direction that its file states."""
    quantity = _QUANTITIES.get(signal.quantity.series)
    if quantity is None:
        bound = f"a quantity that sensors record: {', '.join(dict.fromkeys(_QUANTITIES))}"
        raise BadInput.of("quantity", signal.quantity.series, bound, "Name it by --quantity.")
    channel = recording.channel("channel", measurement.channel, (quantity,))
    return channel, channel.direction


def _direction(signal: Signal, declared: str) -> str:
    """Return the direction in which a bearing is compared, that of the sensor; empty for other parts."""
    if signal.quantity.part != "bearing":
        return ""
    if not (signal.direction or declared):
        remedy = "Say along which the sensor measures: --direction x."
        raise BadInput.of("direction", None, "x, y, z or principal beside a recording", remedy)
    return signal.direction or declared


def _driver_teeth(run: RunResult, mesh: int) -> int:
    driver = run.case["meshes"][mesh]["driver"]
    return next(int(gear["teeth"]) for gear in run.case["gears"] if gear["name"] == driver)


def _of_run(run: RunResult, signal: Signal) -> PositionedSignal:
    values = getattr(along_direction(run, signal), signal.quantity.series)[signal.row]
    position = np.abs(np.unwrap(run.position[signal.mesh], period=1.0))  # travel, base pitches
    values = signal.quantity.factor * (values[0] if values.ndim > 1 else values)
    # `accumulate`: the position of a signal must not fall
    return PositionedSignal(run.time, np.maximum.accumulate(position), values, signal.quantity.unit)


def _of_channel(
    channel: Channel, recording: Recording, signal: Signal, measurement: Measurement, teeth: int
) -> PositionedSignal:
    quantity = _QUANTITIES[signal.quantity.series]
    time, values = channel.measured("channel", quantity, measurement.unit)
    uniform_rate("channel", channel.name, time)
    position = teeth * measurement.ratio * _turns(channel, recording, measurement, time)
    inside = np.isfinite(position)  # NaN before the first pulse of a tacho and after the last
    values = signal.quantity.factor * measurement.full_scale * values
    return PositionedSignal(time[inside], position[inside], values[inside], signal.quantity.unit)


def _turns(channel: Channel, recording: Recording, measurement: Measurement, time: np.ndarray) -> np.ndarray:
    """Return the turns of the recorded shaft over time, from a constant speed, pulses or a speed channel."""
    if measurement.rpm:
        if measurement.tacho:
            raise BadInput.of("--rpm", measurement.rpm, "left out beside --tacho", "Keep one of them.")
        return np.asarray(RPM * measurement.rpm / (2.0 * np.pi) * (time - time[0]))
    others = replace(recording, channels=tuple(one for one in recording.channels if one is not channel))
    if measurement.pulses_per_turn:
        tacho = others.channel(TACHO, measurement.tacho, (SPEED,))
        return turns_of_pulses(TACHO, tacho, measurement.pulses_per_turn, time)
    if not measurement.tacho and not any(one.over == "time" for one in others.channels):
        remedy = "Give --rpm of a recording at one speed, or record a tacho."
        raise BadInput.of(TACHO, None, "a channel of the speed", remedy)
    tacho = others.channel(TACHO, measurement.tacho, (SPEED,))
    return turns_of_speed(TACHO, tacho, measurement.tacho_unit, time)


def _sides(
    computed: tuple[str, PositionedSignal], measured: tuple[str, PositionedSignal], signal: Signal, teeth: int
) -> tuple[_Side, _Side]:
    """Return the waterfalls of both sides, given as name and signal, with blocks of equal base pitches."""
    highest = max((*signal.orders, 1))
    if not signal.orders:
        highest = max(min(MAPPED, computed[1].highest_order, measured[1].highest_order), 1)
    pitches = max(SHORTEST, int(min(computed[1].travel, measured[1].travel) / POINTS))
    sides = []
    for name, series in (computed, measured):
        try:
            blocks = recorded_waterfall(series, pitches, highest, signal.window, OVERLAP)
        except InputError as error:
            raise BadInput.of(
                f"{name}: {error.field}", error.value, str(error.bound), str(error.suggestion)
            ) from None
        sides.append(_Side(name, blocks, 2.0 * np.pi * blocks.mesh_frequency / teeth))
    return sides[0], sides[1]


def _orders(sides: tuple[_Side, _Side], signal: Signal) -> tuple[int, ...]:
    return signal.orders or tuple(range(1, int(min(side.blocks.line[-1] for side in sides)) + 1))


def _receipt_errors(run: RunResult, signal: Signal, orders: tuple[int, ...]) -> dict[int, float]:
    """Return the stated errors of a run by order, peak in the signal's unit; 0 where it states none."""
    name = _ERRORS.get(signal.quantity.series, "")
    errors = [
        source[name]
        for source in run.receipt.get("error", {}).values()
        if isinstance(source, dict) and name in source
    ]
    return {
        # sources add as the root of the sum of squares; 0.0 for none at all
        order: signal.quantity.factor
        * math.hypot(*(source[order - 1] for source in errors if len(source) >= order), 0.0)
        for order in orders
    }


def _span(side: _Side) -> str:
    low, high = (number(value / RPM, 4) for value in (side.speed.min(), side.speed.max()))
    return f"{side.name} at {low} to {high} rpm"


def _page(sides: tuple[_Side, _Side], signal: Signal, differences: tuple[LevelDifference, ...]) -> Page:
    unit = signal.quantity.unit
    headlines = tuple(
        Headline(f"mesh order {one.order}", one.between(unit), one.finding) for one in differences
    )
    figures = (_levels(sides, signal, differences), _maps(sides, signal))
    table = levels_table(differences, (sides[0].name, sides[1].name), f"dB re 1 {unit} rms")
    lead = f"{signal.name}: {sides[0].name} computed, {sides[1].name} measured; {_LEAD}"
    title = f"{sides[0].name} and {sides[1].name} compared"
    return Page(title, lead, headlines, (Section(signal.heading, figures=figures, tables=(table,)),))


def _levels(sides: tuple[_Side, _Side], signal: Signal, differences: tuple[LevelDifference, ...]) -> Figure:
    """Draw the levels of the loudest orders of both over speed."""
    orders = sorted(one.order for one in sorted(differences, key=lambda one: -one.levels[0])[:NAMED])
    scale = SCALES[signal.scale]
    top = scale * max(float(side.blocks.amplitude[:, 1:].max()) for side in sides)
    floor = top * 10.0 ** (-DEPTH / 20.0)  # least drawn amplitude, `DEPTH` dB below the largest
    lines: list[Line] = []
    for side, dash in zip(sides, _DASHES, strict=True):
        axis, along = speed_axis(side.blocks.time, side.speed)
        names = [f"{order}×, {side.name}" for order in orders]
        cuts = [decibels(scale * side.blocks.cut(order), floor) for order in orders]
        overall = decibels(side.blocks.rms, floor)
        lines += [Line(f"overall, {side.name}", along, overall, palette.INK, dash, 2.2)]
        lines += category_lines(along, names, cuts, dash=dash)
    largest = max(differences, key=lambda one: abs(one.value) if one.is_seen else 0.0)
    difference = f"mesh order {largest.order}, {largest.between(signal.quantity.unit)}"
    return Figure(
        key="levels",
        title=f"Levels of mesh orders of the {signal.name}",
        caption=f"Solid: {sides[0].name}, computed. Dash: {sides[1].name}, measured. Overall: rms. Orders: "
        f"{signal.scale} values, with the noise on their lines.",
        alternative=f"Largest difference: {difference}.",
        content=(Panel(axis, Axis(f"level, dB re 1 {signal.unit}"), tuple(lines)),),
    )


def _maps(sides: tuple[_Side, _Side], signal: Signal) -> Figure:
    """Draw both waterfalls one above the other, each in dB below its largest line."""
    panels = []
    for side, kind in zip(sides, ("computed", "measured"), strict=True):
        axis, along = speed_axis(side.blocks.time, side.speed)
        last = float(side.blocks.line[-1])
        shade = level_map(along, side.blocks.line, SCALES[signal.scale] * side.blocks.amplitude, last)
        names = tuple((float(order), f"{order}×") for order in range(1, int(last) + 1))
        x, y = Axis.over(axis.label, shade.x), Axis("mesh order", limits=(0.0, last), names=names)
        panels.append(Panel(x, y, title=f"{side.name}, {kind}", shade=shade))
    largest = [SCALES[signal.scale] * float(side.blocks.amplitude[:, 1:].max()) for side in sides]
    peaks = [
        f"{side.name} {number(value, 3)} {signal.unit}" for side, value in zip(sides, largest, strict=True)
    ]
    return Figure(
        key="order_maps",
        title=f"Order maps of the {signal.name}",
        caption=f"Color: {signal.scale} amplitude over mesh orders in dB below the largest of each map, down "
        f"to −{MAP_DEPTH:g} dB.",
        alternative=f"Largest lines: {', '.join(peaks)}.",
        content=tuple(panels),
    )
