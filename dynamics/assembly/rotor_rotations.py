"""Rotation of the rotors, by which the effect of gyroscopic and frame terms decides."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.effects.effect import RotorRotation
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.rotor import Rotor
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def rotor_rotations(
    scene: Scene, kinematics: Kinematics, rotors: Sequence[Rotor]
) -> tuple[RotorRotation, ...]:
    """Return the rotation of each rotor, at the largest speeds of the run."""
    ratio, speed = kinematics.float_ratio, largest_speeds(scene, kinematics)
    free = np.any(ratio[:, len(scene.drives) :] != 0.0, axis=1)
    lateral = [_over_lateral(rotor, speed) for rotor in rotors]
    found = []
    for index, rotor in enumerate(rotors):
        frame = rotor.frame
        held = math.sqrt(rotor.inertia.transverse * rotor.tilt_stiffness)
        tilt_share = rotor.inertia.polar * float(speed[index]) / (2.0 * held) if held > 0.0 else 0.0
        members = [lateral[i] for i, other in enumerate(rotors) if frame is not None and other.frame == frame]
        found.append(
            RotorRotation(
                tilt_share,
                max(members, default=0.0),
                frame is not None,
                bool(free[index if frame is None else frame]),
            )
        )
    return tuple(found)


def largest_speeds(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Return the largest speed of each shaft in the kinematic motion, (s,), rad/s."""
    extreme = np.array([abs(part.speed.extreme) for part in scene.references])
    return np.asarray(np.abs(kinematics.float_ratio) @ extreme)


def _over_lateral(rotor: Rotor, speed: FloatArray) -> float:
    """Speed of a rotor's frame over its lateral natural frequency; 0 where it is not held or in no frame."""
    if rotor.frame is None or rotor.radial_stiffness <= 0.0:
        return 0.0
    return float(speed[rotor.frame]) * math.sqrt(rotor.inertia.mass / rotor.radial_stiffness)
