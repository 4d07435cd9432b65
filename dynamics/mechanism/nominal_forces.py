"""Mesh forces that carry the load in the kinematic motion."""

from __future__ import annotations

import numpy as np

from bounds import Quantity
from dynamics.arrays.law_arrays import slope
from dynamics.errors import InputError
from dynamics.loads.load_course import BySpeed, mean_factor
from dynamics.loads.time_law import TimeLaw
from dynamics.mechanism.kinematics import Kinematics, mesh_shafts
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

BETWEEN_KNOTS = 8  # moments at which a law is looked at between two of its knots


def nominal_forces(scene: Scene, kinematics: Kinematics, inertia: FloatArray, *, coasts: bool) -> FloatArray:
    """Return the transverse force of each mesh, N: as given, or what balances the load torques at t = 0.

    `inertia` (shafts,) in kg m^2 is that of each shaft about its axis and, on a carrier, of the planets about
    the carrier's: a train without a drive accelerates where its torques do not balance. `coasts`: whether the
    coast flanks that are given carry load.

    Raises
    ------
    InputError
        If the balance does not determine a force that is needed, or a load pulls flanks apart that have no
        coast flank behind them.
    """
    stated = [mesh.nominal_force for mesh in scene.meshes]
    if all(force is not None for force in stated):
        return np.array(stated, dtype=float)
    balanced = _balance(scene, kinematics, inertia, coasts)
    return np.array([b if g is None else g for g, b in zip(stated, balanced, strict=True)], dtype=float)


def _balance(scene: Scene, kinematics: Kinematics, inertia: FloatArray, coasts: bool) -> FloatArray:
    """Solve the torque balance of all shafts but those of drives.

    Planets that share a load on equal terms share it equally: the solution of least squares.
    """
    lever = _levers(scene, kinematics)
    torque = _loads(scene, kinematics, np.zeros(1))[:, 0]
    torque -= inertia * _acceleration(scene, kinematics, inertia, torque)
    free = _free_shafts(scene, kinematics)
    force, _, rank, _ = np.linalg.lstsq(lever[free], torque[free], rcond=1e-12)
    suggestion = "Give every mesh its nominal_force."
    if rank < lever.shape[1] and all(shaft.frame is None for shaft in scene.shafts):
        raise InputError("meshes", len(scene.meshes), "loaded in one way only by the torques", suggestion)
    force = force[: len(scene.meshes)]
    driving_only = [mesh.coast is None or not coasts for mesh in scene.meshes]
    for index, value in enumerate(force):
        if value < -1e-9 * np.max(np.abs(force)) and driving_only[index]:
            bound, suggestion = "loaded on its driving flank", "Turn the load, or give it its coast flank."
            raise InputError(f"meshes[{index}]", Quantity(float(value), "N", digits=6), bound, suggestion)
    return np.asarray(np.where(driving_only, np.maximum(force, 0.0), np.abs(force)), dtype=float)


def mean_forces(scene: Scene, kinematics: Kinematics, inertia: FloatArray, moments: FloatArray) -> FloatArray:
    """Return what balances loads and imposed accelerations at `moments` (T,), (m, T) in N.

    Negative: the coast flank carries it. Where the balance leaves a choice, the one of least forces.
    """
    torque = _loads(scene, kinematics, moments)
    imposed = np.array([slope(drive.speed, moments) for drive in scene.drives]).reshape(-1, moments.size)
    ratio = kinematics.float_ratio[:, : len(scene.drives)]
    torque -= inertia[:, None] * (ratio @ imposed)
    torque -= inertia[:, None] * _acceleration(scene, kinematics, inertia, torque)
    free = _free_shafts(scene, kinematics)
    lever = _levers(scene, kinematics)[free]
    force = np.linalg.lstsq(lever, torque[free], rcond=1e-12)[0]
    return np.asarray(force[: len(scene.meshes)], dtype=float)


def telling_moments(scene: Scene) -> FloatArray:
    """Return times that show how loads and drives run: the laws' knots, just before them, and between."""
    courses = [force.course for force in scene.forces if isinstance(force.course, TimeLaw)]
    laws = [*(drive.speed for drive in scene.drives), *(load.torque for load in scene.loads), *courses]
    stated = np.concatenate([np.empty(0), *(np.asarray(law.time, dtype=float) for law in laws)])
    inside = stated[(stated > 0.0) & (stated < scene.duration)]
    knots = np.unique(np.concatenate([[0.0, scene.duration], inside]))
    part = np.linspace(0.0, 1.0, BETWEEN_KNOTS, endpoint=False)
    between = knots[:-1, None] + np.diff(knots)[:, None] * part
    return np.concatenate([knots[:1], between.ravel(), np.nextafter(knots[1:], 0.0)])


def _free_shafts(scene: Scene, kinematics: Kinematics) -> list[int]:
    """Shafts but those of drives."""
    driven = set(kinematics.law_shaft[: len(scene.drives)])
    return [index for index in range(len(scene.shafts)) if index not in driven]


def _loads(scene: Scene, kinematics: Kinematics, moments: FloatArray) -> FloatArray:
    """Mean load torque about +z on every shaft at `moments` (T,), (s, T)."""
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


def _levers(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Torque on each shaft per mesh force (m) and per torque of a coupling, (shafts, meshes + couplings).

    The planets' centers go with the carrier, so that a mesh turns it by the difference of what it turns
    both gears by.
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


def _acceleration(
    scene: Scene, kinematics: Kinematics, inertia: FloatArray, torque: FloatArray
) -> FloatArray:
    """Angular acceleration of each shaft of trains without a drive, rad/s^2, shaped as `torque` (s, ...)."""
    ratio = kinematics.float_ratio[:, len(scene.drives) :]
    if ratio.shape[1] == 0:
        return np.zeros_like(torque)
    law = np.linalg.solve(ratio.T @ (inertia[:, None] * ratio), ratio.T @ torque)
    return np.asarray(ratio @ law)
