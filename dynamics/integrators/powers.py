"""Compiled powers at one instant, the integrands of the energy audit."""

from __future__ import annotations

import math

from dynamics.forces.compiled import inner
from dynamics.forces.table_energy import table_energy
from dynamics.integrators.rung import row_product
from dynamics.integrators.workspace import Power, Workspace
from dynamics.system.arrays import SystemArrays
from dynamics.system.motion import drive_motion, law_value


@inner
def write_powers(system: SystemArrays, work: Workspace, stage: int, time: float) -> None:
    """Write row `stage` of ``work.power`` from the flank state at that stage and its rates ``work.stage_v``.

    The drive supplies the torque on its own shaft times its speed. A table V(x, d) exerts dV/dd only along
    the line of action; what dV/dx stores as the position moves on is counted as supplied by the position.
    """
    _, _, speed, acceleration = drive_motion(system.reference, time)
    velocity = work.stage_v[stage]
    torque = system.drive_inertia * acceleration
    loads = 0.0
    for load in range(system.load.reference.size):
        value = law_value(system.load.torque, load, time)
        torque -= system.load.drive[load] * value
        rate = system.load.reference[load] * speed
        for i in range(velocity.size):
            rate += system.load.direction[load, i] * velocity[i]
        loads += value * rate
    bushing, mesh, position = 0.0, 0.0, 0.0
    for i in range(velocity.size):
        bushing += velocity[i] * row_product(system.damping, system.block, velocity, i)
    for f in range(work.force.size):
        torque += system.drive_direction[f] * work.force[f]
        mesh += (work.force[f] - work.elastic[f]) * work.rate[f]
        slope = table_energy(system.flank.table, f, work.position[f], work.deflection[f], work.hint[f])[1]
        rate = system.reference.numerator[f] / system.reference.denominator[f] * speed / (2.0 * math.pi)
        for i in range(velocity.size):
            rate += system.turn[f, i] * velocity[i]
        position += slope * rate
    work.power[stage, Power.DRIVE] = torque * speed
    work.power[stage, Power.LOAD] = loads
    work.power[stage, Power.POSITION] = position
    work.power[stage, Power.BUSHING] = bushing
    work.power[stage, Power.MESH] = mesh
