"""Force laws of all flanks: table at its operating point, technique applied, damping filled in.

The technique of a mesh says how its force follows from its table: by the table itself ("variable_torque") or
by its secant at the nominal force.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.errors import InputError
from dynamics.mechanism.mechanism import Mechanism
from dynamics.meshes.flank_force import FlankLaws
from dynamics.meshes.packed_tables import BUCKETS_PER_KNOT, PackedTables, pack_tables
from dynamics.meshes.table_lookup import read_tangents
from dynamics.meshes.technique import PlainTable, secant_table, table_at
from dynamics.types import FloatArray

DAMPING_REACH = 0.05
"""Damping acts in full from this fraction of the typical force on."""


@dataclass(frozen=True)
class Flanks:
    """Resolved force laws of the driving flanks of m meshes, and after them of the coast flanks in use."""

    nominal_force: FloatArray
    """Nominal transverse mesh force, N. Shape (m,)."""
    mean_stiffness: FloatArray
    """Tangent stiffness of the table at the typical force, mean over the positions, N/m. Shape (m,)."""
    used: tuple[PlainTable, ...]
    """The tables after the mesh's technique."""
    law: FlankLaws
    """Table, damping (N s/m) and reach (N), for the compiled loops."""
    coast: tuple[int, ...]
    """Indices of the meshes whose coast flanks come after the driving flanks, in their order."""
    static: PackedTables
    """The driving flanks' tables themselves, whatever the technique: the static reference."""
    tables: tuple[PlainTable, ...]
    """Tables of `law`, each at its mesh's constant operating point."""


def flank_laws(mechanism: Mechanism) -> Flanks:
    """Resolve the force law of every driving flank.

    Stiffness and damping are those at the typical force: the nominal one, and where nothing loads a mesh the
    lowest load of its table. A line contact has no stiffness at lift-off, and idle gears would not be damped.
    """
    scene, nominal = mechanism.scene, mechanism.nominal_force
    static: list[PlainTable] = []
    used: list[PlainTable] = []
    for index, mesh in enumerate(scene.meshes):
        try:
            static.append(table_at(mesh.table, mesh.misalignment, mesh.center_distance_change))
            used.append(with_technique(mesh.technique, static[-1], nominal[index]))
        except InputError as error:
            raise error.within(f"meshes[{index}]") from None
    packed = pack_tables(static)
    lowest_load = [table.level[1] for table in static]  # level 0 is lift-off, without load
    row_stiffness = np.where(nominal > 0.0, nominal, lowest_load)
    stiffness = np.array([mean_stiffness(packed, index, force) for index, force in enumerate(row_stiffness)])
    damping = [  # given, or from the damping ratio of the mesh as an oscillator: c = 2 zeta sqrt(k m)
        2.0 * mesh.damping_ratio * float(np.sqrt(stiffness[f] / mesh_mobility(mechanism, f)))
        if mesh.damping is None
        else mesh.damping
        for f, mesh in enumerate(scene.meshes)
    ]
    # without a secant among them the tables are the static ones, already packed
    alike = all(table_used is table for table_used, table in zip(used, static, strict=True))
    law = FlankLaws(packed if alike else pack_tables(used), np.array(damping), DAMPING_REACH * row_stiffness)
    return Flanks(
        nominal_force=nominal,
        mean_stiffness=stiffness,
        used=tuple(used),
        law=law,
        coast=(),
        static=packed,
        tables=tuple(used),
    )


def mean_stiffness(tables: PackedTables, flank: int, force: float) -> float:
    """Return the tangent stiffness of a flank at `force` (N), mean over the knots of its table, N/m."""
    # first knot, first bucket, number of buckets, ...
    knot, _, buckets, *_ = (int(value) for value in tables.offset[flank])
    position = tables.shift[flank] + tables.knot[knot : knot + buckets // BUCKETS_PER_KNOT]
    stiffness = np.empty(position.size)
    read_tangents(tables, flank, position, force, stiffness)
    return float(np.mean(stiffness))


def with_technique(technique: str, table: PlainTable, force: float) -> PlainTable:
    """Return the table that a mesh of the nominal `force` (N) runs on."""
    if technique == "variable_torque":
        return table
    if force <= 0.0:
        suggestion = 'Load the mesh, give nominal_force, or use "variable_torque".'
        raise InputError("technique", technique, "used with a nominal force", suggestion)
    return secant_table(table, force)


def mesh_mobility(mechanism: Mechanism, index: int) -> float:
    """Return the inverse of the effective mass of both gears of a mesh along its line of action, 1/kg.

    It is the sum of base radius squared over polar inertia; a gear with imposed motion adds nothing.
    """
    scene, mobility = mechanism.scene, 0.0
    for name in (scene.meshes[index].driver, scene.meshes[index].driven):
        gear = scene.gear(name)
        shaft = scene.shaft_index(gear.shaft)
        if shaft not in mechanism.kinematics.imposed:
            mobility += gear.base_radius**2 / mechanism.rotors[shaft].inertia.polar
    return mobility
