"""What ``loa listen`` makes of runs by what they hold: a recording of each, and what is printed of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from dynamics.acoustics import Recording
from dynamics.results import RunResult
from lineofaction.gearbox.studies.listen.heard_run import NO_LOUDNESS
from lineofaction.report.drawing.figure import number, unit_of
from lineofaction.report.runs.loudest import Loudest, loudest
from lineofaction.report.runs.run_view import RunView
from lineofaction.report.runs.sound import heard_runs

Json = dict[str, Any]
FAINT = 1e-3
"""Of the overall level: weaker orders are not printed."""


@dataclass(frozen=True)
class RunSound:
    """A run as it is heard.

    Attributes
    ----------
    name : str
    recording : Recording
    facts : dict
        Plain JSON beside the recording's own.
    cells : dict of str to str
        What is printed in the columns of these names.
    """

    name: str
    recording: Recording
    facts: Json = field(default_factory=dict)
    cells: dict[str, str] = field(default_factory=dict)


def bearing_sounds(runs: Mapping[str, RunResult], view: RunView) -> tuple[list[RunSound], str]:
    """Return runs by what they hold, e.g. forces on a bearing, and what to say of all."""
    sounds = []
    for one in heard_runs(dict(runs), view):
        recording, moment = one.recording(), loudest(one.run, one.signal)
        facts = {"loudest": None if moment is None else _moment_facts(moment)}
        sounds.append(RunSound(one.name, recording, facts, _moment_cells(moment, recording.unit)))
    return sounds, NO_LOUDNESS


def _moment_facts(moment: Loudest) -> Json:
    """Return where a run is loudest as JSON."""
    orders = {str(order): value for order, value in moment.orders.items()}
    return {"time_s": moment.time, "rms": moment.overall, "orders_rms": orders}


def _moment_cells(moment: Loudest | None, unit: str) -> dict[str, str]:
    """Say where a run is loudest, and the levels of its orders there."""
    where, text = "", "too short for orders"
    if moment is not None:
        levels = [
            f"{order}x {20.0 * math.log10(value):.1f}"
            for order, value in moment.orders.items()
            if value > FAINT * moment.overall
        ]
        where, text = f"{number(moment.where, 4)} {unit_of(moment.axis.label)}", ", ".join(levels)
    return {"loudest at": where, f"orders there, dB re 1 {unit} rms": text}
