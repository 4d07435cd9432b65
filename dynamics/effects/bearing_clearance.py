"""Bearings that are not linear: clearance, Hertzian contact, curves of force by displacement."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import SupportedRotor, Verdict


@dataclass(frozen=True)
class BearingClearance:
    """One force element per rolling contact and per curve."""

    name: str = "bearing_clearance"
    adds: tuple[str, ...] = ()
    cost: str = "one force element of one or two rows per law"

    def called_for(self, rotor: SupportedRotor) -> Verdict:
        """Call for it wherever a bearing states a law that is not linear."""
        if not rotor.nonlinear:
            return Verdict(False, False, "no bearing with clearance or a law that is not linear", 0.0)
        reason = "bearings with clearance or laws that are not linear; off: their tangents at the load"
        return Verdict(True, True, reason, max(rotor.nonlinear))
