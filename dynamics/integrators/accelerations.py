"""Accelerations in sampled states, from the equations of motion."""

from __future__ import annotations

import numpy as np

from dynamics.forces.by_address import by_address
from dynamics.forces.compiled import compiled
from dynamics.integrators.explicit_step import accelerate
from dynamics.integrators.state_sink import States
from dynamics.integrators.workspace import Workspace, make_workspace
from dynamics.system.arrays import SystemArrays
from dynamics.types import FloatArray


def accelerations(system: SystemArrays, time: FloatArray, states: States) -> FloatArray:
    """Return q'' (T, n) at `time` (T,): M q'' is what all forces in the state leave."""
    found = np.empty_like(states.q)
    work = by_address(make_workspace(system, np.array([1.0, 0.0]), np.zeros(states.q.shape[1]), 1.0))
    accelerate.prepare(system, work)
    _accelerations(by_address(system), work, time, by_address(states), found)
    return found


@compiled
def _accelerations(
    system: SystemArrays, work: Workspace, time: FloatArray, states: States, found: FloatArray
) -> None:
    """Fill `found`."""
    for k in range(time.size):
        for law in range(work.moved.size):
            work.moved[law] = states.moved[k, law]
        for i in range(found.shape[1]):
            work.q_new[i], work.v_new[i] = states.q[k, i], states.v[k, i]
        accelerate(system, work, time[k], 0)
        for i in range(found.shape[1]):
            found[k, i] = work.stage_a[0, i]
