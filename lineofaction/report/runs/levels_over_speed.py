"""Overall level and order cuts over a run."""

from __future__ import annotations

import numpy as np

from dynamics.orders import Waterfall, highest_valid_order, order_waterfall
from dynamics.results import RunResult
from lineofaction.gearbox.problems import BadInput
from lineofaction.report.drawing import palette
from lineofaction.report.drawing.figure import Axis, Figure, FloatArray, Line, Panel, Table, number, unit_of
from lineofaction.report.runs.run_series import validity
from lineofaction.report.runs.run_view import Signal, decibels, run_axis

POINTS, SHORTEST, OVERLAP, DEPTH = 400, 16, 0.75, 80.0
MAPPED, NAMED = 10, 5
"""Mesh orders of an order map, as far as the output holds them, and how many of them are cut unless named."""


def pitches_passed(run: RunResult, mesh: int = 0) -> float:
    """Return how many base pitches a mesh passes; 0 of a run without meshes."""
    return float(np.ptp(np.unwrap(run.position[mesh], period=1.0))) if run.mesh else 0.0


def order_blocks(run: RunResult, signal: Signal) -> Waterfall:
    """Return spectra over mesh orders in blocks of whole base pitches along the run.

    Raises
    ------
    BadInput
        It has no mesh, or is shorter than one block.
    """
    highest = max((*signal.orders, min(MAPPED, highest_valid_order(run, signal.mesh)), 1))
    travel = pitches_passed(run, signal.mesh)
    if travel < SHORTEST:
        bound = f"at least {SHORTEST} base pitches of a mesh, in which its orders are counted"
        raise BadInput.of("run", f"{travel:.4g} base pitches", bound, "Simulate a longer one.")
    pitches = max(SHORTEST, int(travel / POINTS))
    return order_waterfall(run, signal.quantity.series, pitches, highest, signal.mesh, signal.window, OVERLAP)


def levels_over_speed(run: RunResult, signal: Signal, made: Waterfall) -> Figure:
    """Draw the overall level and the levels of mesh orders over speed or time, in dB re one unit."""
    axis, abscissa = run_axis(run, made.time, signal.mesh)
    cuts = {
        order: signal.amplitude(made.cut(order)) for order in signal.orders or largest_orders(signal, made)
    }
    overall = signal.magnitude(made.rms)
    largest = max(float(overall.max()), *(float(cut.max()) for cut in cuts.values()))
    floor = largest * 10.0 ** (-DEPTH / 20.0)
    lines = (
        Line("overall, rms", abscissa, decibels(overall, floor), palette.INK, width=2.2),
        *(
            Line(f"{order}×", abscissa, decibels(cut, floor), palette.category(index), width=1.4)
            for index, (order, cut) in enumerate(cuts.items())
        ),
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
        alternative=_words(signal, made, abscissa, unit_of(axis.label)),
        content=(Panel(axis, level, lines),),
        table=_table(signal, made, overall, cuts, (axis, abscissa)),
    )


def largest_orders(signal: Signal, made: Waterfall) -> tuple[int, ...]:
    """Return the orders that are largest anywhere in the run, by their number."""
    orders = range(1, int(made.line[-1]) + 1)
    largest = sorted(orders, key=lambda order: -float(signal.magnitude(made.cut(order)).max()))
    return tuple(sorted(largest[:NAMED]))


def _words(signal: Signal, made: Waterfall, along: FloatArray, unit: str) -> str:
    """Say where it is loudest, and which order makes it."""
    overall = signal.magnitude(made.rms)
    worst = int(np.argmax(overall))
    orders = range(1, int(made.line[-1]) + 1)
    power = {order: 0.5 * float(signal.magnitude(made.cut(order))[worst]) ** 2 for order in orders}
    order = max(power, key=lambda key: power[key])
    share = min(power[order] / max(float(overall[worst]) ** 2, 1e-300), 1.0)
    return (
        f"Loudest at {number(float(along[worst]), 3)} {unit}: {number(float(overall[worst]), 3)} "
        f"{signal.quantity.unit} rms, {number(100.0 * share, 2)} % of its power at mesh order {order}."
    )


def _table(
    signal: Signal,
    made: Waterfall,
    overall: FloatArray,
    cuts: dict[int, FloatArray],
    along: tuple[Axis, FloatArray],
) -> Table:
    """Where each of the lines is largest."""
    axis, abscissa = along
    rows = [_row("overall, rms", overall, abscissa, np.full(abscissa.size, np.nan))]
    rows += [_row(f"{k}×", cut, abscissa, k * made.mesh_frequency) for k, cut in cuts.items()]
    head = ("mesh order", f"largest, {signal.unit}", "dB", axis.label, "frequency, Hz")
    return Table("Largest value of each line", head, tuple(rows))


def _row(name: str, values: FloatArray, along: FloatArray, frequency: FloatArray) -> tuple[str, ...]:
    """One line's largest value and where it is."""
    at = int(np.argmax(values))
    level = f"{20.0 * np.log10(max(float(values[at]), 1e-300)):.1f}"
    where = "" if np.isnan(frequency[at]) else number(float(frequency[at]), 4)
    return name, number(float(values[at]), 4), level, number(float(along[at]), 4), where
