"""What the effects of rotors decide on: supports, meshes, bearings, speeds."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.effects import BendingShaft, MeshOnRotor, RotorRotation, SupportedRotor
from dynamics.mechanism.bearing_elements import nonlinear_influences
from dynamics.mechanism.line_of_action import LineOfAction
from dynamics.mechanism.rotor import Rotor
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def supported_rotors(
    scene: Scene,
    rotors: Sequence[Rotor],
    lines: Sequence[LineOfAction],
    forces: FloatArray,
    loads: dict[str, float],
    turns: Sequence[RotorRotation],
    bending: Sequence[BendingShaft],
) -> list[SupportedRotor]:
    """Gather what the effects decide on; a carrier feels the meshes of its planets at their pins."""
    meshes: list[list[MeshOnRotor]] = [[] for _ in rotors]
    for mesh, line, force in zip(scene.meshes, lines, forces, strict=True):
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
    clearances = nonlinear_influences(scene, loads)
    return [
        SupportedRotor(
            rotor.shaft.name,
            rotor.shaft.length,
            rotor.radial_stiffness,
            rotor.axial_stiffness,
            rotor.tilt_stiffness,
            rotor.elastic_lever,
            tuple(on_rotor),
            tuple(influence for name, influence in clearances if name == rotor.shaft.name),
            turn,
            bent,
        )
        for rotor, on_rotor, turn, bent in zip(rotors, meshes, turns, bending, strict=True)
    ]
