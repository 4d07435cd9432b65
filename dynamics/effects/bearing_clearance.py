"""Bearings that are not linear: clearance, Hertzian contact, curves of force by displacement."""

from __future__ import annotations

from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.mechanism.additions import BEARING_LAWS


class BearingClearance(RotorEffect):
    """One force element per rolling contact, curve and rolling bearing."""

    name = "bearing_clearance"
    in_statics = True
    adds = (BEARING_LAWS,)
    cost = "one force element of one, two or five rows per law"
    linear = False

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect wherever a bearing states a law that is not linear.

        Its influence is the most that the tangent of a law misses of the displacement under the load.
        """
        mechanism = rotor.mechanism
        duties, supports = mechanism.bearing_duty, {part.name for part in rotor.rotor.supports}
        laws = [law for law in mechanism.scene.bearing_laws if law.bushing in supports]
        errors = [law.tangent_error(duties[law.bushing]) for law in laws]
        if not errors:
            return Verdict(False, False, "no bearing with clearance or a nonlinear law", 0.0)
        reason = "bearings with clearance or nonlinear laws; off: their tangents at the load"
        return Verdict(True, True, reason, max(errors))
