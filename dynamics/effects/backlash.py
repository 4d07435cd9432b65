"""Backlash: behind the driving flank there is a gap, and behind it the coast flank."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from dynamics.effects.effect import MeshEffect, Verdict
from dynamics.effects.loaded_parts import LoadedMesh
from dynamics.errors import InputError
from dynamics.mechanism.additions import COAST_FLANKS
from dynamics.mechanism.flanks import Flanks, mesh_mobility, with_technique
from dynamics.meshes.flank_force import FlankLaws
from dynamics.meshes.gear_mesh import GearMesh
from dynamics.meshes.packed_tables import pack_tables
from dynamics.meshes.table_lookup import table_deflection
from dynamics.meshes.technique import PlainTable, mirrored, table_at


class Backlash(MeshEffect):
    """One force element per mesh: the coast flank."""

    name = "backlash"
    in_statics = False
    adds = (COAST_FLANKS,)
    cost = "one table look-up per mesh and stage"
    linear = False

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for the effect where the run can take the load off the driving flank.

        Flanks part when the dynamic force is as large as the mean force. The mean force balances loads and
        the inertia of the imposed motion; its least value over the run counts. The dynamic force of one
        harmonic is bounded by half the peak-to-peak transmission error times the mesh stiffness, amplified by
        1/(2 zeta) as in resonance.
        """
        if mesh.mesh.coast is None:
            return Verdict(False, False, "no coast flank given: lift-off has no limit", 0.0)
        backlash, minimum = mesh.mesh.coast.backlash, float(np.min(mesh.train.mean_force[mesh.index]))
        if minimum <= 0.0:
            reason = f"the load reverses: the mean force falls to {minimum:.4g} N"
            return Verdict(True, True, reason, backlash)
        swing = _force_swing(mesh)
        text = f"the mean force stays above {minimum:.4g} N, resonance changes it by up to "
        if swing >= minimum:
            return Verdict(True, True, f"{text}{swing:.4g} N: flanks can lift off", backlash)
        return Verdict(False, True, f"{text}{swing:.4g} N only: flanks stay in contact", 0.0)

    def extend(self, flanks: Flanks, meshes: Sequence[GearMesh], on: Sequence[int]) -> Flanks:
        """Return `flanks` with the coast flanks of the meshes `on`, damped as their driving flanks."""
        if not on:
            return flanks
        backs = []
        for index in on:
            try:
                backs.append(_coast_table(meshes[index], flanks, index))
            except InputError as error:
                raise error.within(f"meshes[{index}]") from None
        chosen = [*range(len(meshes)), *on]
        tables = (*flanks.used, *backs)
        law = FlankLaws(pack_tables(tables), flanks.law.damping[chosen], flanks.law.reach[chosen])
        return replace(flanks, law=law, coast=tuple(on), tables=tables)


def _force_swing(mesh: LoadedMesh) -> float:
    """Return half the peak-to-peak transmission error times stiffness, amplified as in resonance, N."""
    mechanism, flanks, index = mesh.train.mechanism, mesh.train.flanks, mesh.index
    damping = float(flanks.law.damping[index])
    mass = 1.0 / mesh_mobility(mechanism, index)
    ratio = damping / (2.0 * math.sqrt(mesh.stiffness * mass))
    positions = flanks.used[index].position
    error = [table_deflection(flanks.static, index, x, mesh.force) for x in positions]
    swing = mesh.stiffness * (0.5 * float(np.ptp(error)))
    return swing / (2.0 * ratio) if ratio > 0.0 else (math.inf if swing > 0.0 else 0.0)


def _coast_table(mesh: GearMesh, flanks: Flanks, index: int) -> PlainTable:
    """Return the table of a coast flank against the position of the driving flank.

    A coast flank is a driving flank seen turned about the line of centers, so that a misalignment opens its
    gap towards the other end of the face.
    """
    back = mesh.coast
    if back is None:
        raise InputError("coast", None, "given", "Give the backlash and the thickness of the driver's teeth.")
    if back.table is None and np.size(mesh.table.misalignment) == 1:
        return mirrored(flanks.used[index], back.thickness)
    table = table_at(back.table or mesh.table, -mesh.misalignment, mesh.center_distance_change)
    used = with_technique(mesh.technique, table, float(flanks.nominal_force[index]))
    return mirrored(used, back.thickness)
