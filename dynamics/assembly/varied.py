"""An assembled system with other tables, a later start, or the static reference where it rests."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.forces.elements import SPATIAL_FLANK
from dynamics.kernels.by_address import by_address
from dynamics.mechanism.flanks import mean_stiffness, with_technique
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.technique import table_at, table_at_operating_point
from dynamics.motion.motion import QUANTA_PER_TURN
from dynamics.motion.observation import local_state
from dynamics.types import FloatArray, IntArray


def with_decimated_tables(system: System, every: int = 2) -> System:
    """Return `system` on each `every`-th position node of all tables that its flanks use."""
    elements = system.arrays.elements
    flank, spatial = elements.laws.flank, elements.laws.spatial_flank
    laws = elements.laws._replace(
        flank=flank._replace(table=flank.table.decimated(every)),
        spatial_flank=spatial._replace(grid=spatial.grid.decimated(every)),
    )
    changed = by_address(elements._replace(laws=laws))
    return replace(system, arrays=by_address(system.arrays._replace(elements=changed)))


def with_flank(system: System, mesh: int, table: MeshTable) -> System:
    """Return `system` with another table of a driving flank; which effects act is not decided anew.

    Raises `InputError`: the table has several operating points, or cannot have the technique of the mesh.

    Parameters
    ----------
    mesh : int
        Its index in the scene.
    table : MeshTable
        At one misalignment and center distance.
    """
    if np.size(table.misalignment) > 1 or np.size(table.center_distance_change) > 1:
        raise InputError("table", "several operating points", "a table at one of them")
    elements, flanks, part = system.arrays.elements, system.flanks, system.scene.meshes[mesh]
    point = float(table.misalignment[0]), float(table.center_distance_change[0])
    used = with_technique(part.technique, table_at(table, *point), float(flanks.nominal_force[mesh]))
    force = float(flanks.nominal_force[mesh]) or float(used.level[1])
    stiffness = mean_stiffness(used, force)
    damped = 1.0 if part.damping is not None else (stiffness / flanks.mean_stiffness[mesh]) ** 0.5
    plain, spatial = elements.laws.flank, elements.laws.spatial_flank
    plain = plain._replace(
        table=by_address(plain.table.with_table(mesh, used)), damping=_scaled(plain.damping, mesh, damped)
    )
    if elements.law[mesh] == SPATIAL_FLANK:
        entry = int(elements.entry[mesh])
        spatial = spatial._replace(
            grid=spatial.grid.with_table(entry, used), damping=_scaled(spatial.damping, entry, damped)
        )
    changed = by_address(elements._replace(laws=elements.laws._replace(flank=plain, spatial_flank=spatial)))
    tables = tuple(used if index == mesh else own for index, own in enumerate(flanks.tables))
    return replace(
        system,
        arrays=by_address(system.arrays._replace(elements=changed)),
        flanks=replace(
            flanks,
            law=plain,
            tables=tables,
            mean_stiffness=_scaled(flanks.mean_stiffness, mesh, stiffness / flanks.mean_stiffness[mesh]),
        ),
    )


def _scaled(values: FloatArray, index: int, factor: float) -> FloatArray:
    """Return values with one of them times a factor."""
    return np.where(np.arange(values.size) == index, factor * values, values)


def starting_at(system: System, time: float, moved: IntArray) -> System:
    """Return `system` as it is from `time` (s) on, with that time as 0.

    `moved` (k,) counts the quanta of free trains that are in the reference by then.
    """
    arrays, reference = system.arrays, system.arrays.reference
    pieces = np.diff(reference.speed.first)
    turned = np.repeat(moved, pieces)
    fraction = reference.fraction + (turned % QUANTA_PER_TURN) / QUANTA_PER_TURN
    moved_on = reference._replace(
        speed=reference.speed._replace(start=reference.speed.start - time),
        whole=reference.whole + turned // QUANTA_PER_TURN,
        fraction=fraction,
    )
    torque = arrays.load.torque
    load = arrays.load._replace(torque=torque._replace(start=torque.start - time))
    laws = arrays.elements.laws
    elements = arrays.elements._replace(
        laws=laws._replace(applied_force=laws.applied_force.starting_at(time))
    )
    return replace(
        system, arrays=by_address(arrays._replace(reference=moved_on, load=load, elements=elements))
    )


def _operating_points_at(system: System, displacement: FloatArray, time: float = 0.0) -> FloatArray:
    """Return misalignment and center-distance change of every mesh in m, (m, 2).

    Those of the bodies displaced by `displacement` (n,) where the mesh's table follows them, else the mesh's
    constant ones.
    """
    elements, laws = system.arrays.elements, system.arrays.elements.laws.spatial_flank
    points = np.array(
        [[mesh.misalignment, mesh.center_distance_change] for mesh in system.scene.meshes]
    ).reshape(-1, 2)
    spatial = np.flatnonzero(elements.law[: points.shape[0]] == SPATIAL_FLANK)
    if spatial.size == 0:
        return points
    rest = np.zeros(displacement.size)
    coordinate = local_state(system.arrays, time, displacement, rest).coordinate
    for index in spatial:
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
    points = _operating_points_at(system, displacement, time)
    moved = np.any(points != fixed, axis=1)
    if not np.any(moved):
        return system
    tables = [
        (table_at_operating_point if moves else table_at)(mesh.table, float(m), float(a))
        for mesh, moves, (m, a) in zip(system.scene.meshes, moved, points, strict=True)
    ]
    return replace(system, flanks=replace(system.flanks, static=pack_tables(tables)))
