"""Steady temperatures change center distance, backlash and misalignment of meshes."""

from __future__ import annotations

import numpy as np

from dynamics.effects.effect import MeshEffect, Verdict
from dynamics.effects.loaded_parts import LoadedMesh
from dynamics.mechanism.warm_meshes import warmed_meshes
from dynamics.scene.scene import Scene
from dynamics.temperatures import WarmMesh
from dynamics.types import FloatArray


class MeshTemperature(MeshEffect):
    """Another operating point of the table, and another backlash."""

    name = "mesh_temperature"
    in_statics = True
    cost = "none"

    def prepared(self, scene: Scene) -> Scene:
        """Return `scene` with its meshes at temperature."""
        return warmed_meshes(scene)

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for the effect wherever temperatures change a mesh.

        Its influence is the change of the mean transmission error by the operating point of the table, or of
        the backlash where the load reverses.
        """
        scene = mesh.train.mechanism.scene
        if scene.temperatures is None:
            return Verdict(False, False, "the scene has no temperatures", 0.0)
        warm = warmed_meshes(scene).temperatures
        assert warm is not None and warm.meshes is not None  # the scene has them
        change = warm.meshes[mesh.index]
        if not any(vars(change).values()):
            return Verdict(False, False, "temperatures change nothing of this mesh", 0.0)
        shift = np.array([change.misalignment, change.distance_change])
        point = np.array([mesh.mesh.misalignment, mesh.mesh.center_distance_change])
        # a scene whose temperatures list its meshes has them at temperature already
        shifted = point + (shift if scene.temperatures.meshes is None else -shift)
        influence = abs(_mean_error(mesh, point) - _mean_error(mesh, shifted))
        if mesh.mesh.coast is not None and np.min(mesh.train.mean_force[mesh.index]) <= 0.0:
            influence = max(influence, abs(change.backlash))
        return Verdict(True, True, _text(mesh, change), influence)


def _mean_error(mesh: LoadedMesh, point: FloatArray) -> float:
    """Return the mean transmission error under the nominal force at a `point` of the table's axes, m."""
    table = mesh.mesh.table
    # axes of `deflection`: misalignment, center distance, position, level; `mean` loses the last first
    mean: FloatArray = np.mean(np.asarray(table.deflection, dtype=float), axis=2)
    axes = (table.level, mesh.force), (table.center_distance_change, point[1]), (table.misalignment, point[0])
    for knots, value in axes:
        weights = [np.interp(value, knots, unit) for unit in np.eye(np.size(knots))]
        mean = mean @ np.array(weights)
    return float(mean)


def _text(mesh: LoadedMesh, change: WarmMesh) -> str:
    """Return the changes of a mesh in words, with those that the scene cannot follow."""
    table, coast = mesh.mesh.table, mesh.mesh.coast
    parts = [f"center distance {1e6 * change.distance_change:+.4g} µm against the gears"]
    if np.size(table.center_distance_change) == 1:
        parts.append("the table has one center distance only")
    parts.append(f"backlash {1e6 * change.backlash:+.4g} µm" if coast else "no coast flank given")
    if change.misalignment:
        parts.append(f"misalignment {1e6 * change.misalignment:+.4g} µm")
        if np.size(table.misalignment) == 1:
            parts.append("the table has one misalignment only")
    return "; ".join(parts)
