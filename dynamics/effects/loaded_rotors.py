"""Rotors as their effects assess them: each on its supports, with the meshes it carries."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from dynamics.bodies.shaft_position import OnShaft
from dynamics.mechanism.flanks import Flanks
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.rotor import Rotor


@dataclass(frozen=True)
class MeshOnRotor:
    """A mesh as its rotor feels it.

    Attributes
    ----------
    force : float
        Nominal transverse mesh force, N.
    lever : float
        Axial distance from the rotor's center of mass, m.
    axial : float
        Axial over transverse force, tan(base helix angle), >= 0.
    radius : float
        Operating pitch radius, m: the axial force's lever across the shaft.
    direction : (float, float)
        Unit vector across the axis of the force on the rotor, along x and y.
    """

    force: float
    lever: float
    axial: float
    radius: float
    direction: tuple[float, float] = (1.0, 0.0)


@dataclass(frozen=True)
class LoadedRotor:
    """A rotor of a mechanism under the nominal mesh forces.

    Attributes
    ----------
    mechanism : Mechanism
    flanks : Flanks
    index : int
    meshes : tuple of MeshOnRotor
    """

    mechanism: Mechanism
    flanks: Flanks
    index: int
    meshes: tuple[MeshOnRotor, ...]

    @property
    def rotor(self) -> Rotor:
        """The rotor itself."""
        return self.mechanism.rotors[self.index]

    @property
    def pushed(self) -> float:
        """Resultant across the axis of all nominal mesh forces, N: around a sun they cancel."""
        along_x, along_y = (sum(mesh.force * mesh.direction[k] for mesh in self.meshes) for k in (0, 1))
        return math.hypot(along_x, along_y)

    @property
    def applied(self) -> tuple[float, ...]:
        """Where forces and unbalances act across it: distances from its center of mass, m; weight: at 0."""
        scene, own = self.mechanism.scene, self.rotor
        across = [part for part in scene.forces if any((*part.force[:2], *part.moment[:2]))]
        parts: list[OnShaft] = [*across, *scene.unbalances]
        at = [part.position for part in parts if part.shaft == own.shaft.name]
        weight = (0.0,) if any(scene.gravity[:2]) else ()
        return (*(own.shaft.origin[2] + position - float(own.center[2]) for position in at), *weight)


def loaded_rotors(mechanism: Mechanism, flanks: Flanks) -> tuple[LoadedRotor, ...]:
    """Return all rotors; a carrier feels the meshes of its planets at their pins."""
    scene, rotors = mechanism.scene, mechanism.rotors
    meshes: list[list[MeshOnRotor]] = [[] for _ in rotors]
    for mesh, line, force in zip(scene.meshes, mechanism.lines, mechanism.nominal_force, strict=True):
        for name, sign in ((mesh.driver, -1.0), (mesh.driven, 1.0)):
            gear = scene.gear(name)
            index = scene.shaft_index(gear.shaft)
            lever = float(line.point[2] - rotors[index].center[2])
            radius = gear.base_radius / math.cos(line.working_pressure_angle)
            axial = abs(float(line.force[2]))
            direction = (sign * float(line.force[0]), sign * float(line.force[1]))
            meshes[index].append(MeshOnRotor(float(force), lever, axial, radius, direction))
            carrier = rotors[index].carrier
            if carrier is not None:
                arm = rotors[index].center - rotors[carrier].center
                arms = float(arm[2]), axial, float(np.hypot(arm[0], arm[1]))
                meshes[carrier].append(MeshOnRotor(float(force), *arms, direction))
    return tuple(
        LoadedRotor(mechanism, flanks, index, tuple(on_rotor)) for index, on_rotor in enumerate(meshes)
    )
