"""Levels of the mesh orders of a run where it is loudest, along the direction in which it is heard."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.results import RunResult
from lineofaction.gearbox.studies.listen.through_housing import PRINCIPAL
from lineofaction.report.drawing.figure import Axis
from lineofaction.report.runs.levels_over_speed import largest_orders, order_blocks, pitches_passed
from lineofaction.report.runs.run_view import SCALES, Signal, run_axis
from lineofaction.report.runs.signal_recording import along_direction

LEAST_PITCHES = 64  # of a run whose orders are shown


@dataclass(frozen=True)
class Loudest:
    """The block of a run with the highest overall level.

    Attributes
    ----------
    axis : Axis
        Speed or time.
    where, time : float
        On the axis; s.
    overall : float
        rms about the mean, in the signal's unit.
    orders : dict of int to float
        rms of the mesh orders that were named, or of the largest of the run.
    """

    axis: Axis
    where: float
    time: float
    overall: float
    orders: dict[int, float]


def has_orders(run: RunResult, mesh: int = 0) -> bool:
    """Whether a run passes enough base pitches for orders over it."""
    return pitches_passed(run, mesh) >= LEAST_PITCHES


def loudest(run: RunResult, signal: Signal) -> Loudest | None:
    """Return where what is heard of a run is loudest; None of a run without orders.

    Raises
    ------
    BadInput
        It does not vary.
    """
    if not has_orders(run, signal.mesh):
        return None
    if signal.quantity.part == "bearing" and not signal.direction:
        signal = replace(signal, direction=PRINCIPAL)
    seen = along_direction(run, signal)
    blocks = order_blocks(seen, signal)
    axis, along = run_axis(seen, blocks.time, signal.mesh)
    overall = signal.magnitude(blocks.rms)
    worst = int(np.argmax(overall))
    rms = {
        order: SCALES["rms"] * float(signal.magnitude(blocks.cut(order))[worst])
        for order in signal.orders or largest_orders(signal, blocks)
    }
    return Loudest(axis, float(along[worst]), float(blocks.time[worst]), float(overall[worst]), rms)
