"""A model laid out as the plain arrays that the compiled loops see."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from dynamics.arrays.arrays import SystemArrays
from dynamics.arrays.elements import Element, gradients, pack_elements
from dynamics.arrays.sparse_rows import NO_ENTRIES
from dynamics.assembly.model import Model
from dynamics.assembly.phases import phases
from dynamics.assembly.references import drive_springs, lay_out_drives, lay_out_loads, lay_out_reference
from dynamics.forces.by_address import by_address
from dynamics.forces.element_laws import ElementLaws
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import column_count, times_mass, turn_row
from dynamics.mechanism.connections import elastic_matrices, linear_matrices
from dynamics.mechanism.freedoms import FREEDOMS, ROTATION, Freedoms
from dynamics.mechanism.kinematics import mesh_shafts
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.modal_housing import ModalHousing
from dynamics.mechanism.weight import weight
from dynamics.scene.scene import LEAST_RATE, Scene
from dynamics.types import FloatArray

LEAST_SEAT = 0.1
"""Least scale of an amplitude, of the largest."""


def system_arrays(model: Model, elements: Sequence[Element], laws: ElementLaws) -> SystemArrays:
    """Reduce every array over all freedoms to the free directions."""
    mechanism, freedoms, joined = model.mechanism, model.freedoms, model.connections
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    vectors = mechanism.vectors
    stiffness, damping, constant = linear_matrices(joined, freedoms)
    constant = constant + freedoms.keep(weight(scene, rotors))
    own_stiffness, own_damping = elastic_matrices(rotors, freedoms)
    stiffness, damping = stiffness + own_stiffness, damping + own_damping
    for _, drive, row in drive_springs(scene, kinematics, rotors, freedoms):
        stiffness += (drive.stiffness or 0.0) * np.outer(row, row)
        damping += drive.damping * np.outer(row, row)
    mass = freedoms.motion.T @ np.ascontiguousarray(times_mass(rotors, freedoms.motion.T).T)
    gradient = gradients(elements, column_count(rotors))
    scale, direction = _scales(scene, rotors, freedoms), freedoms.keep(gradient)
    turn = freedoms.keep(_turns(mechanism))
    packed = pack_elements(elements, laws, len(scene.references))
    along = direction[packed.first[: len(scene.meshes)]]
    held = np.diag(stiffness) + model.flanks.mean_stiffness @ along**2
    held += packed.stiffness @ direction**2
    arrays = SystemArrays(
        np.ascontiguousarray(mass),
        damping,
        stiffness,
        direction,
        turn,
        NO_ENTRIES,
        constant,
        freedoms.keep(-times_mass(rotors, vectors)),
        np.ascontiguousarray(times_mass(rotors, vectors) @ vectors.T),
        lay_out_drives(mechanism, freedoms, joined, gradient),
        scale,
        scale * _reach(np.diag(mass), held),
        packed,
        lay_out_reference(mechanism, freedoms),
        lay_out_loads(mechanism, freedoms),
    )
    return by_address(arrays.with_matrices())


def _turns(mechanism: Mechanism) -> FloatArray:
    """Return the derivatives of each position, (m + f, N): the driver's rotation against its carrier's.

    Frames and cages turn with the kinematic motion alone, angles of loads with their shafts.
    """
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    further = phases(mechanism)
    turn = np.zeros((len(scene.meshes) + len(further), column_count(rotors)))
    for row, phase in enumerate(further, start=len(scene.meshes)):
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


def _reach(mass: FloatArray, held: FloatArray) -> FloatArray:
    """Return how long an error of each rate moves the freedom on, (n,) s: 1/natural circular frequency.

    What nothing holds, a rotor that torques alone turn, takes that of the slowest freedom that is held.
    """
    bound = held > 0.0
    own = np.sqrt(mass / np.where(bound, held, 1.0))
    return np.where(bound, own, np.max(own[bound], initial=1.0 / LEAST_RATE))


def _scales(scene: Scene, rotors: Bodies, freedoms: Freedoms) -> FloatArray:
    """Meters per unit of each freedom, (n,): for rotations the largest base or pin radius on the shaft.

    For an amplitude of a housing what it moves a seat by, at least a tenth of what any of them does: modes
    that hardly move a seat do not matter to the shafts.
    """
    largest = max((gear.base_radius for gear in scene.gears), default=1.0)
    radius = np.zeros(len(rotors))
    for gear in scene.gears:
        shaft = scene.shaft_index(gear.shaft)
        radius[shaft] = max(radius[shaft], gear.base_radius)
    for rotor in rotors:
        if rotor.carrier is not None:
            arm = rotor.center - rotors[rotor.carrier].center
            radius[rotor.carrier] = max(radius[rotor.carrier], float(np.hypot(arm[0], arm[1])))
    scale = np.ones((len(rotors), len(FREEDOMS)))
    scale[:, 3:] = np.where(radius > 0.0, radius, largest)[:, None]
    elastic = [
        np.where(rotor.elastic.twists, own[ROTATION], 1.0)
        for rotor, own in zip(rotors, scale, strict=True)
        if rotor.elastic is not None
    ]
    seats = [_seat_scale(housing, largest) for housing in rotors.housings]
    return np.ascontiguousarray(np.concatenate([scale.ravel(), *elastic, *seats])[freedoms.column])


def _seat_scale(housing: ModalHousing, lever: float) -> FloatArray:
    """Return the largest motion of a seat per amplitude, (m,), tilts by a lever."""
    moved = np.max(np.abs(housing.shape) * np.array([1.0, 1.0, 1.0, lever, lever])[:, None], axis=(0, 1))
    return np.asarray(np.maximum(moved, LEAST_SEAT * np.max(moved)))
