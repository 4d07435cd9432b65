"""Moving point of application: the moment of the mesh force in the plane of action."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bounds import engineering
from dynamics.effects.effect import MeshEffect, Verdict
from dynamics.effects.force_terms import MISALIGNMENT, FlankInSpace, FlankTerms
from dynamics.effects.loaded_parts import LoadedMesh
from dynamics.mechanism.additions import LOAD_ARM
from dynamics.mechanism.flank_gradients import common_face_width, misalignment_gradient

CENTERED = 1e-9  # distance from mid-face over the face width, below which a load is centered


class MovingApplicationPoint(MeshEffect):
    """A moment of the mesh force in the plane of action."""

    name = "moving_application_point"
    in_statics = True
    adds = (LOAD_ARM,)
    cost = "one more row per flank and four more values per look-up"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for the effect where the load has an arm about the pitch point and a shaft can tilt.

        Its influence is the displacement along the line of action at the load that its moment makes.
        """
        arm = getattr(mesh.mesh.table, "load_arm", None)
        if arm is None:
            return Verdict(False, False, "the table has no arm of the load", 0.0)
        if not mesh.moves(MISALIGNMENT):
            return Verdict(False, False, "no shaft can tilt in the plane of action", 0.0)
        lever = float(np.max(np.abs(np.asarray(arm)[..., mesh.level])))
        lever = lever / common_face_width(mesh.train.mechanism.scene, mesh.index)
        if lever <= CENTERED:
            return Verdict(False, True, "the load stays centered on the face", 0.0)
        reason = f"the load's arm about mid-face is up to {engineering(100.0 * lever)} % of the face"
        tilts = mesh.axes[MISALIGNMENT]
        return Verdict(
            True, True, reason, mesh.force * lever**2 * float(tilts @ mesh.train.compliance @ tilts)
        )

    def contribute(self, terms: FlankTerms, flank: FlankInSpace) -> FlankTerms:
        """Let the force have its arm."""
        scene, rotors = flank.mechanism.scene, flank.mechanism.rotors
        tilts = misalignment_gradient(scene, rotors, flank.index, flank.line, flank.sense)
        per_face = 1.0 / common_face_width(scene, flank.index)
        return replace(terms.with_rows(MISALIGNMENT, tilts[None, :]), per_face=per_face)
