"""Axial freedom: the shaft moves along its axis on its bushings."""

from __future__ import annotations

from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_rotors import LoadedRotor


class Axial(RotorEffect):
    """One displacement along the axis."""

    name = "axial"
    adds = ("z",)
    cost = "one freedom per shaft"

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for it where a helical mesh pushes along an axis that bushings hold."""
        stiffness = rotor.rotor.axial_stiffness
        if stiffness == 0.0:
            return Verdict(False, False, "no bushing with axial stiffness: held rigidly", 0.0)
        influence = sum(mesh.force * mesh.axial**2 for mesh in rotor.meshes) / stiffness
        if influence == 0.0:
            return Verdict(False, True, "spur: no force along the axis", 0.0)
        return Verdict(True, True, "a helical mesh pushes along the axis", influence)
