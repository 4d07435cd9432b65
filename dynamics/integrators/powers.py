"""Compiled powers at one instant, the integrands of the energy audit."""

from __future__ import annotations

from dynamics.forces.compiled import inner
from dynamics.forces.element_laws import (
    FLANK,
    SPATIAL_FLANK,
    SPEED_TORQUE,
    TURNING,
    slides,
    supplied_power,
)
from dynamics.forces.routine import routine
from dynamics.integrators.rung import row_product
from dynamics.integrators.workspace import Power, Workspace
from dynamics.system.arrays import SystemArrays
from dynamics.system.motion import ACCELERATION, SPEED, law_value
from dynamics.types import FloatArray


@routine
def write_powers(system: SystemArrays, work: Workspace, stage: int, time: float) -> None:
    """Write row `stage` of ``work.power`` from the local state at that stage and its rates ``work.stage_v``.

    Drives supply the torque on their own shafts times their speeds. A table V(x, d) exerts dV/dd only along
    the line of action; what dV/dx stores as the position moves on is counted as supplied by the position,
    and likewise along the table's other axes, less the work of forces along them.
    """
    velocity = work.stage_v[stage]
    laws = work.motion.shape[0]
    drives, loads = 0.0, 0.0
    for k in range(laws):
        drives += _drive_torque(system, work, k, velocity, time) * work.motion[k, SPEED]
    for load in range(system.load.direction.shape[0]):
        value = law_value(system.load.torque, load, time)
        rate = 0.0
        for k in range(laws):
            rate += system.load.reference[load, k] * work.motion[k, SPEED]
        for i in range(velocity.size):
            rate += system.load.direction[load, i] * velocity[i]
        loads += value * rate
    lost_in_bearings, mesh, friction, supplied, kept = _in_elements(system, work)
    bushing, position = lost_in_bearings, 0.0
    loads += supplied
    drives -= kept
    for i in range(velocity.size):
        bushing += velocity[i] * row_product(system.damping, system.block, velocity, i)
    axes = 0.0
    for e in range(system.elements.law.size):
        m = system.elements.mesh[e]
        if m >= 0:
            rate = work.local.pace[m]
            for i in range(velocity.size):
                rate += system.turn[m, i] * velocity[i]
            by_position, by_axes = supplied_power(system.elements, work.local, e, rate)
            position += by_position
            axes += by_axes
    work.power[stage, Power.DRIVE] = drives
    work.power[stage, Power.LOAD] = loads
    work.power[stage, Power.POSITION] = position
    work.power[stage, Power.BUSHING] = bushing
    work.power[stage, Power.MESH] = mesh
    work.power[stage, Power.AXES] = axes
    work.power[stage, Power.FRICTION] = friction


@inner
def _in_elements(system: SystemArrays, work: Workspace) -> tuple[float, float, float, float, float]:
    """Return the powers lost in bearings, flanks and friction, and the one that torques by speed supply.

    Then that which the kinematic motion exchanges with turning frames: kinetic energy in the product of
    displacements and speeds, which the balance does not hold.
    """
    bearing, mesh, friction, supplied, kept = 0.0, 0.0, 0.0, 0.0, 0.0
    for e in range(system.elements.law.size):
        for r in range(system.elements.first[e], system.elements.first[e + 1]):
            lost = (work.force[r] - work.local.elastic[r]) * work.local.rate[r]
            if system.elements.law[e] == SPEED_TORQUE:
                supplied -= work.force[r] * (work.local.rate[r] + work.local.drift[r])
            elif slides(system.elements, e, r):
                friction += work.force[r] * (work.local.rate[r] + work.local.drift[r])
            elif system.elements.law[e] == FLANK or system.elements.law[e] == SPATIAL_FLANK:
                mesh += lost
            else:
                bearing += lost
                if system.elements.law[e] == TURNING:
                    kept += work.force[r] * work.local.drift[r]
    return bearing, mesh, friction, supplied, kept


@inner
def _drive_torque(
    system: SystemArrays, work: Workspace, law: int, velocity: FloatArray, time: float
) -> float:
    """Return the torque that imposes the motion of one law, N m; 0 for a free rotation."""
    drive = system.drive
    torque = -drive.constant[law]
    for k in range(work.motion.shape[0]):
        torque += drive.inertia[law, k] * work.motion[k, ACCELERATION]
    for load in range(system.load.direction.shape[0]):
        if system.load.drive[load, law] != 0.0:
            torque -= system.load.drive[load, law] * law_value(system.load.torque, load, time)
    for i in range(velocity.size):
        torque += drive.stiffness[law, i] * work.q_new[i] + drive.damping[law, i] * velocity[i]
    for r in range(work.force.size):
        torque += drive.direction[law, r] * work.force[r]
    return float(torque)
