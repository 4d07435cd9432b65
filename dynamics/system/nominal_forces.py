"""Mesh forces that carry the load in the kinematic motion."""

from __future__ import annotations

import numpy as np

from dynamics.errors import InputError
from dynamics.system.kinematics import Kinematics
from dynamics.system.scene import Scene
from dynamics.types import FloatArray


def nominal_forces(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Return the transverse force of each mesh, N: as given, or what balances the load torques at t = 0.

    Raises
    ------
    InputError
        If the balance does not determine a force that is needed, or a load pulls the flanks apart.
    """
    given = [mesh.nominal_force for mesh in scene.meshes]
    if all(force is not None for force in given):
        return np.array(given, dtype=float)
    balanced = _balance(scene, kinematics)
    return np.array([b if g is None else g for g, b in zip(given, balanced, strict=True)], dtype=float)


def _balance(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Solve the torque balance of all shafts but the drive's."""
    lever = np.zeros((len(scene.shafts), len(scene.meshes)))
    for column, mesh in enumerate(scene.meshes):
        driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
        sense = kinematics.sense[scene.shaft_index(driver.shaft)]
        lever[scene.shaft_index(driver.shaft), column] = sense * driver.base_radius
        lever[scene.shaft_index(driven.shaft), column] = sense * driven.base_radius
    torque = np.zeros(len(scene.shafts))
    for load in scene.loads:
        shaft = scene.shaft_index(load.shaft)
        torque[shaft] -= kinematics.sense[shaft] * float(load.torque(0.0))
    free = [index for index in range(len(scene.shafts)) if index != kinematics.drive]
    force, _, rank, _ = np.linalg.lstsq(lever[free], torque[free], rcond=None)
    suggestion = "Give every mesh its nominal_force."
    if rank < len(scene.meshes):
        raise InputError("meshes", len(scene.meshes), "loaded in one way only by the torques", suggestion)
    for index, value in enumerate(force):
        if value < -1e-9 * np.max(np.abs(force)):
            raise InputError(
                f"meshes[{index}]", f"{value:.6g} N", "loaded on its driving flank", "Turn the load."
            )
    return np.asarray(np.maximum(force, 0.0), dtype=float)
