"""Dynamic misalignment: the table is read at the misalignment that the bodies' tilts make."""

from __future__ import annotations

import numpy as np

from dynamics.effects.effect import MeshEffect, Verdict
from dynamics.effects.force_terms import MISALIGNMENT, FlankInSpace, FlankTerms
from dynamics.effects.loaded_parts import LoadedMesh
from dynamics.mechanism import additions
from dynamics.mechanism.flank_gradients import misalignment_gradient


class DynamicMisalignment(MeshEffect):
    """One more local coordinate of the flank."""

    name = "dynamic_misalignment"
    in_statics = True
    adds = (additions.MISALIGNMENT,)
    cost = "a table look-up over one more axis, with twice the values"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for the effect where the table has the axis and a shaft can tilt in the plane of action."""
        if np.size(mesh.mesh.table.misalignment) == 1:
            return Verdict(False, False, "the table has one misalignment only", 0.0)
        if reason := mesh.fixed_axes_reason():
            return Verdict(False, False, reason, 0.0)
        if not mesh.moves(MISALIGNMENT):
            return Verdict(False, False, "no shaft can tilt in the plane of action", 0.0)
        reason = "shafts tilt in the plane of action, and the table has this axis"
        return Verdict(True, True, reason, mesh.change_along(MISALIGNMENT))

    def contribute(self, terms: FlankTerms, flank: FlankInSpace) -> FlankTerms:
        """Let the force follow the axis."""
        mechanism = flank.mechanism
        gradient = misalignment_gradient(
            mechanism.scene, mechanism.rotors, flank.index, flank.line, flank.sense
        )
        return terms.following(MISALIGNMENT, flank, gradient)
