"""Sidebands of the mesh orders as a table."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.orders import Sideband, sidebands
from dynamics.results import RunResult
from lineofaction.report.drawing.figure import Table, number
from lineofaction.report.runs.run_view import Signal

SHARE, ROWS = 1e-3, 12  # of the largest mesh order


def sideband_tables(run: RunResult, signal: Signal) -> tuple[Table, ...]:
    """Tabulate the largest sidebands of the loudest component; nothing if the run is too short for them."""
    values = max(signal.components(run).values(), key=lambda series: float(np.var(series)))
    try:
        lines = sidebands(run, values, mesh=signal.mesh)
    except InputError:  # fewer than four revolutions
        return ()
    least = SHARE * max(line.amplitude for line in lines if line.number == 0)
    beside = sorted((s for s in lines if s.number and s.amplitude > least), key=lambda s: -s.amplitude)
    if not beside:
        return ()
    caption = f"Sidebands of the {signal.name}, once per revolution of a gear and its multiples"
    head = ("mesh order", "sideband", "order", f"amplitude, {signal.quantity.unit} peak")
    return (Table(caption, head, tuple(map(_row, beside[:ROWS]))),)


def _row(line: Sideband) -> tuple[str, ...]:
    """One line."""
    offset = f"{line.number:+d} × {line.source}"
    return str(line.mesh_order), offset, number(line.order, 5), number(line.amplitude, 3)
