"""The mechanism of a scene: its bodies, their motion if all gears were conjugate, their loads.

That motion is the kinematic motion. Its laws are the speeds that the scene states: those of the drives, then
those of the free rotations. Axes: m meshes, r = s rotors, one a shaft, k laws, N freedoms. The first six
freedoms of a rotor are displacements x, y, z of its center and rotations about x, y, z.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bounds import above
from dynamics.bearings.bearing_law import BearingDuty
from dynamics.errors import InputError
from dynamics.mechanism.additions import COAST_FLANKS, Additions
from dynamics.mechanism.base_pitches import Corrections, with_common_base_pitches
from dynamics.mechanism.bearing_elements import (
    BearingElement,
    bearing_duties,
    bearing_locations,
    supports_by_name,
)
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.carried_planets import rotational_inertia
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.kinematics import Kinematics, solve_kinematics
from dynamics.mechanism.lent_supports import with_couplings
from dynamics.mechanism.line_of_action import LineOfAction, lines_of_action
from dynamics.mechanism.nominal_forces import nominal_forces
from dynamics.mechanism.rotor import build_rotor
from dynamics.mechanism.supports import gather_supports
from dynamics.mechanism.train_phases import NO_PHASES, TrainPhases, train_phases
from dynamics.scene.scene import Scene
from dynamics.types import BoolArray, FloatArray

X, Y, ROTATION = 0, 1, 5  # indices among the six freedoms of a rotor
GIVE_INERTIA = "Give the shaft or its gears mass and inertia (see hollow_cylinder)."


@dataclass(frozen=True)
class Mechanism:
    """The parts of a scene before any effect is decided."""

    scene: Scene
    kinematics: Kinematics
    rotors: Bodies
    """A rotor per shaft."""
    lines: tuple[LineOfAction, ...]
    """One per mesh."""
    nominal_force: FloatArray
    """Nominal transverse mesh force, N. Shape (m,)."""
    bearing_duty: dict[str, BearingDuty]
    """Expected duty of each bearing."""
    bearings: tuple[BearingElement, ...]
    """Points of action of the bearings that are not linear."""
    corrected: Corrections
    """Base radii of gears as given and as used, m."""
    additions: Additions
    """Additions of the effects to the mechanism."""
    passing: frozenset[str] = frozenset()
    """Rolling bearings whose elements pass one by one."""
    phases: TrainPhases = NO_PHASES
    """Positions of the meshes, and the assumptions on them beyond the geometry."""

    @property
    def rotational_inertia(self) -> FloatArray:
        """Rotational inertia of each rotor with the planets it takes along, (r,), kg m^2."""
        return rotational_inertia(self.rotors)

    @property
    def largest_speed(self) -> FloatArray:
        """Largest speed of each shaft in the kinematic motion, (s,), rad/s."""
        extreme = np.array([abs(part.speed.extreme) for part in self.scene.references])
        return np.asarray(np.abs(self.kinematics.float_ratio) @ extreme)

    @property
    def freely_turned(self) -> BoolArray:
        """Whether free rotations turn each shaft, (s,)."""
        # the laws of the free rotations stand behind those of the drives
        ratio = self.kinematics.float_ratio[:, len(self.scene.drives) :]
        return np.asarray(np.any(ratio != 0.0, axis=1))

    @property
    def vectors(self) -> FloatArray:
        """Motion of all rotors per radian of each law, (k, N).

        The centers of planets move with their carriers. In the rotating frame of its carrier a planet would
        be at rest; these vectors are the motion in the frame as it stood before the rotation. They say how a
        small rotation of the law moves the freedoms, and on which freedoms inertia acts when the law
        accelerates.
        """
        rotors, ratio = self.rotors, self.kinematics.float_ratio
        vectors = np.zeros((ratio.shape[1], len(rotors), 6))
        vectors[:, :, ROTATION] = ratio.T
        for index, rotor in enumerate(rotors):
            if rotor.carrier is not None:
                arm = rotor.center - rotors[rotor.carrier].center
                vectors[:, index, X] = -arm[1] * ratio[rotor.carrier]
                vectors[:, index, Y] = arm[0] * ratio[rotor.carrier]
        full = np.zeros((ratio.shape[1], column_count(rotors)))  # elastic coordinates rest
        full[:, : 6 * len(rotors)] = vectors.reshape(ratio.shape[1], 6 * len(rotors))
        return full


def gather_mechanism(scene: Scene, additions: Additions) -> Mechanism:
    """Gather bodies, kinematic motion and loads of `scene`, to which effects may make `additions`.

    Raises `InputError`: parts do not fit each other, or a shaft free to turn has no moment of inertia.
    """
    scene, corrected = with_common_base_pitches(scene)
    kinematics = solve_kinematics(scene)
    phases = train_phases(scene, kinematics.mesh_sense)
    rotors = Bodies(tuple(build_rotor(scene, shaft) for shaft in scene.shafts))
    lines = lines_of_action(scene, kinematics.mesh_sense)
    coasts = COAST_FLANKS in additions.possible
    forces = nominal_forces(scene, kinematics, rotational_inertia(rotors), coasts=coasts)
    duties = bearing_duties(scene, rotors, forces)
    support_names = gather_supports(rotors, general=frozenset()).name
    bearings = bearing_locations(scene, rotors, support_names, duties)
    # The rotors get the stiffness of the nonlinear bearings at their typical load, with its lever.
    supports, stiffened = supports_by_name(rotors), list(rotors)
    for bearing in bearings:
        index, support = supports[bearing.name]
        rotor = stiffened[index]
        stiffness = (*rotor.typical_stiffness, (bearing.seat, rotor.lever(support)))
        stiffened[index] = replace(rotor, typical_stiffness=stiffness)
    rotors = Bodies(with_couplings(scene, stiffened))
    for index, rotor in enumerate(rotors):
        if index not in kinematics.imposed and rotor.inertia.polar <= 0.0:
            raise InputError(f"shafts[{index}].inertia.polar", 0.0, above(0.0), GIVE_INERTIA)
    return Mechanism(
        scene=scene,
        kinematics=kinematics,
        rotors=rotors,
        lines=lines,
        nominal_force=forces,
        bearing_duty=duties,
        bearings=bearings,
        corrected=corrected,
        additions=additions,
        phases=phases,
    )
