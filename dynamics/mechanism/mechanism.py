"""The mechanism of a scene: its bodies, how they move if all gears were conjugate, what loads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bounds import above
from dynamics.bearings.bearing_law import BearingDuty
from dynamics.bearings.seat import SEAT
from dynamics.errors import InputError
from dynamics.joints import Coupling
from dynamics.mechanism.additions import COAST_FLANKS, Additions
from dynamics.mechanism.base_pitches import Corrections, with_common_base_pitches
from dynamics.mechanism.bearing_elements import (
    BearingElement,
    bearing_duties,
    bearing_loads,
    bearing_locations,
    supports_by_name,
)
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.coupling_rows import full_matrix
from dynamics.mechanism.kinematics import Kinematics, solve_kinematics
from dynamics.mechanism.line_of_action import LineOfAction, line_of_action
from dynamics.mechanism.nominal_forces import nominal_forces
from dynamics.mechanism.planets import kinematic_vectors, rotational_inertia
from dynamics.mechanism.rotor import Rotor, build_rotor
from dynamics.mechanism.supports import gather_supports
from dynamics.scene.scene import Scene
from dynamics.types import BoolArray, FloatArray

# Rotors that no bearing holds in a direction, but a coupling to one that is held there.


RADIAL, AXIAL, TILT = (0, 1), (2,), (3, 4)


def _with_couplings(scene: Scene, rotors: Sequence[Rotor]) -> tuple[Rotor, ...]:
    """Return the rotors with what their couplings hold where no bearing does.

    A coupling's matrix holds a shaft in a direction if bearings (or further couplings) hold the shaft behind
    it there. Shafts that nothing holds stay where they are, as shafts without bearings do.
    """
    stiff = [coupling for coupling in scene.couplings if coupling.stiffness is not None]
    sides = [(c, a, b) for c in stiff for a, b in ((c.first, c.second), (c.second, c.first))]
    supported = list(rotors)
    while True:
        for side in sides:
            coupling, floating, behind = side
            index, held = scene.shaft_index(floating), supported[scene.shaft_index(behind)]
            kinds = _lent(supported[index], held, coupling)
            if kinds:
                supported[index] = _holding(scene, supported[index], coupling, kinds)
                sides.remove(side)
                break
        else:
            return tuple(supported)


def _lent(rotor: Rotor, behind: Rotor, coupling: Coupling) -> tuple[int, ...]:
    """Return the directions in which the rotor lacks bearings and the coupling has stiffness to offer."""
    matrix = full_matrix(coupling.stiffness, 0.0)
    kinds: tuple[int, ...] = ()
    if behind.radial_stiffness > 0.0 and (rotor.radial_stiffness == 0.0 or rotor.tilt_stiffness == 0.0):
        kinds += RADIAL
    if behind.axial_stiffness > 0.0 and rotor.axial_stiffness == 0.0:
        kinds += AXIAL
    if behind.tilt_stiffness > 0.0 and rotor.tilt_stiffness == 0.0:
        kinds += TILT
    return tuple(kind for kind in kinds if matrix[kind, kind] > 0.0)


def _holding(scene: Scene, rotor: Rotor, coupling: Coupling, kinds: tuple[int, ...]) -> Rotor:
    """Return the rotor with the coupling's stiffness in these directions."""
    matrix, kept = full_matrix(coupling.stiffness, 0.0)[:SEAT, :SEAT], np.zeros((SEAT, SEAT))
    at = np.ix_(kinds, kinds)
    kept[at] = matrix[at]
    first = scene.shafts[scene.shaft_index(coupling.first)]
    lever = float(first.origin[2] + coupling.position - rotor.center[2])
    return replace(rotor, curved=(*rotor.curved, (kept, lever)))


GIVE_INERTIA = "Give the shaft or its gears mass and inertia (see hollow_cylinder)."


@dataclass(frozen=True)
class Mechanism:
    """The parts of a scene before any effect is decided.

    Attributes
    ----------
    scene : Scene
    kinematics : Kinematics
    rotors : Bodies
        A rotor per shaft.
    lines : tuple of LineOfAction
        One per mesh.
    nominal_force : (m,) array
        Transverse, N.
    bearing_duty : dict of str to BearingDuty
        What is expected of each bearing.
    bearings : tuple of BearingElement
        Where the laws of bearings act that are not linear.
    corrected : dict
        Base radii of gears as given and as used, m.
    additions : Additions
        What the effects may add.
    passing : frozenset of str
        Rolling bearings whose elements pass one by one.
    """

    scene: Scene
    kinematics: Kinematics
    rotors: Bodies
    lines: tuple[LineOfAction, ...]
    nominal_force: FloatArray
    bearing_duty: dict[str, BearingDuty]
    bearings: tuple[BearingElement, ...]
    corrected: Corrections
    additions: Additions
    passing: frozenset[str] = frozenset()

    @property
    def polar_inertia(self) -> list[float]:
        """Of each rotor, kg m^2."""
        return [rotor.inertia.polar for rotor in self.rotors]

    @property
    def rotational_inertia(self) -> FloatArray:
        """Of each rotor with the planets it takes along, (r,), kg m^2."""
        return rotational_inertia(self.rotors)

    @property
    def largest_speed(self) -> FloatArray:
        """Of each shaft in the kinematic motion, (s,), rad/s."""
        extreme = np.array([abs(part.speed.extreme) for part in self.scene.references])
        return np.asarray(np.abs(self.kinematics.float_ratio) @ extreme)

    @property
    def freely_turned(self) -> BoolArray:
        """Whether free rotations turn each shaft, (s,)."""
        return np.asarray(np.any(self.kinematics.float_ratio[:, len(self.scene.drives) :] != 0.0, axis=1))

    @property
    def vectors(self) -> FloatArray:
        """Motion of all rotors per radian of each law, (k, 6 r)."""
        return kinematic_vectors(self.rotors, self.kinematics)


def gather_mechanism(scene: Scene, additions: Additions) -> Mechanism:
    """Gather bodies, kinematic motion and loads of `scene`, to which effects may make `additions`.

    Raises
    ------
    InputError
        If parts do not fit each other, or a shaft free to turn has no moment of inertia.
    """
    scene, corrected = with_common_base_pitches(scene)
    kinematics = solve_kinematics(scene)
    rotors = Bodies(tuple(build_rotor(scene, shaft) for shaft in scene.shafts))
    lines = tuple(line_of_action(scene, index, sense) for index, sense in enumerate(kinematics.mesh_sense))
    coasts = COAST_FLANKS in additions.possible
    forces = nominal_forces(scene, kinematics, rotational_inertia(rotors), coasts=coasts)
    duties = bearing_duties(scene, rotors, bearing_loads(scene, rotors, forces))
    bearings, rotors = _with_bearings(scene, rotors, duties)
    rotors = Bodies(_with_couplings(scene, rotors))
    _check_rotation(rotors, kinematics)
    return Mechanism(scene, kinematics, rotors, lines, forces, duties, bearings, corrected, additions)


def _with_bearings(
    scene: Scene, rotors: Bodies, duties: dict[str, BearingDuty]
) -> tuple[tuple[BearingElement, ...], Bodies]:
    """Return where laws of bearings act, and the rotors with their typical stiffness."""
    names = gather_supports(rotors, frozenset()).name
    bearings = bearing_locations(scene, rotors, names, duties)
    known, stiffened = supports_by_name(rotors), list(rotors)
    for at in bearings:
        index, support = known[at.name]
        rotor = stiffened[index]
        stiffened[index] = replace(rotor, curved=(*rotor.curved, (at.seat, rotor.lever(support))))
    return bearings, Bodies(tuple(stiffened))


def _check_rotation(rotors: Sequence[Rotor], kinematics: Kinematics) -> None:
    """Every shaft free to turn needs a moment of inertia."""
    for index, rotor in enumerate(rotors):
        if index not in kinematics.imposed and rotor.inertia.polar <= 0.0:
            raise InputError(f"shafts[{index}].inertia.polar", 0.0, above(0.0), GIVE_INERTIA)
