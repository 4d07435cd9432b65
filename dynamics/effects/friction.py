"""Sliding friction: the mesh force leaves the line of action, and work is lost."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from dynamics.effects.effect import MeshEffect, Verdict
from dynamics.effects.force_terms import SLIDING, FlankInSpace, FlankTerms
from dynamics.effects.loaded_parts import LoadedMesh
from dynamics.errors import InputError
from dynamics.mechanism.carried_planets import ROTATION
from dynamics.mechanism.columns import gear_row
from dynamics.mechanism.flank_gradients import table_sense
from dynamics.mechanism.line_of_action import UNIT_Z
from dynamics.mechanism.mechanism import Mechanism
from dynamics.types import FloatArray


class Friction(MeshEffect):
    """Two more local coordinates of a flank; their rates are its sliding."""

    name = "friction"
    in_statics = False
    cost = "two more rows per flank and eight more values per look-up"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for the effect where a coefficient is given; its influence is the largest friction torque."""
        coefficient = mesh.mesh.friction
        if coefficient is None:
            return Verdict(False, False, "no coefficient of friction given", 0.0)
        arm = getattr(mesh.mesh.table, "sliding_lever", None)
        if arm is None:
            return Verdict(False, False, "the table has no sliding data", 0.0)
        radius = mesh.train.mechanism.scene.gear(mesh.mesh.driven).base_radius
        share = coefficient * float(np.max(np.asarray(arm))) / radius
        reason = f"a coefficient of {coefficient:g} is given"
        return Verdict(True, True, reason, share * mesh.force / mesh.stiffness)

    def check(self, mechanism: Mechanism) -> None:
        """Refuse a coefficient on a table that does not state how its flanks slide; raises `InputError`."""
        for index, mesh in enumerate(mechanism.scene.meshes):
            if mesh.friction is not None and getattr(mesh.table, "sliding_lever", None) is None:
                bound = "left out: the table of the mesh has no sliding data"
                remedy = "Compute the table anew, give a closed form its teeth, or switch friction off."
                raise InputError(f"meshes[{index}].friction", mesh.friction, bound, remedy)

    def contribute(self, terms: FlankTerms, flank: FlankInSpace) -> FlankTerms:
        """Give the flank its sliding, and the force that resists it."""
        scene = flank.mechanism.scene
        mesh = scene.meshes[flank.index]
        helix = scene.gear(mesh.driver).base_helix_angle
        coefficient = (mesh.friction or 0.0) / math.cos(helix)
        return replace(terms.with_rows(SLIDING, _sliding_gradients(flank)), friction=coefficient)


def _sliding_gradients(flank: FlankInSpace) -> FloatArray:
    """Return the derivatives of sliding at the pitch point and of rolling on it, (2, N).

    With n the unit vector along the line of action, a contact at y n from the pitch point slides at
    (w_1 - w_2) y along z x n, whichever flank it is on. The first row is the relative displacement along that
    direction, the second the relative rotation times the driver's base radius. The signs of both are those of
    sliding where the table has y > 0. Where a ring gear drives, the table's y runs against n, and w_1 - w_2
    against the sense of the driving flank.
    """
    scene, rotors, line = flank.mechanism.scene, flank.mechanism.rotors, flank.line
    mesh = scene.meshes[flank.index]
    sign = table_sense(scene, flank.index, flank.driving)
    across = flank.driving * np.cross(UNIT_Z, line.force * np.array([1.0, 1.0, 0.0]))
    radius = scene.gear(mesh.driver).base_radius
    rolled = np.zeros(6)
    rolled[ROTATION] = sign * radius

    def slid(center: FloatArray) -> FloatArray:
        """Return the sliding per displacement and rotation of a gear with this center."""
        return np.concatenate([across, np.cross(line.point - center, across)])

    sliding = gear_row(scene, rotors, [(mesh.driver, slid), (mesh.driven, lambda c: -slid(c))])
    rolling = gear_row(scene, rotors, [(mesh.driver, lambda _: rolled), (mesh.driven, lambda _: -rolled)])
    return np.stack([sliding, rolling])
