"""Tilt freedoms: the shaft's axis turns out of its direction."""

from __future__ import annotations

from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor

CENTERED = 1e-9  # distance from the center of mass over the shaft's length, below which a force is centered


class Tilt(RotorEffect):
    """Two rotations across the axis."""

    name = "tilt"
    in_statics = True
    adds = ("tilt_x", "tilt_y")
    cost = "two freedoms per shaft"

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect where a mesh is off the supports' center, or has an axial force, which tilts.

        A center of mass off the supports' center couples tilt to lateral motion and calls for it too, as do
        other loads off that center.
        """
        body = rotor.rotor
        if body.tilt_stiffness == 0.0:
            return Verdict(False, False, "no bushing with tilt stiffness: held rigidly", 0.0)
        influence = sum(
            mesh.force * ((mesh.lever - body.elastic_lever) ** 2 + (mesh.axial * mesh.radius) ** 2)
            for mesh in rotor.meshes
        )
        influence /= body.tilt_stiffness
        reason = _why(rotor)
        if reason:
            return Verdict(True, True, reason, influence)
        return Verdict(
            False, True, "meshes and mass centered between the supports, no axial force", influence
        )


def _why(rotor: LoadedRotor) -> str:
    """Return the cause that tilts the shaft; empty: there is none."""
    body, forces = rotor.rotor, rotor.mechanism.scene.forces
    limit = CENTERED * body.shaft.length
    if any(mesh.axial * mesh.radius > 0.0 for mesh in rotor.meshes):
        return "a helical mesh tilts the shaft"
    if any(abs(mesh.lever - body.elastic_lever) > limit for mesh in rotor.meshes):
        return "a mesh is off the supports' center"
    if (rotor.meshes or rotor.load_levers) and abs(body.elastic_lever) > limit:
        return "the center of mass is off the supports' center"
    if any(abs(lever - body.elastic_lever) > limit for lever in rotor.load_levers):
        return "a load is off the supports' center"
    if any(any(force.moment[:2]) for force in forces if force.shaft == body.shaft.name):
        return "a moment tilts the shaft"
    return ""
