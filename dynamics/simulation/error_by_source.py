"""The error of a run by source: what its receipt says of transmission errors and bearing forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.assembly.decimated_tables import with_decimated_tables
from dynamics.simulation.documents import ERROR_CHECK_FACTOR, finer, requested_error
from dynamics.simulation.error_windows import (
    Difference,
    StatesOf,
    Window,
    run_again,
    windows,
)
from dynamics.types import Json
from host import cpu_seconds

TIME_STEP_REST = 1.0 / (1.0 - ERROR_CHECK_FACTOR**0.75)
"""Error over the difference to a run at a tenth of the tolerance: it falls as the tolerance^(3/4)."""
TABLE_REST = 1.0 / 3.0
"""Error over the difference to half the positions: second order, as kinks at handovers allow."""


def error_by_source(system: System, states_of: StatesOf, samples: int) -> Json:
    """Return the estimates of a run, measured in windows of it; the requested error where it is too short.

    Sources: time steps, table interpolation between positions, neglected effects.
    """
    requested, integration = requested_error(system.scene.integration), system.scene.integration
    left_out = left_out_effects(system)
    began = cpu_seconds()
    full = system.scene.outputs.receipt == "full"
    looked = windows(system, states_of, samples) if full else []
    if not looked:
        return {**requested, "left_out_effects": left_out}
    steps = [run_again(window, window.system, finer(integration)) for window in looked]
    coarse = with_decimated_tables(system)
    tables = [run_again(window, window.on_laws_of(coarse), integration) for window in looked]
    seconds = cpu_seconds() - began
    return {
        "time_step": _estimate(steps, TIME_STEP_REST, "runs of windows at a tenth of the tolerance")
        or requested["time_step"],
        "table_interpolation": _estimate(tables, TABLE_REST, "runs of windows on every second position"),
        "left_out_effects": left_out,
        "windows": _pitches_of(looked),
        "cpu_seconds": seconds,
    }


def left_out_effects(system: System) -> Json:
    """Return what neglected effects would move the flanks by at rest; bearing forces are not known."""
    off = [entry for entry in system.ledger.entries if not entry.on and entry.influence > 0.0]
    largest = max((entry.influence for entry in off), default=0.0)
    return {
        "rms": largest,
        "unit": "m",
        "source": "largest static displacement along the line of action by one effect that is off",
        "effects": {f"{entry.effect} of {entry.part}": entry.influence for entry in off},
    }


def _estimate(differences: Sequence[Difference | None], rest: float, source: str) -> Json:
    """Put the windows together: rms over all, the worst amplitudes; empty if one of them failed."""
    known = [difference for difference in differences if difference is not None]
    if len(known) < len(differences):
        return {}
    orders = min(difference.error_orders.size for difference in known)
    return {
        "rms": rest * float(np.sqrt(np.mean([difference.rms**2 for difference in known]))),
        "unit": "m",
        "source": source,
        "transmission_error_orders": [
            rest * max(float(difference.error_orders[k]) for difference in known) for k in range(orders)
        ],
        "bearing_force_orders": [
            rest * max(float(difference.force_orders[k]) for difference in known) for k in range(orders)
        ],
        "bearing_force_unit": "N",
    }


def _pitches_of(looked: Sequence[Window]) -> list[list[int]]:
    """First and last sample of each window."""
    return [[window.first, window.stop - 1] for window in looked]
