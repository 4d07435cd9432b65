"""Dynamic center distance: the table is read at the center distance that the bodies' displacements make."""

from __future__ import annotations

import numpy as np

from dynamics.effects.effect import MeshEffect, Verdict
from dynamics.effects.force_terms import CENTER_DISTANCE, FlankInSpace, FlankTerms
from dynamics.effects.loaded_parts import LoadedMesh
from dynamics.mechanism.additions import CENTER_DISTANCE_CHANGE
from dynamics.mechanism.flank_gradients import distance_gradient


class DynamicCenterDistance(MeshEffect):
    """One more local coordinate of the flank."""

    name = "dynamic_center_distance"
    in_statics = True
    adds = (CENTER_DISTANCE_CHANGE,)
    cost = "a table look-up over one more axis, with twice the values"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for the effect where the table has the axis and a shaft can move along the line of centers."""
        if np.size(mesh.mesh.table.center_distance_change) == 1:
            return Verdict(False, False, "the table has one center distance only", 0.0)
        if reason := mesh.fixed_axes_reason():
            return Verdict(False, False, reason, 0.0)
        if not mesh.moves(CENTER_DISTANCE):
            return Verdict(False, False, "no shaft can move along the line of centers", 0.0)
        reason = "shafts move along the line of centers, and the table has this axis"
        return Verdict(True, True, reason, mesh.change_along(CENTER_DISTANCE))

    def contribute(self, terms: FlankTerms, flank: FlankInSpace) -> FlankTerms:
        """Let the force follow the axis."""
        mechanism = flank.mechanism
        gradient = distance_gradient(mechanism.scene, mechanism.rotors, flank.index, flank.line)
        return terms.following(CENTER_DISTANCE, flank, gradient)
