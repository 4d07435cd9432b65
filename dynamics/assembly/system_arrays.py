"""The plain arrays of a model, reduced to its free directions, which the compiled loops see."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.sparse_rows import NO_ENTRIES
from dynamics.assembly.model import Model
from dynamics.assembly.motion_and_loads import drive_springs, drive_torques, kinematic_motion, load_torques
from dynamics.forces.elements import Element, Elements
from dynamics.forces.laws import ElementLaws
from dynamics.kernels.by_address import by_address
from dynamics.mechanism.bearing_elements import tilt_lever
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.carried_planets import FREEDOMS, ROTATION
from dynamics.mechanism.columns import column_count, times_mass, turn_row
from dynamics.mechanism.connections import elastic_matrices
from dynamics.mechanism.freedoms import Freedoms
from dynamics.mechanism.kinematics import mesh_shafts
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.phases import phases
from dynamics.scene.scene import MIN_RATE, Scene
from dynamics.types import FloatArray

MIN_SEAT = 0.1
"""Least scale of a housing's amplitude, as a share of its largest."""


def system_arrays(model: Model, elements: Sequence[Element], laws: ElementLaws) -> SystemArrays:
    """Return the arrays of a model, reduced from all freedoms of its rotors to the free directions."""
    mechanism, freedoms, joined = model.mechanism, model.freedoms, model.connections
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    vectors = mechanism.vectors
    stiffness, damping, constant = joined.matrices(freedoms)
    constant = constant + freedoms.keep(_gravity_force(scene, rotors))
    shaft_stiffness, shaft_damping = elastic_matrices(rotors, freedoms)
    stiffness, damping = stiffness + shaft_stiffness, damping + shaft_damping
    for _, drive, row in drive_springs(scene, kinematics, rotors, freedoms):
        stiffness += (drive.stiffness or 0.0) * np.outer(row, row)
        damping += drive.damping * np.outer(row, row)
    mass = freedoms.motion.T @ np.ascontiguousarray(times_mass(rotors, freedoms.motion.T).T)
    gradient = np.concatenate(
        [np.empty((0, column_count(rotors))), *(element.gradient for element in elements)]
    )
    scale, direction = _scales(scene, rotors, freedoms), freedoms.keep(gradient)
    turn = freedoms.keep(_turns(mechanism))
    packed = Elements.packed(elements, laws, len(scene.references))
    along = direction[packed.first[: len(scene.meshes)]]
    total_stiffness = np.diag(stiffness) + model.flanks.mean_stiffness @ along**2
    total_stiffness += packed.stiffness @ direction**2
    arrays = SystemArrays(
        mass=np.ascontiguousarray(mass),
        damping=damping,
        stiffness=stiffness,
        direction=direction,
        turn=turn,
        sparse=NO_ENTRIES,
        constant=constant,
        inertial=freedoms.keep(-times_mass(rotors, vectors)),
        total_inertia=np.ascontiguousarray(times_mass(rotors, vectors) @ vectors.T),
        drive=drive_torques(mechanism, freedoms, joined, gradient),
        scale=scale,
        rate_scale=scale * _rate_duration(np.diag(mass), total_stiffness),
        elements=packed,
        reference=kinematic_motion(mechanism, freedoms),
        load=load_torques(mechanism, freedoms),
    )
    return by_address(arrays.with_matrices())


def _gravity_force(scene: Scene, rotors: Bodies) -> FloatArray:
    """Return the force of gravity per freedom of all rotors, (N,) in N.

    It acts at the centers of mass: elastic coordinates share no momentum with the rigid motion, so gravity
    does no work on them. Shafts sag by what their bearings do to them.
    """
    acceleration = np.zeros(column_count(rotors))
    for axis, value in enumerate(scene.gravity):
        acceleration[axis : 6 * len(rotors) : 6] = value
    return np.asarray(times_mass(rotors, acceleration[None])[0])


def _turns(mechanism: Mechanism) -> FloatArray:
    """Return the derivatives of all positions in the freedoms, (m + f, N).

    The position of a mesh follows the rotation of its driver against the carrier, the angle of a load its
    shaft. Frames and cages turn with the kinematic motion alone.
    """
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    frame_turns = phases(mechanism)
    turn = np.zeros((len(scene.meshes) + len(frame_turns), column_count(rotors)))
    for row, phase in enumerate(frame_turns, start=len(scene.meshes)):
        if phase.shaft is not None:
            turn[row] += turn_row(rotors, phase.shaft, phase.position) / (2.0 * math.pi)
    for row, mesh in enumerate(scene.meshes):
        driver, _, carrier = mesh_shafts(scene, row)
        gear = scene.gear(mesh.driver)
        rate = kinematics.mesh_sense[row] * gear.teeth / (2.0 * math.pi)
        turn[row] += rate * turn_row(rotors, driver, gear.position)
        if carrier is not None:
            turn[row, 6 * carrier + ROTATION] -= rate
    return turn


def _rate_duration(mass: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Return how long an error of a rate moves its freedom on, 1/natural circular frequency, (n,) s.

    A freedom without stiffness, a rotor that torques alone turn, takes the longest of the others.
    """
    elastic = stiffness > 0.0
    duration = np.sqrt(mass / np.where(elastic, stiffness, 1.0))
    return np.where(elastic, duration, np.max(duration[elastic], initial=1.0 / MIN_RATE))


def _scales(scene: Scene, rotors: Bodies, freedoms: Freedoms) -> FloatArray:
    """Return the meters per unit of each freedom, (n,).

    A rotation has the largest base or pin radius on its shaft. An amplitude of a housing has the largest
    displacement of a seat per unit, at least `MIN_SEAT` of the largest of all amplitudes: modes that hardly
    move a seat do not matter to the shafts.
    """
    largest = tilt_lever(scene)
    radius = np.zeros(len(rotors))
    for gear in scene.gears:
        shaft = scene.shaft_index(gear.shaft)
        radius[shaft] = max(radius[shaft], gear.base_radius)
    for rotor in rotors:
        if rotor.carrier is not None:
            arm = rotor.center - rotors[rotor.carrier].center
            radius[rotor.carrier] = max(radius[rotor.carrier], float(np.hypot(arm[0], arm[1])))
    scale = np.ones((len(rotors), len(FREEDOMS)))
    # displacements come before rotations
    scale[:, 3:] = np.where(radius > 0.0, radius, largest)[:, None]
    elastic = [
        np.where(rotor.elastic.twists, of_rotor[ROTATION], 1.0)
        for rotor, of_rotor in zip(rotors, scale, strict=True)
        if rotor.elastic is not None
    ]
    per_strain = np.array([1.0, 1.0, 1.0, largest, largest])[:, None]  # x, y, z, two tilts of a seat
    amplitudes = [np.max(np.abs(housing.shape) * per_strain, axis=(0, 1)) for housing in rotors.housings]
    seats = [np.maximum(amplitude, MIN_SEAT * np.max(amplitude)) for amplitude in amplitudes]
    return np.ascontiguousarray(np.concatenate([scale.ravel(), *elastic, *seats])[freedoms.column])
