"""Order map: levels over speed and mesh order."""

from __future__ import annotations

import numpy as np

from dynamics.orders import Waterfall, highest_valid_order
from dynamics.results import RunResult
from lineofaction.report.drawing.figure import Axis, Figure, Panel, number, unit_of
from lineofaction.report.runs.level_map import DEPTH, level_map
from lineofaction.report.runs.levels_over_speed import MAPPED
from lineofaction.report.runs.run_series import validity
from lineofaction.report.runs.run_view import Signal, run_axis


def order_map(run: RunResult, signal: Signal, made: Waterfall) -> Figure:
    """Draw spectra over mesh orders side by side: what follows the mesh lies level."""
    valid = highest_valid_order(run, signal.mesh)
    last = max(min(MAPPED, valid), 1)
    amplitude = signal.amplitude(made.amplitude)[:, made.line <= last]
    axis, along = run_axis(run, made.time, signal.mesh)
    shade = level_map(along, made.line[made.line <= last], amplitude, float(last))
    names = tuple((float(order), f"{order}×") for order in range(1, last + 1))
    ends = Axis(axis.label, limits=(float(shade.x[0]), float(shade.x[-1])))
    orders = Axis("mesh order", limits=(0.0, float(made.line[-1])), names=names)
    block, line = np.unravel_index(int(np.argmax(amplitude[:, 1:])), amplitude[:, 1:].shape)
    loudest = number(float(amplitude[block, line + 1]), 3)
    where = f"{number(float(along[block]), 3)} {unit_of(axis.label)}"
    return Figure(
        key="order_map",
        title=f"Order map of the {signal.name}",
        caption=f"Color: {signal.scale} amplitude of each block's spectrum over mesh orders, in dB below the "
        f"largest, down to −{DEPTH:g} dB. {validity(valid, float(run.mesh_frequency[signal.mesh].max()))}",
        alternative=f"Largest: {loudest} {signal.unit} at order "
        f"{number(float(made.line[line + 1]), 4)} and {where}.",
        content=(Panel(ends, orders, shade=shade),),
    )
