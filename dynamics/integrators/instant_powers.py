"""The compiled powers of forces at one instant, which the energy audit integrates."""

from __future__ import annotations

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.modal_freedoms import modal_loss
from dynamics.arrays.sparse_rows import row_product
from dynamics.forces.elements import (
    APPLIED_FORCE,
    FLANK,
    ROTATING_FRAME,
    SPATIAL_FLANK,
    SPEED_TORQUE,
    UNBALANCE,
    power_along_axes,
    power_by_frames,
    slides,
)
from dynamics.integrators.workspace import Power, Workspace
from dynamics.kernels.compiled import inner
from dynamics.kernels.routine import routine
from dynamics.motion.motion import ACCELERATION, SPEED, law_value
from dynamics.types import FloatArray


@routine
def write_powers(system: SystemArrays, work: Workspace, stage: int, time: float) -> None:
    """Write row `stage` of ``work.power`` from the local state at that stage and its rates ``work.stage_v``.

    Drives supply the torque on their own shafts times their speeds. A table has the energy V(x, d, axes) and
    exerts dV/dd along the line of action. The power dV/dx x' is supplied by the position. The axes supply
    their part of V', less the work of the forces along them. The total V' is not integrated: the end of the
    run adds the change of V. So the position has only minus the parts of d and of the axes here. The rotation
    of frames and the change of its speed count with the position.
    """
    velocity = work.stage_v[stage]
    laws, modal = work.motion.shape[0], system.sparse.modal
    drives, loads = 0.0, 0.0
    for k in range(laws):
        if work.motion[k, SPEED] != 0.0:
            drives += _drive_torque(system, work, k, velocity, time) * work.motion[k, SPEED]
    for load in range(system.load.direction.shape[0]):
        value = law_value(system.load.torque, load, time)
        rate = 0.0
        for k in range(laws):
            rate += system.load.reference[load, k] * work.motion[k, SPEED]
        for i in range(modal.first):
            rate += system.load.direction[load, i] * velocity[i]
        loads += value * rate
    bushing, mesh, friction, supplied, frames, position, axes = _in_elements(system, work)
    loads += supplied
    drives -= frames
    damping = system.sparse.damping
    for i in range(modal.first):
        bushing += velocity[i] * row_product(damping, damping.weight, i, velocity)
    bushing += modal_loss(modal, velocity)
    work.power[stage, Power.DRIVE] = drives
    work.power[stage, Power.LOAD] = loads
    work.power[stage, Power.POSITION] = position
    work.power[stage, Power.BUSHING] = bushing
    work.power[stage, Power.MESH] = mesh
    work.power[stage, Power.AXES] = axes
    work.power[stage, Power.FRICTION] = friction


@inner
def _by_frame_speed(system: SystemArrays, work: Workspace, e: int) -> float:
    """Return the power that changing speeds w of a shaft and W of its frame store in element `e`, W.

    The energies are the term (c_3 w W + c_4 W^2) y^2/2 and the load -W^2 l y.
    """
    entry, row, spin_rate, frame_rate = system.elements.entry[e], system.elements.first[e], 0.0, 0.0
    for k in range(work.motion.shape[0]):
        spin_rate += system.elements.speed[k, e, 0] * work.motion[k, ACCELERATION]
        frame_rate += system.elements.speed[k, e, 1] * work.motion[k, ACCELERATION]
    spin, frame = work.local.speed[e, 0], work.local.speed[e, 1]
    laws, y = system.elements.laws.rotating_frame, work.local.coordinate
    c, load = laws.factor, laws.load
    stiffer = c[entry, 2] * (spin_rate * frame + spin * frame_rate) + 2.0 * c[entry, 3] * frame * frame_rate
    pulled = load[entry, 0] * y[row] + load[entry, 1] * y[row + 1]
    return float(0.5 * stiffer * (y[row] ** 2 + y[row + 1] ** 2) - 2.0 * frame * frame_rate * pulled)


@inner
def _in_elements(
    system: SystemArrays, work: Workspace
) -> tuple[float, float, float, float, float, float, float]:
    """Return the powers in the elements, W: bearing, mesh, friction, supplied, frames, position, axes.

    The first three are losses. Loads supply the fourth; the position and the other axes of tables supply the
    last two. The kinematic motion exchanges the fifth with rotating frames. That energy is kinetic, in
    products of displacements and kinematic speeds, which the balance leaves out.
    """
    bearing, mesh, friction, supplied, frames, position, axes = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    elements, force, elastic = system.elements, work.force, work.local.elastic
    rate, drift = work.local.rate, work.local.drift
    for e in range(elements.law.size):
        law, first, end, element_loss = elements.law[e], elements.first[e], elements.first[e + 1], 0.0
        if law == FLANK:
            mesh += (force[first] - elastic[first]) * rate[first]
            position -= elastic[first] * rate[first]
            continue
        if law == ROTATING_FRAME:
            for r in range(first, end):
                bearing += (force[r] - elastic[r]) * rate[r]
                frames += force[r] * drift[r]
            position += _by_frame_speed(system, work, e)
            continue
        position += power_by_frames(elements, work.local, e)
        if law == UNBALANCE:
            continue  # its work is the change of its energy
        for r in range(first, end):
            if law in (SPEED_TORQUE, APPLIED_FORCE):
                supplied -= force[r] * (rate[r] + drift[r])
            elif law == SPATIAL_FLANK and slides(elements, e, r):
                friction += force[r] * (rate[r] + drift[r])
            else:
                element_loss += (force[r] - elastic[r]) * rate[r]
        if law == SPATIAL_FLANK:
            mesh += element_loss
            power, stored = power_along_axes(elements, work.local, e)  # on the bodies, and in the table
            axes += stored - power
            position -= elastic[first] * rate[first] + stored
        else:
            bearing += element_loss
    return bearing, mesh, friction, supplied, frames, position, axes


@inner
def _drive_torque(
    system: SystemArrays, work: Workspace, law: int, velocity: FloatArray, time: float
) -> float:
    """Return the torque that imposes the motion of one law, N m; 0 for a free rotation.

    The symmetric part of the inertia is left out: `add_drive_work` adds its work in closed form.
    """
    drive = system.drive
    torque = -drive.constant[law]
    for k in range(work.motion.shape[0]):
        skew = 0.5 * (drive.inertia[law, k] - drive.inertia[k, law])
        torque += skew * work.motion[k, ACCELERATION]
    for load in range(system.load.direction.shape[0]):
        if system.load.drive[load, law] != 0.0:
            torque -= system.load.drive[load, law] * law_value(system.load.torque, load, time)
    for i in range(system.sparse.modal.first):
        torque += drive.stiffness[law, i] * work.q_new[i] + drive.damping[law, i] * velocity[i]
    for r in range(work.force.size):
        torque += drive.direction[law, r] * work.force[r]
    return float(torque)


@inner
def add_drive_work(system: SystemArrays, work: Workspace) -> None:
    """Add the work of drives on the inertia of their shafts over the step that ends in ``work.motion``.

    The work is the change of the kinetic energy W I W/2. The weights of the stages do not integrate the power
    of a law that has a kink in the step. The end becomes the start of the next step.
    """
    inertia, speed = system.drive.inertia, work.speed
    for k in range(speed.size):
        for j in range(speed.size):
            change = work.motion[k, SPEED] * work.motion[j, SPEED] - speed[k] * speed[j]
            work.work[Power.DRIVE] += 0.25 * (inertia[k, j] + inertia[j, k]) * change
    for k in range(speed.size):
        speed[k] = work.motion[k, SPEED]
