"""What effects of a mesh decide on: how its load runs, and how far vibration can swing it."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.assembly.flanks import Flanks, mesh_mobility
from dynamics.effects import LoadedMesh, MeshAxes
from dynamics.forces.table_lookup import table_deflection
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.nominal_forces import mean_forces, telling_moments
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def loaded_meshes(
    scene: Scene,
    kinematics: Kinematics,
    flanks: Flanks,
    polar_inertia: Sequence[float],
    inertia: FloatArray,
    axes: Sequence[MeshAxes],
) -> list[LoadedMesh]:
    """Gather the facts of every mesh; `inertia` (s,) is that of `nominal_forces`."""
    if all(mesh.coast is None for mesh in scene.meshes):
        return [LoadedMesh(mesh.name, 0.0, 0.0, None, axes[i]) for i, mesh in enumerate(scene.meshes)]
    force = mean_forces(scene, kinematics, inertia, telling_moments(scene))
    found = []
    for index, mesh in enumerate(scene.meshes):
        stiffness, damping = float(flanks.mean_stiffness[index]), float(flanks.law.damping[index])
        mass = 1.0 / mesh_mobility(scene, kinematics, index, polar_inertia)
        ratio = damping / (2.0 * math.sqrt(stiffness * mass))
        swing = stiffness * _half_ripple(flanks, index)
        amplified = swing / (2.0 * ratio) if ratio > 0.0 else (math.inf if swing > 0.0 else 0.0)
        backlash = mesh.coast.backlash if mesh.coast is not None else None
        found.append(LoadedMesh(mesh.name, float(np.min(force[index])), amplified, backlash, axes[index]))
    return found


def _half_ripple(flanks: Flanks, index: int) -> float:
    """Half the peak-to-peak transmission error at the nominal force, m."""
    force, positions = float(flanks.nominal_force[index]), flanks.used[index].position
    return 0.5 * float(np.ptp([table_deflection(flanks.static, index, x, force) for x in positions]))
