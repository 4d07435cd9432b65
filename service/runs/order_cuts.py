"""Order cuts: amplitudes of the mesh orders over a run."""

from __future__ import annotations

import numpy as np

from dynamics.orders import highest_valid_order, order_waterfall
from dynamics.results import RunResult
from service.drawing import palette
from service.drawing.figure import Axis, Figure, Line, Panel, Table, number
from service.runs.run_series import validity
from service.runs.run_signal import run_axis, shown_signal

ORDERS, POINTS, SHORTEST = 5, 400, 16


def order_cuts(run: RunResult) -> Figure:
    """Draw the amplitudes of the first mesh orders over speed or time."""
    signal = shown_signal(run)
    travel = float(np.abs(np.ptp(np.unwrap(run.position[0], period=1.0))))
    valid = highest_valid_order(run)
    last = max(min(ORDERS, valid), 1)
    made = order_waterfall(run, signal.series, max(SHORTEST, int(travel / POINTS)), last)
    axis, abscissa = run_axis(run, made.time)
    cuts = [signal.of(made.cut(order)) for order in range(1, last + 1)]
    lines = tuple(
        Line(f"{order}×", abscissa, cut, palette.category(order - 1), width=1.4)
        for order, cut in enumerate(cuts, start=1)
    )
    peaks = [(order, int(np.argmax(cut)), cut) for order, cut in enumerate(cuts, start=1)]
    words = "; ".join(
        f"{k}×: {number(float(c[i]), 3)} {made.unit} at {number(float(abscissa[i]), 3)}" for k, i, c in peaks
    )
    rows = tuple(
        (
            str(k),
            number(float(c[i]), 4),
            number(float(abscissa[i]), 4),
            number(float(k * made.mesh_frequency[i]), 4),
        )
        for k, i, c in peaks
    )
    head = ("mesh order", f"largest amplitude, {made.unit}", axis.label, "frequency, Hz")
    return Figure(
        key="order_cuts",
        title=f"Mesh orders of the {signal.name}",
        caption="Resampled to equal steps of position, Hann window over blocks of whole base pitches; "
        f"components added in power. {validity(valid, float(run.mesh_frequency[0].max()))}",
        alternative=f"Largest by order: {words} ({axis.label.rpartition(',')[2].strip()}).",
        content=(Panel(axis, Axis(f"amplitude, {made.unit}"), lines),),
        table=Table("Largest amplitude of each mesh order", head, rows),
    )
