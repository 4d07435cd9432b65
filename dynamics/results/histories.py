"""Time series of a run from its trajectory: forces, transmission errors, speeds.

The trajectory holds deviations q and their rates v from the kinematic motion, in which all shafts turn by
exact ratios to k *laws* of motion. *Quanta* count the small parts of a revolution by which the rotation of a
train without a drive was moved from q into that motion. *Local* forces and coordinates are those of the force
elements: a mesh has a row for its driving flank, and rows for the axes of its table (misalignment, center
distance). Sizes: T times, n freedoms, R local rows, m meshes, b bearings, s shafts, c couplings, d drives.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.bearings.seat import SEAT
from dynamics.forces.elements import SPATIAL_FLANK
from dynamics.mechanism.additions import CENTER_DISTANCE_CHANGE, LOAD_ARM, MISALIGNMENT
from dynamics.mechanism.carried_planets import ROTATION
from dynamics.mechanism.flank_gradients import common_face_width, table_sense
from dynamics.motion.motion import ACCELERATION, FRACTION, FULL_TURNS, QUANTA_PER_TURN, SPEED
from dynamics.motion.observation import Observed, static_deflections
from dynamics.motion.sampled_states import States
from dynamics.types import FloatArray, IntArray

FIELDS = (MISALIGNMENT, CENTER_DISTANCE_CHANGE)
"""Axes of tables beside position and load, named like the fields of a mesh and the effects."""


def _axis_series(system: System, coordinate: FloatArray, force: FloatArray) -> dict[str, FloatArray]:
    """Return `misalignment`, `center_distance_change` and `load_arm`, (m, T) in m.

    `coordinate` and `force` (R, T) are those of all local rows. A series is (0, T) if its effect is on in no
    mesh. A mesh whose axis does not move has the value of the scene.
    """
    meshes, samples = len(system.scene.meshes), force.shape[1]
    series = {}
    for axis, field in enumerate(FIELDS):
        fixed = np.array([getattr(mesh, field) for mesh in system.scene.meshes])
        values = np.repeat(fixed[:, None], samples, axis=1)
        for mesh, row in axis_rows(system, axis, follows=True).items():
            values[mesh] = coordinate[row]
        series[field] = values if system.ledger.adds(field) else np.empty((0, samples))
    arm = np.zeros((meshes if system.ledger.adds(LOAD_ARM) else 0, samples))
    if arm.size:
        for mesh, row in axis_rows(system, 0, follows=False).items():
            pushed = force[system.driving_rows[mesh]]
            lever = -force[row] / np.where(pushed > 0.0, pushed, 1.0)  # 1: no force, so the arm is 0
            sense = table_sense(system.scene, mesh, system.kinematics.mesh_sense[mesh])
            arm[mesh] = -sense * common_face_width(system.scene, mesh) * lever
    return {**series, LOAD_ARM: arm}


def axis_rows(system: System, axis: int, *, follows: bool) -> dict[int, int]:
    """Return the local row of an axis of the table, by mesh; a mesh without such a row is left out.

    `axis` is an index in `FIELDS`. With `follows` only meshes whose table is read at the moving coordinate.
    """
    elements, laws = system.arrays.elements, system.arrays.elements.laws.spatial_flank
    rows = {}
    for mesh in range(len(system.scene.meshes)):
        if elements.law[mesh] != SPATIAL_FLANK:
            continue
        row = laws.row[elements.entry[mesh], axis]  # counted from the element's first row; 0: no such row
        if row > 0 and (laws.follows[elements.entry[mesh], axis] == 1 or not follows):
            rows[mesh] = int(elements.first[mesh] + row)
    return rows


class _Signals(NamedTuple):
    """The signals from which the series are made, at T times."""

    q: FloatArray
    v: FloatArray
    """`q`, `v`: Deviations and their rates. The modal freedoms, the last ones, may be missing. Shape (T, n)
    each."""
    coordinate: FloatArray
    force: FloatArray
    """`coordinate`, `force`: Local coordinates and local forces of the elements. Shape (R, T) each."""
    static: FloatArray
    """Static transmission error, m. Shape (m, T)."""


def unfiltered(system: System, seen: Observed, states: States) -> _Signals:
    """Return the signals at the sampled times, without the anti-alias filter."""
    position = seen.position[: len(system.scene.meshes)]
    static = np.empty_like(position)
    for f, force in enumerate(system.flanks.nominal_force):
        static_deflections(system.flanks.static, f, position[f], float(force), static[f])
    return _Signals(states.q, states.v, seen.coordinate, seen.force, static)


def filtered(system: System, states: States, seen: Observed) -> _Signals:
    """Return the signals behind the anti-alias filter.

    Without modal freedoms among the filtered channels these are left out, and the coordinates that they move
    are taken unfiltered from `seen`: no output has them.
    """
    rows, channels, modal = states.minimum.shape[1], states.filtered, system.arrays.sparse.modal
    n, meshes = modal.first, system.flanks.nominal_force.size
    # channels in their order: local forces, q, v, STE of the meshes, modal amplitudes and their rates
    force, q, v, static, amplitudes = np.split(channels, np.cumsum([rows, n, n, meshes]), axis=1)
    coordinate = system.arrays.elements.offset + q @ system.arrays.direction[:, :n].T
    coordinate, force, static = (np.ascontiguousarray(part.T) for part in (coordinate, force, static))
    displacement, rate = np.split(amplitudes, 2, axis=1)
    if amplitudes.shape[1] > 0:
        coordinate += system.arrays.direction[:, n:] @ displacement.T
    else:
        coordinate[modal.row] = seen.coordinate[modal.row]
    q, v = np.concatenate([q, displacement], axis=1), np.concatenate([v, rate], axis=1)
    return _Signals(q, v, coordinate, force, static)


def histories(
    system: System, time: FloatArray, laws: FloatArray, states: States, seen: Observed, signals: _Signals
) -> dict[str, Any]:
    """Return the series of `RunResult` by the names of its fields.

    `laws` (4, k, T) is the motion of the laws at `time` (T,). Forces, speeds and displacements are those of
    `signals`; positions, contact and the extremes of mesh forces are unfiltered, from `seen` and `states`.
    """
    scene = system.scene
    q, v, quanta = signals.q, signals.v, states.quanta
    outputs = scene.outputs
    force, moment = _ground_reactions(system, laws, signals.force, q, v, quanta)
    driving = system.driving_rows
    return {
        "time": time,
        "mesh": tuple(mesh.name for mesh in scene.meshes),
        "shaft": tuple(shaft.name for shaft in scene.shafts),
        "bearing": system.supports.name if outputs.bearing_forces else (),
        "freedom": system.freedoms.name if outputs.displacements else (),
        "drive": tuple(drive.name for drive in scene.drives),
        "coupling": system.couplings.name,
        "position": seen.position[: len(scene.meshes)],
        "mesh_frequency": _mesh_frequency(system, laws[SPEED], v),
        "dynamic_transmission_error": signals.coordinate[driving],
        "static_transmission_error": signals.static,
        "mesh_force": signals.force[driving],
        "coast_force": _coast_force(system, signals.force),
        "least_mesh_force": np.ascontiguousarray(states.minimum[:, driving].T),
        "largest_mesh_force": np.ascontiguousarray(states.largest[:, driving].T),
        "elastic_force": seen.elastic[driving] if outputs.elastic_forces else np.empty((0, time.size)),
        "contact": _contact(system, seen.force),
        **_axis_series(system, signals.coordinate, signals.force),
        "speed": _speed(system, laws[SPEED], v),
        "drive_torque": _drive_torque(system, time, laws[ACCELERATION], signals.force, q, v),
        "coupling_torque": _coupling_torque(system, q, v),
        "bearing_force": force,
        "bearing_moment": moment,
        "displacement": np.ascontiguousarray(q.T) if outputs.displacements else np.empty((0, time.size)),
        "velocity": np.ascontiguousarray(v.T) if outputs.displacements else np.empty((0, time.size)),
        "nominal_force": system.flanks.nominal_force,
        **_accelerations(system, laws, time, signals, quanta),
    }


def checked_series(
    system: System, time: FloatArray, laws: FloatArray, states: States, seen: Observed
) -> dict[str, Any]:
    """Return the unfiltered series by which a run is checked (`RunChecks`)."""
    driving = system.driving_rows
    return {
        "time": time,
        "position": seen.position[: len(system.scene.meshes)],
        "dynamic_transmission_error": seen.coordinate[driving],
        "mesh_force": seen.force[driving],
        "coast_force": _coast_force(system, seen.force),
        "least_mesh_force": states.minimum[:, driving].T,
        "largest_mesh_force": states.largest[:, driving].T,
        **_axis_series(system, seen.coordinate, seen.force),
        "bearing_force": _ground_reactions(system, laws, seen.force, states.q, states.v, states.quanta)[0],
    }


def _contact(system: System, force: FloatArray) -> FloatArray:
    """Return which flanks of each mesh carry, (m, T): 1 the driving, 2 the coast flank, 3 both, 0 none."""
    coast = _coast_force(system, force)
    carrying = (force[system.driving_rows] > 0.0).astype(float)
    return carrying + 2.0 * (coast > 0.0) if coast.size else carrying


def _accelerations(
    system: System, laws: FloatArray, time: FloatArray, signals: _Signals, quanta: IntArray
) -> dict[str, FloatArray]:
    """Return accelerations of the freedoms, and of the shafts at their bearings; empty if not requested."""
    samples = len(quanta)
    series = {"acceleration": np.empty((0, samples)), "bearing_acceleration": np.empty((0, 3, samples))}
    if not system.scene.outputs.accelerations:
        return series
    acceleration = _acceleration(system, laws[ACCELERATION], time, signals)
    if system.scene.outputs.displacements:
        series["acceleration"] = acceleration
    if system.scene.outputs.bearing_forces:
        moves = system.freedoms.keep(system.supports.motion + system.supports.seat)
        bearings, _, freedoms = moves.shape
        seats = (moves.reshape(3 * bearings, freedoms) @ acceleration).reshape(bearings, 3, samples)
        series["bearing_acceleration"] = _in_fixed_frame(system, seats, laws, quanta)
    return series


def _acceleration(system: System, laws: FloatArray, time: FloatArray, signals: _Signals) -> FloatArray:
    """Return q'' (n, T) from the equations of motion.

    They are linear in the signals, so that q'' is filtered if these are. `laws` (k, T) has the accelerations
    of the laws.
    """
    arrays = system.arrays
    force = arrays.inertial.T @ laws + arrays.constant[:, None]
    for row, load in enumerate(system.scene.loads):
        force += arrays.load.direction[row][:, None] * load.torque(time)
    force -= arrays.damping @ signals.v.T + arrays.stiffness @ signals.q.T
    return np.asarray(np.linalg.solve(arrays.mass, force - arrays.direction.T @ signals.force))


def _ground_reactions(
    system: System, laws: FloatArray, local: FloatArray, q: FloatArray, v: FloatArray, quanta: IntArray
) -> tuple[FloatArray, FloatArray]:
    """Return forces and moments on the ground, (b, 3, T) each; (0, 3, T) each if not requested.

    Moments are (0, 3, T) also where no bearing holds tilt.
    """
    none = np.empty((0, 3, q.shape[0]))
    if not system.scene.outputs.bearing_forces:
        return none, none
    reaction = system.bearing_force(local, q, v)  # (b, 3 or 6, T): force, then moment
    force, moment = reaction[:, :3], reaction[:, 3:]
    fixed = _in_fixed_frame(system, np.ascontiguousarray(force), laws, quanta)
    if not _holds_tilt(system):
        return fixed, none
    return fixed, _in_fixed_frame(system, np.ascontiguousarray(moment), laws, quanta)


def _holds_tilt(system: System) -> bool:
    """Whether any bearing exerts a moment."""
    if any(at.tilts for at in (*system.housed, *system.bearings)):
        return True
    matrices = (system.bearing_stiffness[:, 3:], system.bearing_damping[:, 3:])
    return any(bool(np.any(matrix)) for matrix in (*matrices, system.seats.preload.reshape(-1, SEAT)[:, 3:]))


def _in_fixed_frame(system: System, force: FloatArray, laws: FloatArray, quanta: IntArray) -> FloatArray:
    """Rotate vectors of bearings in a carrier's frame into the fixed one, (b, 3, T), in place."""
    ratio = system.kinematics.float_ratio
    turned = laws[FULL_TURNS] + laws[FRACTION] + quanta.T / QUANTA_PER_TURN
    for bearing, frame in enumerate(system.supports.frame):
        if frame is None:
            continue
        angle = 2.0 * math.pi * (ratio[frame] @ turned)
        x, y = force[bearing, 0].copy(), force[bearing, 1].copy()
        force[bearing, 0] = np.cos(angle) * x - np.sin(angle) * y
        force[bearing, 1] = np.sin(angle) * x + np.cos(angle) * y
    return force


def _coupling_torque(system: System, q: FloatArray, v: FloatArray) -> FloatArray:
    """Return the torque about +z from the first shaft of each coupling on the second, (c, T)."""
    couplings = system.couplings
    strains = system.freedoms.keep(couplings.motion)  # relative motions per freedom, (c, 6, n)
    strains = strains[..., : q.shape[1]]  # without modal freedoms, where q lacks them
    elastic = np.einsum("cl,cln,tn->ct", couplings.stiffness[:, ROTATION], strains, q)
    viscous = np.einsum("cl,cln,tn->ct", couplings.damping[:, ROTATION], strains, v)
    return np.ascontiguousarray(-elastic - viscous)


def _mesh_frequency(system: System, speed: FloatArray, v: FloatArray) -> FloatArray:
    """Return base pitches per second in the mean motion, (m, T)."""
    reference = system.arrays.reference
    rotating = speed.copy()
    for law, freedom in enumerate(reference.freedom):
        if freedom >= 0:
            rotating[law] += v[:, freedom]
    rates = (reference.numerator / reference.denominator)[: len(system.scene.meshes)]
    return np.asarray(np.abs(rates @ rotating) / (2.0 * math.pi))


def _coast_force(system: System, force: FloatArray) -> FloatArray:
    """Return the force of the coast flanks, (m, T); (0, T) where no mesh has one."""
    meshes, coast = len(system.scene.meshes), system.flanks.coast
    coasting = np.zeros((meshes if coast else 0, force.shape[1]))
    for element, mesh in enumerate(coast, start=meshes):
        coasting[mesh] = force[system.arrays.elements.first[element]]
    return coasting


def _speed(system: System, laws: FloatArray, v: FloatArray) -> FloatArray:
    """Return the speed of every shaft about +z, (s, T)."""
    speed = system.kinematics.float_ratio @ laws
    for column, freedom in enumerate(system.freedoms.column):
        if freedom < 6 * len(system.rotors) and freedom % 6 == ROTATION:  # six freedoms a rigid shaft
            speed[freedom // 6] += v[:, column]
    return np.asarray(speed)


def _drive_torque(
    system: System,
    time: FloatArray,
    acceleration: FloatArray,
    force: FloatArray,
    q: FloatArray,
    v: FloatArray,
) -> FloatArray:
    """Return the torque that imposes the motion of each drive, (d, T), N m.

    It balances the drive's shaft, or the spring between drive and shaft. `acceleration` (k, T) is the laws'.
    """
    drive = system.arrays.drive
    torque = drive.inertia @ acceleration + drive.direction @ force - drive.constant[:, None]
    freedoms = q.shape[1]
    torque += drive.stiffness[:, :freedoms] @ q.T + drive.damping[:, :freedoms] @ v.T
    for row, load in enumerate(system.scene.loads):
        torque -= system.arrays.load.drive[row][:, None] * load.torque(time)
    return np.ascontiguousarray(torque[: len(system.scene.drives)])
