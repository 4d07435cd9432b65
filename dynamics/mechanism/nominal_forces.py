"""Mesh forces that carry the loads in the kinematic motion at t = 0."""

from __future__ import annotations

import numpy as np

from bounds import Quantity
from dynamics.errors import InputError
from dynamics.loads.load_course import BySpeed, mean_factor
from dynamics.mechanism.kinematics import Kinematics, mesh_shafts
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def nominal_forces(scene: Scene, kinematics: Kinematics, inertia: FloatArray, *, coasts: bool) -> FloatArray:
    """Return the transverse force of each mesh, N: as given, or as it balances the load torques at t = 0.

    `inertia` (shafts,) in kg m^2 is that of each shaft about its axis and, on a carrier, of the planets about
    the carrier's: a train without a drive accelerates where its torques do not balance. `coasts`: whether the
    coast flanks that are given carry load. Raises `InputError`: the balance does not determine a force that
    is needed, or a load pulls flanks apart that have no coast flank behind them.
    """
    specified = [mesh.nominal_force for mesh in scene.meshes]
    if all(force is not None for force in specified):
        return np.array(specified, dtype=float)
    # the balance of all shafts but those of drives; by least squares planets share a load equally
    lever = levers(scene, kinematics)
    torque = load_moments(scene, kinematics, np.zeros(1))[:, 0]
    torque -= inertia * shaft_acceleration(scene, kinematics, inertia, torque)
    free = shafts_without_drive(scene, kinematics)
    force, _, rank, _ = np.linalg.lstsq(lever[free], torque[free], rcond=1e-12)
    suggestion = "Give every mesh its nominal_force."
    # shafts in rotating frames are planetary sets, whose planets share the load
    if rank < lever.shape[1] and all(shaft.frame is None for shaft in scene.shafts):
        raise InputError("meshes", len(scene.meshes), "loaded in one way only by the torques", suggestion)
    force = force[: len(scene.meshes)]
    driving_only = [mesh.coast is None or not coasts for mesh in scene.meshes]
    for index, value in enumerate(force):
        if value < -1e-9 * np.max(np.abs(force)) and driving_only[index]:  # smaller: rounding
            bound, suggestion = "loaded on its driving flank", "Turn the load, or give it its coast flank."
            raise InputError(f"meshes[{index}]", Quantity(float(value), "N", digits=6), bound, suggestion)
    balanced = np.where(driving_only, np.maximum(force, 0.0), np.abs(force))
    pairs = zip(specified, balanced, strict=True)
    return np.array([balance if force is None else force for force, balance in pairs], dtype=float)


def shafts_without_drive(scene: Scene, kinematics: Kinematics) -> list[int]:
    """Return the indices of the shafts that no drive turns."""
    driven = set(kinematics.law_shaft[: len(scene.drives)])
    return [index for index in range(len(scene.shafts)) if index not in driven]


def load_moments(scene: Scene, kinematics: Kinematics, moments: FloatArray) -> FloatArray:
    """Return the mean load torque about +z on every shaft at the times `moments` (T,), (s, T)."""
    torque = np.zeros((len(scene.shafts), moments.size))
    for load in scene.loads:
        shaft = scene.shaft_index(load.shaft)
        torque[shaft] -= kinematics.sense[shaft] * load.torque(moments)
    laws = np.array([part.speed(moments) for part in scene.references])
    for part in scene.speed_torques:
        shaft = scene.shaft_index(part.shaft)
        sense = kinematics.sense[shaft]
        torque[shaft] -= sense * part.curve(sense * (kinematics.float_ratio[shaft] @ laws))
    for force in scene.forces:
        speed = 0.0
        if isinstance(force.course, BySpeed):
            shaft = scene.shaft_index(force.course.shaft)
            speed = kinematics.sense[shaft] * (kinematics.float_ratio[shaft] @ laws)
        shaft = scene.shaft_index(force.shaft)
        torque[shaft] += force.moment[2] * mean_factor(force.course, moments, speed)
    return torque


def levers(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Return the torque on each shaft per mesh force, m, and per torque of a coupling, 1.

    Shape (shafts, meshes + couplings). The planets' centers move with the carrier, so that the torque of a
    mesh on the carrier balances those on its two gears.
    """
    couplings = [coupling for coupling in scene.couplings if coupling.joins_rotations]
    lever = np.zeros((len(scene.shafts), len(scene.meshes) + len(couplings)))
    for column, coupling in enumerate(couplings, start=len(scene.meshes)):
        lever[scene.shaft_index(coupling.first), column] = 1.0
        lever[scene.shaft_index(coupling.second), column] = -1.0
    for column, mesh in enumerate(scene.meshes):
        driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
        a, b, carrier = mesh_shafts(scene, column)
        sense = kinematics.mesh_sense[column]
        turned_back = -1.0 if driver.internal or driven.internal else 1.0
        lever[a, column] += sense * driver.base_radius
        lever[b, column] += sense * turned_back * driven.base_radius
        if carrier is not None:
            lever[carrier, column] -= sense * (driver.base_radius + turned_back * driven.base_radius)
    return lever


def shaft_acceleration(
    scene: Scene, kinematics: Kinematics, inertia: FloatArray, torque: FloatArray
) -> FloatArray:
    """Return the angular acceleration of shafts in trains without a drive, rad/s^2, shaped as `torque`."""
    ratio = kinematics.float_ratio[:, len(scene.drives) :]
    if ratio.shape[1] == 0:
        return np.zeros_like(torque)
    law = np.linalg.solve(ratio.T @ (inertia[:, None] * ratio), ratio.T @ torque)
    return np.asarray(ratio @ law)
