"""An assembled system with other tables, a later start, or the static reference where it rests."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.forces.elements import SPATIAL_FLANK
from dynamics.kernels.by_address import by_address
from dynamics.mechanism.flanks import mean_stiffness, with_technique
from dynamics.meshes.flank_force import FlankLaws
from dynamics.meshes.mesh_table import MeshTable
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.spatial_flank import SpatialFlankLaws
from dynamics.meshes.technique import PlainTable, table_at, table_at_operating_point
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
        Index of the mesh in the scene.
    table : MeshTable
        Table at one misalignment and center distance.
    """
    used = _used_table(system, mesh, table)
    plain, spatial = _laws(system)
    # `_damped_system` writes into the copies of the damping, not into those of `system`
    plain = plain._replace(table=by_address(plain.table.with_table(mesh, used)), damping=plain.damping.copy())
    elements = system.arrays.elements
    if elements.law[mesh] == SPATIAL_FLANK:
        grid = spatial.grid.with_table(int(elements.entry[mesh]), used)
        spatial = spatial._replace(grid=grid, damping=spatial.damping.copy())
    changed = by_address(elements._replace(laws=elements.laws._replace(flank=plain, spatial_flank=spatial)))
    arrays = by_address(system.arrays._replace(elements=changed))
    changed_system = replace(system, arrays=arrays, flanks=replace(system.flanks, law=plain))
    return _damped_system(changed_system, mesh, used)


def with_flanks(system: System, mesh: int, tables: Sequence[MeshTable]) -> Iterator[System]:
    """Yield `with_flank` for each of several tables of the same positions and number of levels.

    All results share arrays: each is valid until the next one is taken. Raises as `with_flank`.
    """
    changed_system = with_flank(system, mesh, tables[0])
    yield changed_system
    plain, spatial = _laws(changed_system)
    for table in tables[1:]:
        used = _used_table(changed_system, mesh, table)
        plain.table.overwrite(mesh, used)
        if changed_system.arrays.elements.law[mesh] == SPATIAL_FLANK:
            spatial.grid.overwrite(int(changed_system.arrays.elements.entry[mesh]), used)
        changed_system = _damped_system(changed_system, mesh, used)
        yield changed_system


def _laws(system: System) -> tuple[FlankLaws, SpatialFlankLaws]:
    return system.flanks.law, system.arrays.elements.laws.spatial_flank


def _used_table(system: System, mesh: int, table: MeshTable) -> PlainTable:
    """Return the table with the technique of a mesh."""
    if np.size(table.misalignment) > 1 or np.size(table.center_distance_change) > 1:
        raise InputError("table", "several operating points", "a table at one of them")
    point = float(table.misalignment[0]), float(table.center_distance_change[0])
    technique, force = system.scene.meshes[mesh].technique, float(system.flanks.nominal_force[mesh])
    return with_technique(technique, table_at(table, *point), force)


def _damped_system(system: System, mesh: int, used: PlainTable) -> System:
    """Return `system` with damping and mean stiffness of the table `used`, which its laws have already."""
    elements, flanks = system.arrays.elements, system.flanks
    force = float(flanks.nominal_force[mesh]) or float(used.level[1])  # no load: the first level above 0
    stiffness = mean_stiffness(flanks.law.table, mesh, force)
    if system.scene.meshes[mesh].damping is None:
        factor = (stiffness / flanks.mean_stiffness[mesh]) ** 0.5
        plain, spatial = _laws(system)
        plain.damping[mesh] *= factor
        if elements.law[mesh] == SPATIAL_FLANK:
            spatial.damping[elements.entry[mesh]] *= factor
    stiffnesses = np.where(np.arange(flanks.mean_stiffness.size) == mesh, stiffness, flanks.mean_stiffness)
    tables = tuple(used if index == mesh else table for index, table in enumerate(flanks.tables))
    return replace(system, flanks=replace(flanks, tables=tables, mean_stiffness=stiffnesses))


def starting_at(system: System, time: float, quanta: IntArray) -> System:
    """Return `system` as it is from `time` (s) on, with that time as 0.

    `quanta` (k,) counts, for each law of the kinematic motion, the parts 1/`QUANTA_PER_TURN` of a revolution
    of a train without a drive that the run has moved from the freedoms into the reference by then.
    """
    arrays, reference = system.arrays, system.arrays.reference
    pieces = np.diff(reference.speed.first)
    turned = np.repeat(quanta, pieces)
    fraction = reference.fraction + (turned % QUANTA_PER_TURN) / QUANTA_PER_TURN
    shifted = reference._replace(
        speed=reference.speed._replace(start=reference.speed.start - time),
        full_turns=reference.full_turns + turned // QUANTA_PER_TURN,
        fraction=fraction,
    )
    torque = arrays.load.torque
    load = arrays.load._replace(torque=torque._replace(start=torque.start - time))
    laws = arrays.elements.laws
    elements = arrays.elements._replace(
        laws=laws._replace(applied_force=laws.applied_force.starting_at(time))
    )
    return replace(
        system, arrays=by_address(arrays._replace(reference=shifted, load=load, elements=elements))
    )


def operating_points_at(system: System, displacement: FloatArray, time: float = 0.0) -> FloatArray:
    """Return misalignment and center-distance change of every mesh in m, (m, 2).

    Where the mesh's table follows the bodies, the values are those at `displacement` (n,), else the mesh's
    constants.
    """
    elements, laws = system.arrays.elements, system.arrays.elements.laws.spatial_flank
    points = np.array(
        [[mesh.misalignment, mesh.center_distance_change] for mesh in system.scene.meshes]
    ).reshape(-1, 2)
    spatial = np.flatnonzero(elements.law[: points.shape[0]] == SPATIAL_FLANK)
    if spatial.size == 0:
        return points
    no_velocity = np.zeros(displacement.size)
    coordinate = local_state(system.arrays, time, displacement, no_velocity).coordinate
    for index in spatial:
        entry = elements.entry[index]
        for axis in range(2):
            if laws.row[entry, axis] > 0 and laws.follows[entry, axis] == 1:
                points[index, axis] = coordinate[elements.first[index] + laws.row[entry, axis]]
    return points


def with_static_reference(system: System, displacement: FloatArray, time: float = 0.0) -> System:
    """Return `system` with static transmission errors at the operating points that bodies have at rest.

    They change for meshes whose tables follow the bodies; without any it is `system` itself.
    """
    fixed = np.array(
        [[mesh.misalignment, mesh.center_distance_change] for mesh in system.scene.meshes]
    ).reshape(-1, 2)
    points = operating_points_at(system, displacement, time)
    displaced = np.any(points != fixed, axis=1)
    if not np.any(displaced):
        return system
    tables = [
        (table_at_operating_point if moves else table_at)(mesh.table, float(m), float(a))
        for mesh, moves, (m, a) in zip(system.scene.meshes, displaced, points, strict=True)
    ]
    return replace(system, flanks=replace(system.flanks, static=pack_tables(tables)))
