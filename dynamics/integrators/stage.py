"""Compiled parts that implicit and explicit stages share."""

from __future__ import annotations

from dynamics.forces.compiled import inner
from dynamics.integrators.workspace import Workspace
from dynamics.system.arrays import SystemArrays
from dynamics.system.motion import external_force, flank_phase, write_motion
from dynamics.types import FloatArray


@inner
def set_motion(system: SystemArrays, work: Workspace, time: float) -> None:
    """Write the laws' motion, external force and flank phases at `time`."""
    write_motion(system.reference, time, work.moved, work.motion)
    external_force(system, time, work.motion, work.external)
    for f in range(work.force.size):
        work.position[f] = flank_phase(system.reference, f, work.motion)


@inner
def add_flank_motion(system: SystemArrays, work: Workspace, q: FloatArray, v: FloatArray) -> None:
    """Add `q` to the positions, and write transmission errors and their rates."""
    for f in range(work.force.size):
        deflection, rate, turned = 0.0, 0.0, 0.0
        for i in range(q.size):
            deflection += system.direction[f, i] * q[i]
            rate += system.direction[f, i] * v[i]
            turned += system.turn[f, i] * q[i]
        work.deflection[f], work.rate[f] = deflection, rate
        work.position[f] += turned


@inner
def finish_step(work: Workspace, step: float, weights: FloatArray, embedded: FloatArray) -> None:
    """Write the embedded error estimates of displacements and rates."""
    for i in range(work.q.size):
        work.q_error[i], work.v_error[i] = 0.0, 0.0
        for stage in range(weights.size):
            difference = step * (weights[stage] - embedded[stage])
            work.q_error[i] += difference * work.stage_v[stage, i]
            work.v_error[i] += difference * work.stage_a[stage, i]
