"""Time series of a run from its trajectory: forces, transmission errors, speeds."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dynamics.joints.seat import SEAT
from dynamics.results.axis_series import axis_series
from dynamics.system.assemble import System
from dynamics.system.freedoms import ROTATION
from dynamics.system.motion import ACCELERATION, FRACTION, QUANTA_PER_TURN, SPEED, WHOLE
from dynamics.system.observation import observe, observe_laws, static_deflections
from dynamics.types import FloatArray, IntArray


def histories(
    system: System,
    time: FloatArray,
    q: FloatArray,
    v: FloatArray,
    moved: IntArray,
    acceleration: FloatArray | None = None,
) -> dict[str, Any]:
    """Return the series of `RunResult` for the states `q`, `v` (T, n), `moved` (T, k) at `time` (T,).

    `acceleration` (T, n) is that of the freedoms, if wanted.
    """
    arrays, scene = system.arrays, system.scene
    laws = observe_laws(arrays, time)
    seen = observe(arrays, time, q, v, moved)
    wanted = scene.outputs
    position = seen.position[: len(scene.meshes)]
    force, moment = _on_the_ground(system, laws, seen.force, q, v, moved)
    return {
        "time": time,
        "mesh": tuple(mesh.name for mesh in scene.meshes),
        "shaft": tuple(shaft.name for shaft in scene.shafts),
        "bearing": system.supports.name if wanted.bearing_forces else (),
        "freedom": system.freedoms.name if wanted.displacements else (),
        "drive": tuple(drive.name for drive in scene.drives),
        "coupling": system.couplings.name,
        "position": position,
        "mesh_frequency": _mesh_frequency(system, laws[SPEED], v),
        "dynamic_transmission_error": seen.coordinate[system.driving_rows],
        "static_transmission_error": _static(system, position),
        "mesh_force": seen.force[system.driving_rows],
        "coast_force": _coast_force(system, seen.force),
        **axis_series(system, seen.coordinate, seen.force),
        "speed": _speed(system, laws[SPEED], v),
        "drive_torque": _drive_torque(system, time, laws[ACCELERATION], seen.force, q, v),
        "coupling_torque": _coupling_torque(system, q, v),
        "bearing_force": force,
        "bearing_moment": moment,
        "displacement": np.ascontiguousarray(q.T) if wanted.displacements else np.empty((0, time.size)),
        "velocity": np.ascontiguousarray(v.T) if wanted.displacements else np.empty((0, time.size)),
        "nominal_force": system.flanks.nominal_force,
        **_accelerations(system, laws, acceleration, moved),
    }


def _accelerations(
    system: System, laws: FloatArray, acceleration: FloatArray | None, moved: IntArray
) -> dict[str, FloatArray]:
    """Accelerations of the freedoms, and of the shafts at their bearings."""
    none = {"acceleration": np.empty((0, len(moved))), "bearing_acceleration": np.empty((0, 3, len(moved)))}
    if acceleration is None:
        return none
    found = dict(none)
    if system.scene.outputs.displacements:
        found["acceleration"] = np.ascontiguousarray(acceleration.T)
    if system.scene.outputs.bearing_forces:
        moves = system.freedoms.keep(system.supports.motion)
        bearings, _, freedoms = moves.shape
        seats = (moves.reshape(3 * bearings, freedoms) @ acceleration.T).reshape(bearings, 3, len(moved))
        found["bearing_acceleration"] = _seen_from_the_ground(system, seats, laws, moved)
    return found


def _on_the_ground(
    system: System, laws: FloatArray, local: FloatArray, q: FloatArray, v: FloatArray, moved: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return forces and moments on the ground, (b, 3, T) each; none of them if not asked for.

    Moments are none at all where no bearing holds tilt.
    """
    none = np.empty((0, 3, q.shape[0]))
    if not system.scene.outputs.bearing_forces:
        return none, none
    found = bearing_force(system, local, q, v)
    force, moment = found[:, :3], found[:, 3:]
    turned = _seen_from_the_ground(system, np.ascontiguousarray(force), laws, moved)
    if not _holds_tilt(system):
        return turned, none
    return turned, _seen_from_the_ground(system, np.ascontiguousarray(moment), laws, moved)


def _holds_tilt(system: System) -> bool:
    """Whether any bearing exerts a moment."""
    if any(at.tilts for at in system.bearings):
        return True
    matrices = (system.bearing_stiffness[:, 3:], system.bearing_damping[:, 3:])
    return any(bool(np.any(matrix)) for matrix in (*matrices, system.seats.preload.reshape(-1, SEAT)[:, 3:]))


def bearing_force(system: System, local: FloatArray, q: FloatArray, v: FloatArray) -> FloatArray:
    """Return the force (N) on the ground or the pin at each support in its own frame, (b, 3, T).

    With seats (b, 6, T): force and moment (N m), the one about the axis 0. `local` (R, T) in N are the forces
    of the elements.
    """
    bearings, rows, freedoms = system.bearing_stiffness.shape
    force = system.bearing_stiffness.reshape(rows * bearings, freedoms) @ q.T
    force += system.bearing_damping.reshape(rows * bearings, freedoms) @ v.T
    supports, seats = system.supports, system.seats
    found = force.reshape(bearings, rows, q.shape[0])
    found[:, :3] -= (supports.stiffness * supports.error)[:, :, None]
    if seats.name:
        found[seats.place, :SEAT] -= seats.preload.reshape(-1, SEAT)[:, :, None]
    first = system.arrays.elements.first[len(system.elements) - len(system.bearings) :]
    for start, at in zip(first, system.bearings, strict=False):
        rows = np.flatnonzero(np.any(at.way != 0.0, axis=0))
        found[at.support, rows] += at.way[:, rows].T @ local[start : start + at.way.shape[0]]
    return np.asarray(found)


def _seen_from_the_ground(system: System, force: FloatArray, laws: FloatArray, moved: IntArray) -> FloatArray:
    """Turn vectors on the ground from the carrier's frame into the fixed one, (b, 3, T)."""
    ratio = system.kinematics.float_ratio
    turned = laws[WHOLE] + laws[FRACTION] + moved.T / QUANTA_PER_TURN
    for bearing, frame in enumerate(system.supports.frame):
        if frame is None:
            continue
        angle = 2.0 * math.pi * (ratio[frame] @ turned)
        x, y = force[bearing, 0].copy(), force[bearing, 1].copy()
        force[bearing, 0] = np.cos(angle) * x - np.sin(angle) * y
        force[bearing, 1] = np.sin(angle) * x + np.cos(angle) * y
    return force


def _coupling_torque(system: System, q: FloatArray, v: FloatArray) -> FloatArray:
    """Torque about +z from the first shaft of each coupling on the second, (c, T)."""
    couplings = system.couplings
    strains = system.freedoms.keep(couplings.motion)
    elastic = np.einsum("cl,cln,tn->ct", couplings.stiffness[:, ROTATION], strains, q)
    viscous = np.einsum("cl,cln,tn->ct", couplings.damping[:, ROTATION], strains, v)
    return np.ascontiguousarray(-elastic - viscous)


def _mesh_frequency(system: System, speed: FloatArray, v: FloatArray) -> FloatArray:
    """Return base pitches per second in the mean motion, (m, T)."""
    reference = system.arrays.reference
    turning = speed.copy()
    for law, place in enumerate(reference.freedom):
        if place >= 0:
            turning[law] += v[:, place]
    rates = (reference.numerator / reference.denominator)[: len(system.scene.meshes)]
    return np.asarray(np.abs(rates @ turning) / (2.0 * math.pi))


def _coast_force(system: System, force: FloatArray) -> FloatArray:
    """Force of the coast flanks, (m, T); (0, T) where no mesh has one."""
    meshes, coast = len(system.scene.meshes), system.flanks.coast
    found = np.zeros((meshes if coast else 0, force.shape[1]))
    for place, mesh in enumerate(coast, start=meshes):
        found[mesh] = force[system.arrays.elements.first[place]]
    return found


def _static(system: System, position: FloatArray) -> FloatArray:
    """Transmission error at the nominal force, (m, T)."""
    static = np.empty_like(position)
    for f, force in enumerate(system.flanks.nominal_force):
        static_deflections(system.flanks.static, f, position[f], float(force), static[f])
    return static


def _speed(system: System, laws: FloatArray, v: FloatArray) -> FloatArray:
    """Speed of every shaft about +z, (s, T)."""
    speed = system.kinematics.float_ratio @ laws
    for column, place in enumerate(system.freedoms.place):
        if place < 6 * len(system.rotors) and place % 6 == ROTATION:
            speed[place // 6] += v[:, column]
    return np.asarray(speed)


def _drive_torque(
    system: System,
    time: FloatArray,
    acceleration: FloatArray,
    force: FloatArray,
    q: FloatArray,
    v: FloatArray,
) -> FloatArray:
    """Torque that imposes the motion of each drive, (d, T): balance of its shaft, or its spring's."""
    drive = system.arrays.drive
    torque = drive.inertia @ acceleration + drive.direction @ force - drive.constant[:, None]
    torque += drive.stiffness @ q.T + drive.damping @ v.T
    for row, load in enumerate(system.scene.loads):
        torque -= system.arrays.load.drive[row][:, None] * load.torque(time)
    return np.ascontiguousarray(torque[: len(system.scene.drives)])
