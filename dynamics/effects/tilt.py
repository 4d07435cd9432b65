"""Tilt freedoms: the shaft's axis turns out of its direction."""

from __future__ import annotations

from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_rotors import LoadedRotor

CENTERED = 1e-9  # of the shaft's length


class Tilt(RotorEffect):
    """Two rotations across the axis."""

    name = "tilt"
    adds = ("tilt_x", "tilt_y")
    cost = "two freedoms per shaft"

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for it where a mesh is off the supports' center, or has an axial force, which tilts.

        A center of mass off the supports' center couples tilt to lateral motion and calls for it too.
        """
        own = rotor.rotor
        if own.tilt_stiffness == 0.0:
            return Verdict(False, False, "no bushing with tilt stiffness: held rigidly", 0.0)
        arms = [(mesh.lever - own.elastic_lever, mesh.axial * mesh.radius) for mesh in rotor.meshes]
        influence = sum(
            mesh.force * (along**2 + across**2)
            for mesh, (along, across) in zip(rotor.meshes, arms, strict=True)
        )
        influence /= own.tilt_stiffness
        limit = CENTERED * own.shaft.length
        if any(across > 0.0 for _, across in arms):
            return Verdict(True, True, "a helical mesh tilts the shaft", influence)
        if any(abs(along) > limit for along, _ in arms):
            return Verdict(True, True, "a mesh is off the supports' center", influence)
        if rotor.meshes and abs(own.elastic_lever) > limit:
            return Verdict(True, True, "the center of mass is off the supports' center", influence)
        return Verdict(
            False, True, "meshes and mass centered between the supports, no axial force", influence
        )
