"""Time series of a run from its trajectory: forces, transmission errors, speeds."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from dynamics.system.assemble import System
from dynamics.system.observation import observe_drive, observe_flanks, static_deflections
from dynamics.types import FloatArray


def histories(system: System, time: FloatArray, q: FloatArray, v: FloatArray) -> dict[str, Any]:
    """Return the series of `RunResult` for the states `q`, `v` (T, n) at `time` (T,), C-contiguous."""
    arrays, scene = system.arrays, system.scene
    drive = np.empty((4, time.size))
    observe_drive(arrays, time, drive)
    flank = np.empty((3, len(scene.meshes), time.size))
    observe_flanks(arrays, time, q, v, flank)
    wanted = scene.outputs
    return {
        "time": time,
        "mesh": tuple(mesh.name for mesh in scene.meshes),
        "shaft": tuple(shaft.name for shaft in scene.shafts),
        "bearing": tuple(bushing.name for bushing in system.bushings) if wanted.bearing_forces else (),
        "freedom": system.freedoms.name if wanted.displacements else (),
        "position": flank[0],
        "mesh_frequency": _mesh_frequency(system, drive[2]),
        "dynamic_transmission_error": flank[1],
        "static_transmission_error": _static(system, flank[0]),
        "mesh_force": flank[2],
        "speed": _speed(system, drive[2], v),
        "drive_torque": _drive_torque(system, time, drive[3], flank[2]),
        "bearing_force": bearing_force(system, q, v)
        if wanted.bearing_forces
        else np.empty((0, 3, time.size)),
        "displacement": np.ascontiguousarray(q.T) if wanted.displacements else np.empty((0, time.size)),
        "velocity": np.ascontiguousarray(v.T) if wanted.displacements else np.empty((0, time.size)),
        "nominal_force": system.flanks.nominal_force,
    }


def bearing_force(system: System, q: FloatArray, v: FloatArray) -> FloatArray:
    """Return the force of the shaft on the ground at each bushing, (b, 3, T) in N."""
    bearings, _, freedoms = system.bearing_stiffness.shape
    force = system.bearing_stiffness.reshape(3 * bearings, freedoms) @ q.T
    force += system.bearing_damping.reshape(3 * bearings, freedoms) @ v.T
    return np.asarray(force.reshape(bearings, 3, q.shape[0]))


def _mesh_frequency(system: System, speed: FloatArray) -> FloatArray:
    """Return base pitches per second in the kinematic motion, (m, T)."""
    reference = system.arrays.reference
    per_revolution = np.abs(reference.numerator / reference.denominator)
    return np.asarray(per_revolution[:, None] * np.abs(speed) / (2.0 * math.pi))


def _static(system: System, position: FloatArray) -> FloatArray:
    """Transmission error at the nominal force, (m, T)."""
    static = np.empty_like(position)
    for f, force in enumerate(system.flanks.nominal_force):
        static_deflections(system.flanks.static, f, position[f], float(force), static[f])
    return static


def _speed(system: System, drive: FloatArray, v: FloatArray) -> FloatArray:
    """Speed of every shaft about +z, (s, T)."""
    speed = np.array([float(ratio) for ratio in system.kinematics.ratio])[:, None] * drive
    for column, place in enumerate(system.freedoms.place):
        if place % 6 == 5:
            speed[place // 6] += v[:, column]
    return speed


def _drive_torque(
    system: System, time: FloatArray, acceleration: FloatArray, force: FloatArray
) -> FloatArray:
    """Torque that imposes the motion: inertia of its shaft, meshes and loads on it, (T,)."""
    arrays = system.arrays
    torque = arrays.drive_inertia * acceleration + arrays.drive_direction @ force
    for row, load in enumerate(system.scene.loads):
        torque -= arrays.load.drive[row] * load.torque(time)
    return np.asarray(torque)
