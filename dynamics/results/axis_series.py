"""Misalignment, center distance and point of application of the load of the driving flanks over time."""

from __future__ import annotations

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.forces.element_laws import SPATIAL_FLANK
from dynamics.mechanism.additions import CENTER_DISTANCE_CHANGE, LOAD_CENTROID, MISALIGNMENT
from dynamics.mechanism.flank_gradients import common_face_width, table_sense
from dynamics.types import FloatArray

FIELDS = (MISALIGNMENT, CENTER_DISTANCE_CHANGE)
"""Axes of tables, as meshes and effects name them."""


def axis_series(system: System, coordinate: FloatArray, force: FloatArray) -> dict[str, FloatArray]:
    """Return `misalignment`, `center_distance_change` and `load_centroid`, (m, T) in m.

    `coordinate` and `force` (R, T) are those of all rows. A series is (0, T) if its effect is on in no mesh.
    """
    meshes, samples = len(system.scene.meshes), force.shape[1]
    series = {}
    for axis, field in enumerate(FIELDS):
        fixed = np.array([getattr(mesh, field) for mesh in system.scene.meshes])
        values = np.repeat(fixed[:, None], samples, axis=1)
        for mesh, row in axis_rows(system, axis, follows=True).items():
            values[mesh] = coordinate[row]
        series[field] = values if system.ledger.adds(field) else np.empty((0, samples))
    centroid = np.zeros((meshes if system.ledger.adds(LOAD_CENTROID) else 0, samples))
    if centroid.size:
        for mesh, row in axis_rows(system, 0, follows=False).items():
            pushed = force[system.driving_rows[mesh]]
            lever = -force[row] / np.where(pushed > 0.0, pushed, 1.0)
            sense = table_sense(system.scene, mesh, system.kinematics.mesh_sense[mesh])
            centroid[mesh] = -sense * common_face_width(system.scene, mesh) * lever
    return {**series, LOAD_CENTROID: centroid}


def axis_rows(system: System, axis: int, *, follows: bool) -> dict[int, int]:
    """Return the row of an axis of each driving flank that has one; if `follows`, of those that read it."""
    elements, laws = system.arrays.elements, system.arrays.elements.laws.spatial_flank
    rows = {}
    for mesh in range(len(system.scene.meshes)):
        if elements.law[mesh] != SPATIAL_FLANK:
            continue
        row = laws.row[elements.entry[mesh], axis]
        if row > 0 and (laws.follows[elements.entry[mesh], axis] == 1 or not follows):
            rows[mesh] = int(elements.first[mesh] + row)
    return rows
