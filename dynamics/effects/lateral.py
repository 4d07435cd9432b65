"""Lateral freedoms: the shaft moves across its axis on its bushings."""

from __future__ import annotations

from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor


class Lateral(RotorEffect):
    """Two displacements across the axis."""

    name = "lateral"
    in_statics = True
    adds = ("x", "y")
    cost = "two freedoms per shaft"

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect where bushings with radial stiffness carry a mesh or a load across the axis."""
        stiffness = rotor.rotor.radial_stiffness
        if stiffness == 0.0:
            return Verdict(False, False, "no bushing with radial stiffness: held rigidly", 0.0)
        if not rotor.meshes and rotor.load_levers:
            return Verdict(True, True, "loads displace the shaft on its bushings", 0.0)
        if not rotor.meshes:
            return Verdict(False, True, "no mesh on this shaft", 0.0)
        reason = "mesh forces displace the shaft on its bushings"
        return Verdict(True, True, reason, rotor.resultant / stiffness)
