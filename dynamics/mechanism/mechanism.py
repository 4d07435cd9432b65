"""The mechanism of a scene: its bodies, how they move if all gears were conjugate, what loads them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bounds import Quantity, above
from dynamics.arrays.arrays import slope
from dynamics.bearings.bearing_law import BearingDuty
from dynamics.bearings.seat import SEAT
from dynamics.errors import InputError
from dynamics.joints import Coupling
from dynamics.loads.load_course import BySpeed, mean_factor
from dynamics.loads.time_law import TimeLaw
from dynamics.mechanism.additions import COAST_FLANKS, Additions
from dynamics.mechanism.base_pitches import Corrections, with_common_base_pitches
from dynamics.mechanism.bearing_elements import (
    BearingElement,
    bearing_duties,
    bearing_locations,
    supports_by_name,
)
from dynamics.mechanism.bodies import Bodies, Rotor, build_rotor
from dynamics.mechanism.columns import column_count
from dynamics.mechanism.connections import full_matrix
from dynamics.mechanism.freedoms import rotational_inertia
from dynamics.mechanism.kinematics import Kinematics, mesh_shafts, solve_kinematics
from dynamics.mechanism.line_of_action import LineOfAction, lines_of_action
from dynamics.mechanism.supports import gather_supports
from dynamics.mechanism.train_phases import NO_PHASES, TrainPhases, train_phases
from dynamics.scene.scene import Scene
from dynamics.types import BoolArray, FloatArray

# Mesh forces that carry the load in the kinematic motion.


BETWEEN_KNOTS = 8  # moments at which a law is looked at between two of its knots
RADIAL, AXIAL, TILT = (0, 1), (2,), (3, 4)
GIVE_INERTIA = "Give the shaft or its gears mass and inertia (see hollow_cylinder)."


def _nominal_forces(scene: Scene, kinematics: Kinematics, inertia: FloatArray, *, coasts: bool) -> FloatArray:
    """Return the transverse force of each mesh, N: as given, or what balances the load torques at t = 0.

    `inertia` (shafts,) in kg m^2 is that of each shaft about its axis and, on a carrier, of the planets about
    the carrier's: a train without a drive accelerates where its torques do not balance. `coasts`: whether the
    coast flanks that are given carry load. Raises `InputError`: the balance does not determine a force that
    is needed, or a load pulls flanks apart that have no coast flank behind them.
    """
    stated = [mesh.nominal_force for mesh in scene.meshes]
    if all(force is not None for force in stated):
        return np.array(stated, dtype=float)
    # the balance of all shafts but those of drives; by least squares planets share a load equally
    lever = _levers(scene, kinematics)
    torque = _loads(scene, kinematics, np.zeros(1))[:, 0]
    torque -= inertia * _acceleration(scene, kinematics, inertia, torque)
    free = _shafts_without_drive(scene, kinematics)
    force, _, rank, _ = np.linalg.lstsq(lever[free], torque[free], rcond=1e-12)
    suggestion = "Give every mesh its nominal_force."
    if rank < lever.shape[1] and all(shaft.frame is None for shaft in scene.shafts):
        raise InputError("meshes", len(scene.meshes), "loaded in one way only by the torques", suggestion)
    force = force[: len(scene.meshes)]
    driving_only = [mesh.coast is None or not coasts for mesh in scene.meshes]
    for index, value in enumerate(force):
        if value < -1e-9 * np.max(np.abs(force)) and driving_only[index]:
            bound, suggestion = "loaded on its driving flank", "Turn the load, or give it its coast flank."
            raise InputError(f"meshes[{index}]", Quantity(float(value), "N", digits=6), bound, suggestion)
    balanced = np.where(driving_only, np.maximum(force, 0.0), np.abs(force))
    return np.array([b if g is None else g for g, b in zip(stated, balanced, strict=True)], dtype=float)


def mean_forces(mechanism: Mechanism) -> FloatArray:
    """Return what balances loads and imposed accelerations at moments that show how they run, (m, T) in N.

    Negative: the coast flank carries it. Where the balance leaves a choice, the one of least forces.
    """
    scene, kinematics, inertia = mechanism.scene, mechanism.kinematics, mechanism.rotational_inertia
    moments = _telling_moments(scene)
    torque = _loads(scene, kinematics, moments)
    imposed = np.array([slope(drive.speed, moments) for drive in scene.drives]).reshape(-1, moments.size)
    ratio = kinematics.float_ratio[:, : len(scene.drives)]
    torque -= inertia[:, None] * (ratio @ imposed)
    torque -= inertia[:, None] * _acceleration(scene, kinematics, inertia, torque)
    free = _shafts_without_drive(scene, kinematics)
    lever = _levers(scene, kinematics)[free]
    force = np.linalg.lstsq(lever, torque[free], rcond=1e-12)[0]
    return np.asarray(force[: len(scene.meshes)], dtype=float)


def _telling_moments(scene: Scene) -> FloatArray:
    """Return times that show how loads and drives run: the laws' knots, just before them, and between."""
    courses = [force.course for force in scene.forces if isinstance(force.course, TimeLaw)]
    laws = [*(drive.speed for drive in scene.drives), *(load.torque for load in scene.loads), *courses]
    stated = np.concatenate([np.empty(0), *(np.asarray(law.time, dtype=float) for law in laws)])
    inside = stated[(stated > 0.0) & (stated < scene.duration)]
    knots = np.unique(np.concatenate([[0.0, scene.duration], inside]))
    part = np.linspace(0.0, 1.0, BETWEEN_KNOTS, endpoint=False)
    between = knots[:-1, None] + np.diff(knots)[:, None] * part
    return np.concatenate([knots[:1], between.ravel(), np.nextafter(knots[1:], 0.0)])


def _shafts_without_drive(scene: Scene, kinematics: Kinematics) -> list[int]:
    driven = set(kinematics.law_shaft[: len(scene.drives)])
    return [index for index in range(len(scene.shafts)) if index not in driven]


def _loads(scene: Scene, kinematics: Kinematics, moments: FloatArray) -> FloatArray:
    """Mean load torque about +z on every shaft at `moments` (T,), (s, T)."""
    torque = np.zeros((len(scene.shafts), moments.size))
    for load in scene.loads:
        shaft = scene.shaft_index(load.shaft)
        torque[shaft] -= kinematics.sense[shaft] * load.torque(moments)
    laws = np.array([part.speed(moments) for part in scene.references])
    for part in scene.speed_torques:
        shaft = scene.shaft_index(part.shaft)
        sense = kinematics.sense[shaft]
        torque[shaft] -= sense * part.curve(sense * (kinematics.float_ratio[shaft] @ laws))
    for force in scene.forces:
        speed = 0.0
        if isinstance(force.course, BySpeed):
            shaft = scene.shaft_index(force.course.shaft)
            speed = kinematics.sense[shaft] * (kinematics.float_ratio[shaft] @ laws)
        shaft = scene.shaft_index(force.shaft)
        torque[shaft] += force.moment[2] * mean_factor(force.course, moments, speed)
    return torque


def _levers(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Torque on each shaft per mesh force (m) and per torque of a coupling, (shafts, meshes + couplings).

    The planets' centers go with the carrier, so that a mesh turns it by the difference of what it turns
    both gears by.
    """
    couplings = [coupling for coupling in scene.couplings if coupling.joins_rotations]
    lever = np.zeros((len(scene.shafts), len(scene.meshes) + len(couplings)))
    for column, coupling in enumerate(couplings, start=len(scene.meshes)):
        lever[scene.shaft_index(coupling.first), column] = 1.0
        lever[scene.shaft_index(coupling.second), column] = -1.0
    for column, mesh in enumerate(scene.meshes):
        driver, driven = scene.gear(mesh.driver), scene.gear(mesh.driven)
        a, b, carrier = mesh_shafts(scene, column)
        sense = kinematics.mesh_sense[column]
        turned_back = -1.0 if driver.internal or driven.internal else 1.0
        lever[a, column] += sense * driver.base_radius
        lever[b, column] += sense * turned_back * driven.base_radius
        if carrier is not None:
            lever[carrier, column] -= sense * (driver.base_radius + turned_back * driven.base_radius)
    return lever


def _acceleration(
    scene: Scene, kinematics: Kinematics, inertia: FloatArray, torque: FloatArray
) -> FloatArray:
    """Angular acceleration of each shaft of trains without a drive, rad/s^2, shaped as `torque` (s, ...)."""
    ratio = kinematics.float_ratio[:, len(scene.drives) :]
    if ratio.shape[1] == 0:
        return np.zeros_like(torque)
    law = np.linalg.solve(ratio.T @ (inertia[:, None] * ratio), ratio.T @ torque)
    return np.asarray(ratio @ law)


# Rotors that no bearing holds in a direction, but a coupling to one that is held there.


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
    matrix, kept = full_matrix(coupling.stiffness, 0.0)[:SEAT, :SEAT], np.zeros((SEAT, SEAT))
    at = np.ix_(kinds, kinds)
    kept[at] = matrix[at]
    lever = float(scene.shaft(coupling.first).origin[2] + coupling.position - rotor.center[2])
    return replace(rotor, curved=(*rotor.curved, (kept, lever)))


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
    """Transverse, N. Shape (m,)."""
    bearing_duty: dict[str, BearingDuty]
    """What is expected of each bearing."""
    bearings: tuple[BearingElement, ...]
    """Where the laws of bearings act that are not linear."""
    corrected: Corrections
    """Base radii of gears as given and as used, m."""
    additions: Additions
    """What the effects may add."""
    passing: frozenset[str] = frozenset()
    """Rolling bearings whose elements pass one by one."""
    phases: TrainPhases = NO_PHASES
    """Positions of the meshes, and what they rest on beyond the geometry."""

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
    forces = _nominal_forces(scene, kinematics, rotational_inertia(rotors), coasts=coasts)
    duties = bearing_duties(scene, rotors, forces)
    bearings = bearing_locations(scene, rotors, gather_supports(rotors, frozenset()).name, duties)
    known, stiffened = supports_by_name(rotors), list(rotors)
    for at in bearings:
        index, support = known[at.name]
        rotor = stiffened[index]
        stiffened[index] = replace(rotor, curved=(*rotor.curved, (at.seat, rotor.lever(support))))
    rotors = Bodies(_with_couplings(scene, stiffened))
    for index, rotor in enumerate(rotors):
        if index not in kinematics.imposed and rotor.inertia.polar <= 0.0:
            raise InputError(f"shafts[{index}].inertia.polar", 0.0, above(0.0), GIVE_INERTIA)
    made = Mechanism(scene, kinematics, rotors, lines, forces, duties, bearings, corrected, additions)
    return replace(made, phases=phases)
