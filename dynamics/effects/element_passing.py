"""Element passing: balls and rollers carry one by one, and the stiffness varies as the cage turns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bounds import engineering
from dynamics.bearings.row_law import row_law
from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.mechanism.additions import ELEMENT_PASSING
from dynamics.mechanism.mechanism import Mechanism


class ElementPassing(RotorEffect):
    """The elements of every rolling bearing at the angle of its cage, instead of their average."""

    name = "element_passing"
    adds = (ELEMENT_PASSING,)
    cost = "less than the average of the elements; the motion has no period, so no periodic states"
    linear = False

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect where the passing moves the shaft by more than a share of the mesh deflection.

        Its influence is that motion: from peak to peak, along the typical load. If the scene states no
        tolerance, the effect is off and the elements are averaged.
        """
        mechanism, shaft = rotor.mechanism, rotor.rotor.shaft.name
        bearings = [bearing for bearing in mechanism.scene.rolling_bearings if bearing.shaft == shaft]
        if not bearings:
            return Verdict(False, False, "no rolling bearing by its geometry", 0.0)
        size = max(row_law(part).passing_motion(mechanism.bearing_duty[part.name]) for part in bearings)
        tolerance = mechanism.scene.tolerance
        reason = f"elements that pass move the shaft by {engineering(1e6 * size)} µm"
        if tolerance is None:
            return Verdict(False, True, f"{reason}; averaged, as no tolerance is stated", size)
        yielding = float(np.min(rotor.flanks.nominal_force / rotor.flanks.mean_stiffness))
        text = f"{reason}, {engineering(size / yielding)} of what the meshes yield"
        return Verdict(size > tolerance * yielding, True, text, size)

    def extend(self, mechanism: Mechanism, decision: Sequence[Verdict | None]) -> Mechanism:
        """Let the elements of the bearings pass on the shafts on which it is on."""
        shafts = {
            rotor.shaft.name
            for rotor, verdict in zip(mechanism.rotors, decision, strict=True)
            if verdict is not None
        }
        names = (part.name for part in mechanism.scene.rolling_bearings if part.shaft in shafts)
        return replace(mechanism, passing=frozenset(names))
