"""The arrays of the kinematic motion, the load torques and the drives' torques.

Axis letters: k laws of the kinematic motion (drives, then free rotations), l loads, m meshes and f rotations
of frames, cages and loads, n freedoms that are solved for, N freedoms of all bodies (`columns`), R local
coordinates of the force elements.
"""

from __future__ import annotations

import math

import numpy as np

from dynamics.arrays.arrays import Drives, KinematicMotion, Loads, revolutions
from dynamics.joints import ImposedRotation
from dynamics.kernels.cubics import Cubics
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.carried_planets import ROTATION, carried_motion
from dynamics.mechanism.columns import column_count, elastic_columns, elastic_terms, times_mass, turn_row
from dynamics.mechanism.connections import Connections
from dynamics.mechanism.freedoms import Freedoms
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.mechanism import Mechanism
from dynamics.mechanism.motion_checks import check_loads
from dynamics.mechanism.phases import phases
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def kinematic_motion(mechanism: Mechanism, freedoms: Freedoms) -> KinematicMotion:
    """Return the kinematic motion of the positions of the meshes, then of the rotations by `phases`."""
    scene, kinematics, vectors = mechanism.scene, mechanism.kinematics, mechanism.vectors
    laws = [part.speed for part in scene.references]
    starts = [revolutions(law) for law in laws]  # revolutions at the start of each piece: whole, remainder
    # a drive imposes its rotation: no freedom, -1
    free = [-1] * len(scene.drives) + [
        freedoms.find(shaft, ROTATION) for shaft in kinematics.law_shaft[len(scene.drives) :]
    ]
    turns = phases(mechanism)
    rates = (*kinematics.mesh_rate, *(phase.rate for phase in turns))
    numerator = np.zeros((len(rates), len(laws)), dtype=np.int64)
    denominator, per_revolution = np.ones_like(numerator), np.zeros(numerator.shape)
    for row, rates_of_row in enumerate(rates):
        for law, rate in enumerate(rates_of_row):
            numerator[row, law], denominator[row, law] = rate.numerator, rate.denominator
            per_revolution[row, law] = float(rate)
    return KinematicMotion(
        speed=Cubics.packed([law.polynomials() for law in laws]),
        full_turns=np.concatenate([full_turns for full_turns, _ in starts]),
        fraction=np.concatenate([fraction for _, fraction in starts]),
        numerator=numerator,
        denominator=denominator,
        per_radian=per_revolution / (2.0 * math.pi),
        offset=np.concatenate([mechanism.phases.position, np.zeros(len(turns))]),
        period=np.array(
            [*(mesh.table.period for mesh in scene.meshes), *(phase.turns for phase in turns)], dtype=np.int64
        ),
        freedom=np.array(free, dtype=np.int64),
        vector=np.ascontiguousarray(vectors[:, freedoms.column]),
    )


def load_torques(mechanism: Mechanism, freedoms: Freedoms) -> Loads:
    """Return the load torques, each against the sense of its shaft, at its position along the shaft."""
    scene, kinematics, rotors = mechanism.scene, mechanism.kinematics, mechanism.rotors
    check_loads(scene, kinematics)
    direction = np.zeros((len(scene.loads), column_count(rotors)))
    for row, load in enumerate(scene.loads):
        shaft = scene.shaft_index(load.shaft)
        direction[row] -= kinematics.sense[shaft] * turn_row(rotors, shaft, load.position)
    rotation = direction[:, 6 * np.arange(len(rotors)) + ROTATION]
    # work of a unit torque as the shaft of a law turns; 0 for laws whose drive is not rigid
    on_drive = direction @ _shaft_motions(mechanism).T * np.array(kinematics.rigid)
    return Loads(
        torque=Cubics.packed([load.torque.polynomials() for load in scene.loads]),
        direction=freedoms.keep(direction),
        reference=np.ascontiguousarray(rotation @ kinematics.float_ratio),
        drive=np.ascontiguousarray(on_drive),
    )


def drive_torques(
    mechanism: Mechanism, freedoms: Freedoms, connections: Connections, gradient: FloatArray
) -> Drives:
    """Return the parts of the drives' torques: the balance of the driven shaft, or the drive's spring.

    A rigid drive's torque is the work of all forces as its shaft alone turns by one radian. `gradient` (R, N)
    holds the rows of all force elements.
    """
    scene, kinematics = mechanism.scene, mechanism.kinematics
    supports, seats, couplings = connections.supports, connections.seats, connections.couplings
    turned = _turned_alone(mechanism, freedoms)
    # b supports, k directions of a support, i columns, a laws
    strained = np.einsum("bki,ai->bka", supports.motion, turned)
    moves = freedoms.keep(supports.motion)
    stiffness = supports.matrix(supports.stiffness, strained, moves)
    damping = supports.matrix(supports.damping, strained, moves)
    preloaded = np.zeros(turned.shape[0])
    if seats.name:  # planet bearings, which a carrier's rotation strains
        seat_strain = turned @ seats.motion.T
        stiffness += seat_strain @ seats.stiffness @ freedoms.keep(seats.motion)
        damping += seat_strain @ seats.damping @ freedoms.keep(seats.motion)
        preloaded = seat_strain @ seats.preload
    if couplings.name:
        twisted = np.einsum("cki,ai->cka", couplings.motion, turned)  # c couplings, k strains
        strains = freedoms.keep(couplings.motion)
        stiffness += couplings.matrix(couplings.stiffness, twisted, strains)
        damping += couplings.matrix(couplings.damping, twisted, strains)
    springs, dampers = elastic_terms(mechanism.rotors)
    stiffness += (turned * springs) @ freedoms.motion
    damping += (turned @ dampers) @ freedoms.motion
    for law, drive, row in drive_springs(scene, kinematics, mechanism.rotors, freedoms):
        stiffness[law] -= (drive.stiffness or 0.0) * row
        damping[law] -= drive.damping * row
    return Drives(
        direction=np.ascontiguousarray(turned @ gradient.T),
        stiffness=np.ascontiguousarray(stiffness),
        damping=np.ascontiguousarray(damping),
        inertia=np.ascontiguousarray(times_mass(mechanism.rotors, turned) @ mechanism.vectors.T),
        constant=np.einsum("bka,bk,bk->a", strained, supports.stiffness, supports.error) + preloaded,
    )


def _turned_alone(mechanism: Mechanism, freedoms: Freedoms) -> FloatArray:
    """Return the motion of all rotors as the shaft of a rigid drive alone turns, per radian, (k, N).

    The rows of other laws are 0.
    """
    kinematics = mechanism.kinematics
    turned = np.zeros((len(kinematics.law_shaft), column_count(mechanism.rotors)))
    carried = carried_motion(mechanism.rotors, freedoms.column)
    for law, motion in enumerate(_shaft_motions(mechanism)):
        if kinematics.rigid[law]:
            turned[law] = carried @ motion
    return turned


def _shaft_motions(mechanism: Mechanism) -> FloatArray:
    """Return the motion of each law's shaft per radian at the position of the imposed rotation, (k, N).

    A flexible shaft has many motions with this rotation. This one shares no kinetic energy with the elastic
    coordinates, so that work on it leaves out their accelerations.
    """
    rotors = mechanism.rotors
    motions = np.zeros((len(mechanism.kinematics.law_shaft), column_count(rotors)))
    for law, shaft in enumerate(mechanism.kinematics.law_shaft):
        motions[law, 6 * shaft + ROTATION] = 1.0
        elastic = rotors[shaft].elastic
        if elastic is not None:
            motions[law, elastic_columns(rotors, shaft)] = -elastic.turned / elastic.mass
    return motions


def drive_springs(
    scene: Scene, kinematics: Kinematics, rotors: Bodies, freedoms: Freedoms
) -> list[tuple[int, ImposedRotation, FloatArray]]:
    """Return for each drive with a spring its law, the drive, and the rotation of the spring's end (n,).

    The rotation is per unit of each freedom.
    """
    springs = []
    for law, drive in enumerate(scene.drives):
        if drive.stiffness is not None:
            shaft = kinematics.law_shaft[law]
            springs.append((law, drive, freedoms.keep(turn_row(rotors, shaft, drive.position))))
    return springs
