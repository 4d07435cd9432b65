"""The static reference where the bodies rest: tables read at the misalignment and center distance there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.forces.elements import SPATIAL_FLANK
from dynamics.meshes.operating_point_table import table_at_operating_point
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.technique import table_at
from dynamics.motion.observation import local_state
from dynamics.types import FloatArray


def operating_points_at(system: System, displacement: FloatArray, time: float = 0.0) -> FloatArray:
    """Return misalignment and center-distance change of every mesh in m, (m, 2).

    Those of the bodies displaced by `displacement` (n,) where the mesh's table follows them, else the mesh's
    constant ones.
    """
    rest = np.zeros(displacement.size)
    coordinate = local_state(system.arrays, time, displacement, rest).coordinate
    elements, laws = system.arrays.elements, system.arrays.elements.laws.spatial_flank
    points = np.array(
        [[mesh.misalignment, mesh.center_distance_change] for mesh in system.scene.meshes]
    ).reshape(-1, 2)
    for index in range(points.shape[0]):
        if elements.law[index] != SPATIAL_FLANK:
            continue
        entry = elements.entry[index]
        for axis in range(2):
            if laws.row[entry, axis] > 0 and laws.follows[entry, axis] == 1:
                points[index, axis] = coordinate[elements.first[index] + laws.row[entry, axis]]
    return points


def with_static_reference(system: System, displacement: FloatArray, time: float = 0.0) -> System:
    """Return `system` with the static transmission errors of meshes that follow their bodies at rest.

    Where no table follows the bodies it is `system` itself.
    """
    fixed = np.array(
        [[mesh.misalignment, mesh.center_distance_change] for mesh in system.scene.meshes]
    ).reshape(-1, 2)
    points = operating_points_at(system, displacement, time)
    moved = np.any(points != fixed, axis=1)
    if not np.any(moved):
        return system
    tables = [
        (table_at_operating_point if moves else table_at)(mesh.table, float(m), float(a))
        for mesh, moves, (m, a) in zip(system.scene.meshes, moved, points, strict=True)
    ]
    return replace(system, flanks=replace(system.flanks, static=pack_tables(tables)))
