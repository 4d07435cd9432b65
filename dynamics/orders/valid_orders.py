"""Up to which mesh order a run's output holds: what the anti-alias filter passes at the highest speed."""

from __future__ import annotations

import math

import numpy as np

from bounds import at_most
from dynamics.checks import integer
from dynamics.errors import InputError
from dynamics.orders.order_frequency import order_frequency
from dynamics.results import RunResult

USUAL = 10
ROUNDING = 1e-9  # of an order that lies on the edge of the pass band


def highest_valid_order(result: RunResult, mesh: int = 0) -> int:
    """Return the highest multiple of a mesh's frequency below the pass frequency at its highest speed.

    Of a run without meshes, of its leading shaft's rotation.
    """
    top = float(np.max(order_frequency(result, mesh), initial=0.0))
    if top == 0.0:
        return 0
    passed = float(result.receipt["sampling"]["pass_frequency"])
    return math.floor(passed / top * (1.0 + ROUNDING))


def checked_order(result: RunResult, field: str, value: int | None, mesh: int = 0, usual: int = USUAL) -> int:
    """Return the order `value`, or what is valid of the usual ones.

    Raises
    ------
    InputError
        If the run's output does not hold that order at its highest speed.
    """
    valid = highest_valid_order(result, mesh)
    if value is None:
        return max(min(usual, valid), 1)
    integer(field, value, 1, 1000)
    if value > valid:
        sampling, top = result.receipt["sampling"], float(np.max(result.mesh_frequency[mesh]))
        rate = value * top * sampling["rate"] / sampling["pass_frequency"]
        passed = f"the output passes {sampling['pass_frequency']:.4g} Hz"
        bound = at_most(valid, note=f": {passed}, and the mesh frequency reaches {top:.4g} Hz")
        suggestion = (
            f"Run with outputs.mesh_orders = {value}, or outputs.sample_rate of {rate:.4g} Hz or more."
        )
        raise InputError(field, value, bound, suggestion)
    return value
