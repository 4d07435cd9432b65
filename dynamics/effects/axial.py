"""Axial freedom: the shaft moves along its axis on its bushings."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.effects.effect import SupportedRotor, Verdict


@dataclass(frozen=True)
class Axial:
    """One displacement along the axis."""

    name: str = "axial"
    adds: tuple[str, ...] = ("z",)
    cost: str = "one freedom per shaft"

    def called_for(self, rotor: SupportedRotor) -> Verdict:
        """Call for it where a helical mesh pushes along an axis that bushings hold."""
        if rotor.axial_stiffness == 0.0:
            return Verdict(False, False, "no bushing with axial stiffness: held rigidly", 0.0)
        influence = sum(mesh.force * mesh.axial**2 for mesh in rotor.meshes) / rotor.axial_stiffness
        if influence == 0.0:
            return Verdict(False, True, "spur: no force along the axis", 0.0)
        return Verdict(True, True, "a helical mesh pushes along the axis", influence)
