"""Loads at their means over a turn: what statics sees of them, and small motions about it."""

from __future__ import annotations

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.kernels.law import Law
from dynamics.motion.observation import local_state
from dynamics.types import FloatArray

LOADS = (Law.SPEED_TORQUE, Law.APPLIED_FORCE)


def at_mean_loads(arrays: SystemArrays) -> SystemArrays:
    """Return `arrays` with the mean over a turn of every load that changes with an angle.

    Of an unbalance, whose force and weight turn, nothing is left.
    """
    laws = arrays.elements.laws
    if laws.applied_force.size.size + laws.unbalance.amount.size == 0:
        return arrays
    steady = np.ones(1, dtype=np.bool_)
    mean = laws._replace(
        applied_force=laws.applied_force._replace(steady=steady),
        unbalance=laws.unbalance._replace(steady=steady),
    )
    return arrays._replace(elements=arrays.elements._replace(laws=mean))


def mean_loads(arrays: SystemArrays, time: float) -> FloatArray:
    """Return the forces (n,) of loads at the speeds of the kinematic motion at `time`, means over a turn."""
    none = np.zeros(arrays.mass.shape[0])
    local = local_state(at_mean_loads(arrays), time, none, none)
    rows = np.repeat(np.isin(arrays.elements.law, LOADS), np.diff(arrays.elements.first))
    return np.asarray(-local.force[rows] @ arrays.direction[rows])
