"""The mechanism of a scene: its bodies, their motion if all gears were conjugate, their loads."""

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
        return np.asarray(np.any(self.kinematics.float_ratio[:, len(self.scene.drives) :] != 0.0, axis=1))

    @property
    def vectors(self) -> FloatArray:
        """Motion of all rotors per radian of each law, planets' centers with their carriers, (k, N).

        In the frame of a carrier its planets are at rest in the kinematic motion. These vectors are that
        motion seen from where the frame was: what a little more rotation of the law does to the freedoms, and
        what an acceleration of it loads with inertia.
        """
        rotors, ratio = self.rotors, self.kinematics.float_ratio
        vectors = np.zeros((ratio.shape[1], len(rotors), 6))
        vectors[:, :, 5] = ratio.T
        for index, rotor in enumerate(rotors):
            if rotor.carrier is not None:
                arm = rotor.center - rotors[rotor.carrier].center
                vectors[:, index, 0] = -arm[1] * ratio[rotor.carrier]
                vectors[:, index, 1] = arm[0] * ratio[rotor.carrier]
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
    bearings = bearing_locations(scene, rotors, gather_supports(rotors, frozenset()).name, duties)
    known, stiffened = supports_by_name(rotors), list(rotors)
    for at in bearings:
        index, support = known[at.name]
        rotor = stiffened[index]
        stiffened[index] = replace(rotor, curved=(*rotor.curved, (at.seat, rotor.lever(support))))
    rotors = Bodies(with_couplings(scene, stiffened))
    for index, rotor in enumerate(rotors):
        if index not in kinematics.imposed and rotor.inertia.polar <= 0.0:
            raise InputError(f"shafts[{index}].inertia.polar", 0.0, above(0.0), GIVE_INERTIA)
    made = Mechanism(scene, kinematics, rotors, lines, forces, duties, bearings, corrected, additions)
    return replace(made, phases=phases)
