"""Whether something holds the shafts that helical gears push along their axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.errors import InputError
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.line_of_action import LineOfAction
from dynamics.mechanism.rotor import Rotor
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

BALANCED = 1e-6
"""Part of the single thrusts below which those on a shaft cancel: lines of action are known to rounding."""


def check_thrust(
    scene: Scene,
    kinematics: Kinematics,
    rotors: Sequence[Rotor],
    lines: Sequence[LineOfAction],
    forces: FloatArray,
) -> None:
    """Refuse a shaft that helical meshes push along its axis and that nothing holds there.

    Idlers, planets between sun and ring and double helical gears balance themselves. Three choices hold a
    shaft rigidly: the effect ``axial`` "off", a drive at rest, and no bearing on the shaft at all.

    Parameters
    ----------
    scene : Scene
    kinematics : Kinematics
    rotors : sequence of Rotor
        With the typical stiffness of what bearings do that is not linear, and of couplings.
    lines : sequence of LineOfAction
    forces : (m,) array
        Nominal, transverse, N.

    Raises
    ------
    InputError
    """
    if scene.effects.get("axial") == "off":
        return
    size = np.where(forces > 0.0, forces, 1.0)
    for rotor, sense in zip(rotors, kinematics.sense, strict=True):
        gears = [i for i, gear in enumerate(scene.gears) if gear.shaft == rotor.shaft.name]
        names = {scene.gears[i].name for i in gears}
        pushes = [
            sign * force * float(line.force[2])
            for mesh, line, force in zip(scene.meshes, lines, size, strict=True)
            for name, sign in ((mesh.driver, -1.0), (mesh.driven, 1.0))
            if name in names
        ]
        thrust = sum(pushes)
        floats = rotor.radial_stiffness > 0.0 and rotor.axial_stiffness == 0.0
        if sense and floats and abs(thrust) > BALANCED * sum(map(abs, pushes)):
            first = next(i for i in gears if scene.gears[i].base_helix_angle != 0.0)
            bound = f'on a shaft that something holds along its axis: nothing holds "{rotor.shaft.name}"'
            advice = 'Give one of its bearings axial stiffness, or set the effect "axial" to "off".'
            raise InputError(f"gears[{first}]", scene.gears[first].name, bound, advice)
