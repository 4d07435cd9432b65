"""The force elements of torques that depend on speed."""

from __future__ import annotations

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.errors import InputError
from dynamics.forces.law import Law
from dynamics.forces.speed_torque import SpeedTorqueLaws, pack_speed_torques
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, turn_row
from dynamics.mechanism.kinematics import Kinematics
from dynamics.scene.scene import Scene


def speed_elements(
    scene: Scene, rotors: Bodies, kinematics: Kinematics
) -> tuple[tuple[Element, ...], SpeedTorqueLaws]:
    """Return one element per speed torque, and their laws.

    Its coordinate is the rotation in the shaft's sense times a radius, and its rate in the kinematic motion
    is the shaft's speed times that radius.
    """
    radius = max((gear.base_radius for gear in scene.gears), default=1.0)
    elements = []
    for entry, part in enumerate(scene.speed_torques):
        shaft = scene.shaft_index(part.shaft)
        sense = kinematics.sense[shaft]
        if sense == 0:
            field = f"speed_torques[{entry}].shaft"
            raise InputError(field, part.shaft, "a shaft that turns", "A held shaft needs no load.")
        gradient = np.zeros((1, column_count(rotors)))
        gradient[0] += sense * radius * turn_row(rotors, shaft, part.position)
        drift = sense * radius * kinematics.float_ratio[shaft][None, :]
        elements.append(Element(Law.SPEED_TORQUE, entry, -1, gradient, np.zeros(1), drift))
    return tuple(elements), pack_speed_torques(scene.speed_torques, radius)
