"""Backlash: behind the driving flank there is a gap, and behind it the coast flank."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import LoadedMesh, Verdict


@dataclass(frozen=True)
class Backlash:
    """One force element per mesh: the coast flank."""

    name: str = "backlash"
    cost: str = "one table look-up per mesh and stage"

    def called_for(self, mesh: LoadedMesh) -> Verdict:
        """Call for it where the run can take the load off the driving flank.

        Flanks part when the dynamic force is as large as the mean. The mean is the least over the run that
        balances loads and the inertia of the imposed motion; half the peak-to-peak transmission error, met by
        the mesh stiffness and amplified by 1/(2 zeta) as in resonance, bounds the dynamic force of one
        harmonic.
        """
        if mesh.backlash is None:
            return Verdict(False, False, "no coast flank given: flanks that part find nothing behind", 0.0)
        if mesh.least_force <= 0.0:
            reason = f"the load reverses: the mean force falls to {mesh.least_force:.4g} N"
            return Verdict(True, True, reason, mesh.backlash)
        text = f"the mean force stays above {mesh.least_force:.4g} N, resonance swings it by up to "
        if mesh.force_swing >= mesh.least_force:
            return Verdict(True, True, f"{text}{mesh.force_swing:.4g} N: flanks can part", mesh.backlash)
        return Verdict(False, True, f"{text}{mesh.force_swing:.4g} N only: flanks stay together", 0.0)
