"""The kinematic motion, the load torques and the drives' torques laid out for the compiled loops."""

from __future__ import annotations

import math

import numpy as np

from dynamics.system.arrays import Drives, Loads, Reference
from dynamics.system.connections import Connections
from dynamics.system.freedoms import ROTATION, Freedoms, mass_diagonal
from dynamics.system.kinematics import Kinematics
from dynamics.system.law_arrays import pack_laws, revolutions
from dynamics.system.mechanism import Mechanism
from dynamics.system.motion_check import check_loads
from dynamics.system.planets import carried_motion
from dynamics.system.scene import Scene
from dynamics.types import FloatArray


def lay_out_reference(
    scene: Scene, kinematics: Kinematics, freedoms: Freedoms, vectors: FloatArray
) -> Reference:
    """Lay out the kinematic motion; `vectors` (k, 6 r) are the laws' kinematic vectors."""
    laws = [part.speed for part in scene.references]
    turned = [revolutions(law) for law in laws]
    free = [-1] * len(scene.drives) + [
        freedoms.find(shaft, ROTATION) for shaft in kinematics.law_shaft[len(scene.drives) :]
    ]
    shape = (len(scene.meshes), len(laws))
    return Reference(
        pack_laws(laws),
        np.concatenate([whole for whole, _ in turned]),
        np.concatenate([fraction for _, fraction in turned]),
        np.array([[rate.numerator for rate in row] for row in kinematics.mesh_rate], dtype=np.int64).reshape(
            shape
        ),
        np.array(
            [[rate.denominator for rate in row] for row in kinematics.mesh_rate], dtype=np.int64
        ).reshape(shape),
        np.array([[float(rate) for rate in row] for row in kinematics.mesh_rate]).reshape(shape)
        / (2.0 * math.pi),
        np.array([mesh.position_offset for mesh in scene.meshes], dtype=float),
        np.array([mesh.table.period for mesh in scene.meshes], dtype=np.int64),
        np.array(free, dtype=np.int64),
        np.ascontiguousarray(vectors[:, freedoms.place]),
    )


def lay_out_loads(scene: Scene, kinematics: Kinematics, freedoms: Freedoms) -> Loads:
    """Lay out the load torques: each against the sense of its shaft."""
    check_loads(scene, kinematics)
    direction = np.zeros((len(scene.loads), len(scene.shafts), 6))
    for row, load in enumerate(scene.loads):
        shaft = scene.shaft_index(load.shaft)
        direction[row, shaft, ROTATION] = -kinematics.sense[shaft]
    on_drive = direction[:, list(kinematics.law_shaft), ROTATION] * np.array(kinematics.rigid)
    return Loads(
        pack_laws([load.torque for load in scene.loads]),
        freedoms.keep(direction.reshape(len(scene.loads), 6 * len(scene.shafts))),
        np.ascontiguousarray(direction[:, :, ROTATION] @ kinematics.float_ratio),
        np.ascontiguousarray(on_drive),
    )


def lay_out_drives(
    mechanism: Mechanism, freedoms: Freedoms, connections: Connections, gradient: FloatArray
) -> Drives:
    """Lay out what each drive's torque is made of: the balance of its own shaft, or its own spring."""
    scene, kinematics = mechanism.scene, mechanism.kinematics
    supports, seats, couplings = connections.supports, connections.seats, connections.couplings
    turned = _turned_alone(mechanism, freedoms)
    strained = np.einsum("bki,ai->bka", supports.motion, turned)
    moves = freedoms.keep(supports.motion)
    stiffness = supports.matrix(supports.stiffness, strained, moves)
    damping = supports.matrix(supports.damping, strained, moves)
    preloaded = np.zeros(turned.shape[0])
    if seats.name:  # planet bearings, which a carrier's rotation strains
        seated = turned @ seats.motion.T
        stiffness += seated @ seats.stiffness @ freedoms.keep(seats.motion)
        damping += seated @ seats.damping @ freedoms.keep(seats.motion)
        preloaded = seated @ seats.preload
    if couplings.name:
        twisted = np.einsum("cki,ai->cka", couplings.motion, turned)
        strains = freedoms.keep(couplings.motion)
        stiffness += couplings.matrix(couplings.stiffness, twisted, strains)
        damping += couplings.matrix(couplings.damping, twisted, strains)
    for law, drive in enumerate(scene.drives):
        if drive.stiffness is not None:
            column = freedoms.find(kinematics.law_shaft[law], ROTATION)
            stiffness[law, column], damping[law, column] = -drive.stiffness, -drive.damping
    return Drives(
        np.ascontiguousarray(turned @ gradient.T),
        np.ascontiguousarray(stiffness),
        np.ascontiguousarray(damping),
        np.ascontiguousarray(turned * mass_diagonal(mechanism.rotors) @ mechanism.vectors.T),
        np.einsum("bka,bk,bk->a", strained, supports.stiffness, supports.error) + preloaded,
    )


def _turned_alone(mechanism: Mechanism, freedoms: Freedoms) -> FloatArray:
    """Motion of all rotors per radian of each rigid drive's shaft alone, (k, 6 r); 0 for other laws."""
    kinematics = mechanism.kinematics
    turned = np.zeros((len(kinematics.law_shaft), 6 * len(mechanism.rotors)))
    own = carried_motion(mechanism.rotors, freedoms.place)
    for law, shaft in enumerate(kinematics.law_shaft):
        if kinematics.rigid[law]:
            turned[law] = own[:, 6 * shaft + ROTATION]
    return turned
