"""Runs against each other, and against a measured order spectrum."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dynamics.orders import Waterfall
from dynamics.results import RunResult
from fe_contact.types import Estimate
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.comparison.difference import COLORS, Difference, changed_fields, differences_table
from lineofaction.report.comparison.measured import MeasuredOrders
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Dash, Figure, Line, Panel, number
from lineofaction.report.drawing.page import Headline, Page, Section
from lineofaction.report.runs.levels_over_speed import DEPTH, largest_orders, order_blocks
from lineofaction.report.runs.run_view import (
    SCALES,
    RunView,
    Signal,
    decibels,
    run_axis,
    same_view,
    shown_signal,
)
from lineofaction.report.runs.signal_recording import along_direction
from lineofaction.report.runs.signal_spectrum import ORDERS, amplitude_spectrum, spectrum_window
from lineofaction.report.runs.sound import Heard, sound_of

_DASHES: tuple[Dash, ...] = ("solid", "dash")
_ERRORS = {"bearing_force": "bearing_force_orders", "dynamic_transmission_error": "transmission_error_orders"}
"""Series whose orders have stated errors, and their name in the receipt of a run."""


@dataclass(frozen=True)
class _Side:
    """One of the runs: name, what is shown of it, the run along its direction, blocks over mesh orders."""

    name: str
    run: RunResult
    signal: Signal
    seen: RunResult
    blocks: Waterfall


def compare_runs(runs: dict[str, RunResult], view: RunView, measured: MeasuredOrders | None) -> Page:
    """Put the comparison of runs together; the second shows what the first one does.

    Parameters
    ----------
    runs : dict of str to RunResult
        Two by their names, or one with what was measured.
    view : RunView
    measured : MeasuredOrders or None

    Raises
    ------
    BadInput
        A run does not hold what the view names, or the measured orders are in another unit.
    """
    sides = tuple(_sides(runs, view))
    signal = sides[0].signal
    highest = int(min(side.blocks.line[-1] for side in sides))
    chosen = signal.orders or largest_orders(signal, sides[0].blocks)
    orders = tuple(order for order in chosen if order <= highest)
    found = tuple(_differences(sides, orders)) if len(sides) == 2 else ()
    figures = (_levels(sides, orders), _spectra(sides, measured))
    listed = (differences_table(found, tuple(runs)),) if found else ()
    sections = [Section(signal.heading, figures=figures, tables=listed)]
    differing = changed_fields({name: run.case for name, run in runs.items()})
    if differing.rows:
        sections.append(Section("Scenes", tables=(differing,)))
    headlines = tuple(Headline(one.name, one.written, one.finding) for one in found[:3])
    lead = f"{signal.name}; {', '.join(f'{run.time[-1]:g} s' for run in runs.values())} of motion"
    return Page(f"{' and '.join(runs)} compared", lead, headlines, tuple(sections))


def _sides(runs: dict[str, RunResult], view: RunView) -> Iterator[_Side]:
    """Yield every run with what is shown of it."""
    for name, run in runs.items():
        try:
            signal = shown_signal(run, view)
        except BadInput as error:
            raise error.within(name) from None
        seen = along_direction(run, signal)
        yield _Side(name, run, signal, seen, order_blocks(seen, signal))
        view = same_view(view, signal)


def _differences(sides: tuple[_Side, ...], orders: tuple[int, ...]) -> Iterator[Difference]:
    """Yield the largest overall value and that of every order, each wherever in the run it is."""
    first, second = (_overall(side) for side in sides)
    yield Difference("overall", "its largest", first, second)
    for order in orders:
        first, second = (_order(side, order) for side in sides)
        yield Difference(f"mesh order {order}", "its largest", first, second)


def _overall(side: _Side) -> Estimate:
    """Return the largest overall rms; its error is not stated."""
    largest = float(side.signal.magnitude(side.blocks.rms).max())
    return Estimate(largest, math.nan, f"{side.signal.quantity.unit} rms")


def _order(side: _Side, order: int) -> Estimate:
    """Return the largest amplitude of an order with the error that the receipt states."""
    name = _ERRORS.get(side.signal.quantity.series, "")
    sources = [
        source[name][order - 1]
        for source in side.run.receipt.get("error", {}).values()
        if isinstance(source, dict) and len(source.get(name, ())) >= order
    ]
    factor = side.signal.quantity.factor * SCALES[side.signal.scale]
    error = factor * math.hypot(*sources) if sources else math.nan
    return Estimate(float(side.signal.amplitude(side.blocks.cut(order)).max()), error, side.signal.unit)


def _levels(sides: tuple[_Side, ...], orders: tuple[int, ...]) -> Figure:
    """Draw overall level and orders over speed."""
    overall = [side.signal.magnitude(side.blocks.rms) for side in sides]
    floor = max(float(values.max()) for values in overall) * 10.0 ** (-DEPTH / 20.0)
    lines = []
    for side, values, dash in zip(sides, overall, _DASHES, strict=False):
        axis, along = run_axis(side.run, side.blocks.time, side.signal.mesh)
        lines.append(Line(f"overall, {side.name}", along, decibels(values, floor), palette.INK, dash, 2.2))
        for index, order in enumerate(orders):
            level = decibels(side.signal.amplitude(side.blocks.cut(order)), floor)
            lines.append(Line(f"{order}×, {side.name}", along, level, palette.category(index), dash, 1.4))
    signal = sides[0].signal
    change = 20.0 * math.log10(float(overall[-1].max()) / float(overall[0].max()))
    styles = ". ".join(
        f"{dash.capitalize()}: {side.name}" for side, dash in zip(sides, _DASHES, strict=False)
    )
    return Figure(
        key="levels",
        title=f"Overall level and mesh orders of the {signal.name}",
        caption=f"{styles}. Overall: rms. Orders: {signal.scale} values.",
        alternative=f"The largest overall level changes by {change:+.1f} dB." if len(sides) == 2 else "",
        content=(Panel(axis, Axis(f"level, dB re 1 {signal.unit}"), tuple(lines)),),
        sound=sound_of(tuple(Heard(side.name, side.run, side.signal) for side in sides), axis),
    )


def _spectra(sides: tuple[_Side, ...], measured: MeasuredOrders | None) -> Figure:
    """Draw the spectra near the end of the runs over mesh order."""
    lines = []
    for side, color in zip(sides, COLORS, strict=False):
        window = spectrum_window(side.run.time)
        frequency, amplitude = amplitude_spectrum(side.seen, side.signal, window)
        order = frequency / float(np.median(side.run.mesh_frequency[side.signal.mesh, window]))
        shown = order <= ORDERS + 0.5
        lines.append(Line(side.name, order[shown], np.maximum(amplitude[shown], 1e-12), color, width=1.2))
    signal = sides[0].signal
    caption = "90 to 95 % of the duration, over multiples of the mesh frequency in its middle; "
    caption += f"{signal.scale} values."
    if measured is not None:
        measured.require(signal.quantity.unit)
        shown = measured.order <= ORDERS + 0.5
        drawn = measured.order[shown], measured.amplitude[shown]
        lines.append(Line("measured", *drawn, palette.INK, "dash", 1.2))
        caption += " Measured: as read."
    top = max(float(line.y.max()) for line in lines)
    peaks = [
        f"{line.name} {number(float(line.y.max()), 3)} at order {float(line.x[np.argmax(line.y)]):.2f}"
        for line in lines
    ]
    y = Axis(f"amplitude, {signal.unit}", "log", (1e-5 * top, 3.0 * top))
    return Figure(
        key="spectra",
        title=f"Spectra of the {signal.name} near the end of the runs",
        caption=caption,
        alternative=f"Largest lines, {signal.unit}: {'; '.join(peaks)}.",
        content=(Panel(Axis("mesh order", limits=(0.0, ORDERS + 0.5)), y, tuple(lines)),),
    )
