"""The plain arrays of a model, reduced to its free directions, which the compiled loops read.

All bodies have N freedoms: six of every rotor, elastic coordinates of shafts, amplitudes of housings. The n
free ones among them are those of the model; `Freedoms.keep` takes rows over the former to rows over the
latter. There are m meshes, and f phases of loads that repeat with the rotation of a shaft, frame or cage. The
kinematic motion is that of rigid meshes and drives; the freedoms are deviations from it.
"""

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
"""Smallest scale of an amplitude of a housing, as a share of the largest scale of its amplitudes."""


def system_arrays(model: Model, elements: Sequence[Element], laws: ElementLaws) -> SystemArrays:
    """Return the arrays of a model, reduced from all freedoms of its bodies to the free ones."""
    mechanism, freedoms, connections = model.mechanism, model.freedoms, model.connections
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    vectors = mechanism.vectors
    stiffness, damping, constant = connections.matrices(freedoms)
    constant = constant + freedoms.keep(_gravity_force(scene, rotors))
    shaft_stiffness, shaft_damping = elastic_matrices(rotors, freedoms)
    stiffness, damping = stiffness + shaft_stiffness, damping + shaft_damping
    for _law, drive, row in drive_springs(scene, kinematics, rotors, freedoms):
        stiffness += (drive.stiffness or 0.0) * np.outer(row, row)
        damping += drive.damping * np.outer(row, row)
    # motion^T M motion; `times_mass` multiplies rows from the right, and M is symmetric
    mass = freedoms.motion.T @ np.ascontiguousarray(times_mass(rotors, freedoms.motion.T).T)
    # Local coordinates of all elements, one below the other; without elements an array of no rows.
    gradient = np.concatenate(
        [np.empty((0, column_count(rotors))), *(element.gradient for element in elements)]
    )
    scale, direction = _scales(scene, rotors, freedoms), freedoms.keep(gradient)
    position_gradient = freedoms.keep(_position_gradient(mechanism))
    packed = Elements.packed(elements, laws, len(scene.references))
    # The first elements are the driving flanks of the meshes; their first row is the transmission error.
    transmission_error = direction[packed.first[: len(scene.meshes)]]
    # Diagonal of the stiffness with the meshes at their mean and the bearings at their typical stiffness.
    total_stiffness = np.diag(stiffness) + model.flanks.mean_stiffness @ transmission_error**2
    total_stiffness += packed.stiffness @ direction**2
    arrays = SystemArrays(
        mass=np.ascontiguousarray(mass),
        damping=damping,
        stiffness=stiffness,
        direction=direction,
        position_gradient=position_gradient,
        sparse=NO_ENTRIES,  # `with_matrices` fills them in
        constant=constant,
        inertial=freedoms.keep(-times_mass(rotors, vectors)),
        total_inertia=np.ascontiguousarray(times_mass(rotors, vectors) @ vectors.T),
        drive=drive_torques(mechanism, freedoms, connections, gradient),
        scale=scale,
        rate_scale=scale * _rate_duration(np.diag(mass), total_stiffness),
        elements=packed,
        reference=kinematic_motion(mechanism, freedoms),
        load=load_torques(mechanism, freedoms),
    )
    return by_address(arrays.with_matrices())


def _gravity_force(scene: Scene, rotors: Bodies) -> FloatArray:
    """Return the force of gravity per freedom of all rotors, (N,) in N.

    It acts at the centers of mass. An elastic coordinate does not move the center of mass of its body, so
    gravity does no work on it; shafts sag by the forces of their bearings.
    """
    acceleration = np.zeros(column_count(rotors))
    for axis, value in enumerate(scene.gravity):
        acceleration[axis : 6 * len(rotors) : 6] = value  # x, y or z of every rotor
    return np.asarray(times_mass(rotors, acceleration[None])[0])


def _position_gradient(mechanism: Mechanism) -> FloatArray:
    """Return the derivatives of mesh positions and load phases by the freedoms, (m + f, N).

    The position of a mesh, in base pitches, follows the rotation of its driver against the carrier. The phase
    of a load, in revolutions, follows its shaft. Phases of frames and cages follow the kinematic motion
    alone: their rows are zero.
    """
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    load_phases = phases(mechanism)
    position_gradient = np.zeros((len(scene.meshes) + len(load_phases), column_count(rotors)))
    for row, phase in enumerate(load_phases, start=len(scene.meshes)):  # below the rows of the meshes
        if phase.shaft is not None:
            position_gradient[row] += turn_row(rotors, phase.shaft, phase.position) / (2.0 * math.pi)
    for row, mesh in enumerate(scene.meshes):
        driver, _driven, carrier = mesh_shafts(scene, row)
        gear = scene.gear(mesh.driver)
        rate = kinematics.mesh_sense[row] * gear.teeth / (2.0 * math.pi)
        position_gradient[row] += rate * turn_row(rotors, driver, gear.position)
        if carrier is not None:
            position_gradient[row, 6 * carrier + ROTATION] -= rate
    return position_gradient


def _rate_duration(mass: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Return 1/natural circular frequency of every freedom alone, (n,) in s, from diagonals (n,).

    A rate times it is the displacement that the rate becomes. A freedom without stiffness, such as a rotor
    that only torques rotate, has the longest duration of the others; without others it is 1/`MIN_RATE`.
    """
    elastic = stiffness > 0.0
    duration = np.sqrt(mass / np.where(elastic, stiffness, 1.0))  # 1 in place of 0: not used below
    return np.where(elastic, duration, np.max(duration[elastic], initial=1.0 / MIN_RATE))


def _scales(scene: Scene, rotors: Bodies, freedoms: Freedoms) -> FloatArray:
    """Return the meters per unit of each freedom, (n,).

    The scale of a rotation or twist is the largest base radius on its shaft, or the radius of its pins if
    that is larger. The scale of an amplitude of a housing is the largest displacement of a seat per unit. It
    is at least `MIN_SEAT` of the largest such scale of the housing: modes that hardly move a seat do not
    matter to the shafts. Other freedoms are in meters already.
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
    # Displacements come before rotations.
    scale[:, 3:] = np.where(radius > 0.0, radius, largest)[:, None]
    elastic = [
        np.where(rotor.elastic.twists, rotor_scale[ROTATION], 1.0)
        for rotor, rotor_scale in zip(rotors, scale, strict=True)
        if rotor.elastic is not None
    ]
    per_strain = np.array([1.0, 1.0, 1.0, largest, largest])[:, None]  # x, y, z, two tilts of a seat
    # A shape has the axes seat, direction, mode: the largest over the first two is left for every mode.
    seats = [np.max(np.abs(housing.shape) * per_strain, axis=(0, 1)) for housing in rotors.housings]
    amplitudes = [np.maximum(seat, MIN_SEAT * np.max(seat)) for seat in seats]
    # In the order of all freedoms; the free ones of them are kept.
    return np.ascontiguousarray(np.concatenate([scale.ravel(), *elastic, *amplitudes])[freedoms.column])
