"""Flexible shafts: they bend, shear, twist and stretch between gears and bearings."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import SupportedRotor, Verdict

SHARE = 0.05
"""Least displacement at a mesh, over what the mesh itself yields, that calls for it."""


@dataclass(frozen=True)
class FlexibleShafts:
    """Elastic coordinates of every shaft with sections, and the rigid freedoms that bending needs."""

    name: str = "flexible_shafts"
    adds: tuple[str, ...] = ()
    cost: str = "five to thirty freedoms per shaft, all in one block"

    def called_for(self, rotor: SupportedRotor) -> Verdict:
        """Call for it where the nominal force bends and twists a shaft by a share of what its mesh yields."""
        shaft = rotor.bending
        if shaft.refusal:
            return Verdict(False, False, shaft.refusal, 0.0)
        reason = (
            f"the nominal force bends and twists the shaft by {1e6 * shaft.moved:.3g} um along the line of "
            f"action, {100.0 * shaft.share:.3g} % of what the mesh yields, and misaligns the gear by "
            f"{1e6 * shaft.misaligned:.3g} um over the face"
        )
        return Verdict(shaft.share > SHARE, True, reason, shaft.moved)
