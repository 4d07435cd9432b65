"""Gyroscopic moments of spinning shafts; Coriolis and centripetal terms of rotating frames."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import SupportedRotor, Verdict

SHARE = 0.01
"""Least shift of a natural frequency, over the frequency, that calls for it."""


@dataclass(frozen=True)
class Gyroscopic:
    """One force element of two rows per tilting shaft, and one or more per member of a planetary set."""

    name: str = "gyroscopic"
    adds: tuple[str, ...] = ()
    cost: str = "a force element of two rows per tilting shaft; in rotating frames one or more per member"

    def called_for(self, rotor: SupportedRotor) -> Verdict:
        """Call for it where it shifts a natural frequency by more than a share.

        A tilting shaft of spin w whirls at its frequency f times 1 +- I_p w/(2 sqrt(I_t k_t)); one seen from
        a frame of speed W at f +- W/(2 pi).
        """
        rotation = rotor.rotation
        if rotor.tilt_stiffness == 0.0 and not rotation.framed:
            return Verdict(False, False, "the bushings do not hold tilt: held rigidly", 0.0)
        if rotation.framed and rotation.free:
            reason = "left out: torques alone turn the carrier's frame, whose speed is then unknown"
            return Verdict(False, False, reason, 0.0)
        if rotation.free:
            return Verdict(True, True, "torques alone turn the shaft: its speed is not known before", 0.0)
        share = max(rotation.tilt_share if rotor.tilt_stiffness > 0.0 else 0.0, rotation.frame_share)
        held = rotor.pushed / rotor.radial_stiffness if rotor.radial_stiffness > 0.0 else 0.0
        reason = f"rotation shifts natural frequencies by up to {share:.2g} of them"
        return Verdict(share > SHARE, True, reason, min(share, 1.0) * held)
