"""Lateral freedoms: the shaft moves across its axis on its bushings."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import SupportedRotor, Verdict


@dataclass(frozen=True)
class Lateral:
    """Two displacements across the axis."""

    name: str = "lateral"
    adds: tuple[str, ...] = ("x", "y")
    cost: str = "two freedoms per shaft"

    def called_for(self, rotor: SupportedRotor) -> Verdict:
        """Call for it wherever bushings with radial stiffness carry a mesh."""
        if rotor.radial_stiffness == 0.0:
            return Verdict(False, False, "no bushing with radial stiffness: held rigidly", 0.0)
        if not rotor.meshes:
            return Verdict(False, True, "no mesh on this shaft", 0.0)
        influence = rotor.pushed / rotor.radial_stiffness
        return Verdict(True, True, "mesh forces displace the shaft on its bushings", influence)
