"""Runs as sounds, by the forces and motions that they hold."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from bounds.types import Json
from dynamics.acoustics import Recording
from dynamics.results import RunResult
from lineofaction.gearbox.studies.listen.run import NO_LOUDNESS
from lineofaction.report.drawing.figure import number, unit_of
from lineofaction.report.run.levels import Loudest, loudest
from lineofaction.report.run.sound import run_signals
from lineofaction.report.run.view import RunView

FAINT = 1e-3
"""Share of the overall level below which an order is not printed."""


@dataclass(frozen=True)
class RunSound:
    """A run with its recording, its figures, and its row of the printed table."""

    name: str
    recording: Recording
    figures: Json = field(default_factory=dict)
    """Figures as plain JSON, in addition to the figures of the recording."""
    cells: dict[str, str] = field(default_factory=dict)
    """Cells of the printed table by the names of their columns."""


def bearing_sounds(runs: Mapping[str, RunResult], view: RunView) -> tuple[list[RunSound], str]:
    """Return the series of runs, e.g. forces on a bearing, as sounds, and a remark on all of them."""
    sounds = []
    for series in tuple(run_signals(dict(runs), view)):
        recording, moment = series.recording(), loudest(series.run, series.signal)
        figures: Json = {"loudest": None}
        if moment is not None:
            orders = {str(order): value for order, value in moment.orders.items()}
            figures = {"loudest": {"time_s": moment.time, "rms": moment.overall, "orders_rms": orders}}
        sounds.append(RunSound(series.name, recording, figures, _moment_cells(moment, recording.unit)))
    return sounds, NO_LOUDNESS


def _moment_cells(moment: Loudest | None, unit: str) -> dict[str, str]:
    """Return the time at which a run is loudest, and the levels of its orders then, as cells."""
    where, text = "", "too short for orders"
    if moment is not None:
        levels = [
            f"{order}x {20.0 * math.log10(value):.1f}"
            for order, value in moment.orders.items()
            if value > FAINT * moment.overall
        ]
        where, text = f"{number(moment.where, 4)} {unit_of(moment.axis.label)}", ", ".join(levels)
    return {"loudest at": where, f"orders there, dB re 1 {unit} rms": text}
