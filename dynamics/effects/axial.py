"""Axial freedom: the shaft moves along its axis on its bushings."""

from __future__ import annotations

import numpy as np

from dynamics.effects.effect import RotorEffect, Verdict
from dynamics.effects.loaded_parts import LoadedRotor
from dynamics.errors import InputError
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.rotor import Rotor

BALANCED = 1e-6
"""Bound of the sum of the thrusts on a shaft over the sum of their sizes, below which they cancel.

It allows for the rounding of the lines of action.
"""


class Axial(RotorEffect):
    """One displacement along the axis."""

    name = "axial"
    in_statics = True
    adds = ("z",)
    cost = "one freedom per shaft"

    def called_for(self, rotor: LoadedRotor) -> Verdict:
        """Call for the effect where a helical mesh or a force pushes along an axis that bushings hold."""
        stiffness = rotor.rotor.axial_stiffness
        if stiffness == 0.0:
            return Verdict(False, False, "no bushing with axial stiffness: held rigidly", 0.0)
        influence = sum(mesh.force * mesh.axial**2 for mesh in rotor.meshes) / stiffness
        forces = [force for force in rotor.mechanism.scene.forces if force.shaft == rotor.rotor.shaft.name]
        if influence == 0.0 and any(force.force[2] != 0.0 for force in forces):
            return Verdict(True, True, "a force pushes along the axis", 0.0)
        if influence == 0.0:
            return Verdict(False, True, "spur: no force along the axis", 0.0)
        return Verdict(True, True, "a helical mesh pushes along the axis", influence)

    def check(self, mechanism: Mechanism) -> None:
        """Refuse a shaft that is pushed along its axis and that no bearing holds axially.

        The thrusts on idlers, on planets between sun and ring, and on double helical gears cancel. A double
        helical gear floats between its two meshes, but only if a bearing gives its shaft some axial
        stiffness: without any, this model has no axial freedom. Three choices hold a shaft rigidly: the
        effect "off", a drive at rest, and no bearing on the shaft at all.

        Raises `InputError`.
        """
        scene = mechanism.scene
        for rotor, sense in zip(mechanism.rotors, mechanism.kinematics.sense, strict=True):
            name, pushes = rotor.shaft.name, _thrusts(mechanism, rotor)
            if not sense or rotor.radial_stiffness == 0.0 or rotor.axial_stiffness > 0.0:
                continue
            remedy = f'Give one of its bearings axial stiffness, or set the effect "{self.name}" to "off".'
            for index, force in enumerate(scene.forces):
                if force.shaft == name and force.force[2] != 0.0:
                    bound = f'0 on "{name}", which nothing holds along its axis'
                    raise InputError(f"forces[{index}].force.z", force.force[2], bound, remedy)
            gears = [(k, gear) for k, gear in enumerate(scene.gears) if gear.shaft == name]
            helical = [(k, gear) for k, gear in gears if gear.base_helix_angle != 0.0]
            if abs(sum(pushes)) > BALANCED * sum(map(abs, pushes)):
                bound = f'on a shaft with axial support, which "{name}" lacks'
            elif any(pushes) and len({gear.base_helix_angle > 0.0 for _, gear in helical}) == 2:
                bound = f'on a shaft free to float: "{name}" is double helical, without axial support'
                remedy = remedy.replace("axial stiffness", "axial stiffness, however small")
            else:
                continue
            raise InputError(f"gears[{helical[0][0]}]", helical[0][1].name, bound, remedy)


def _thrusts(mechanism: Mechanism, rotor: Rotor) -> list[float]:
    """Return the axial forces of the meshes on a rotor, N; of unit mesh forces where there is no load."""
    scene, nominal = mechanism.scene, mechanism.nominal_force
    gears = {gear.name for gear in scene.gears if gear.shaft == rotor.shaft.name}
    size = np.where(nominal > 0.0, nominal, 1.0)
    return [
        sign * float(force * line.force[2])
        for mesh, line, force in zip(scene.meshes, mechanism.lines, size, strict=True)
        for name, sign in ((mesh.driver, -1.0), (mesh.driven, 1.0))
        if name in gears
    ]
