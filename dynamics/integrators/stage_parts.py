"""Compiled parts that implicit and explicit stages share."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.integrators.workspace import Workspace
from dynamics.kernels.compiled import inner
from dynamics.motion.motion import external_force, set_drift, set_phases, write_motion
from dynamics.types import FloatArray


@inner
def set_motion(system: SystemArrays, work: Workspace, time: float, position: FloatArray) -> None:
    """Write the laws' motion, external force, and the meshes' phases into `position`, at `time`."""
    write_motion(system.reference, time, work.quanta, work.motion)
    external_force(system, time, work.motion, work.external)
    set_phases(system.reference, work.motion, position, work.local)
    set_drift(system.elements, time, work.motion, work.local)


@inner
def add_stages(weights: FloatArray, stage: int, step: float, rates: FloatArray, values: FloatArray) -> None:
    """Add the contributions of the stages before `stage` by their `rates` (stages, n) to `values` (n,)."""
    for s in range(stage):
        share = step * weights[stage, s]
        for i in range(values.size):
            values[i] += share * rates[s, i]


@inner
def finish_step(work: Workspace, step: float, weights: FloatArray, embedded: FloatArray) -> None:
    """Write the embedded error estimates of displacements and rates."""
    q_error, v_error = work.q_error, work.v_error
    for i in range(q_error.size):
        q_error[i], v_error[i] = 0.0, 0.0
    for stage in range(weights.size):
        difference = step * (weights[stage] - embedded[stage])
        for i in range(q_error.size):
            q_error[i] += difference * work.stage_v[stage, i]
            v_error[i] += difference * work.stage_a[stage, i]
