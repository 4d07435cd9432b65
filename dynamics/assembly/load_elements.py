"""The force elements of loads: applied forces, unbalances, torques that depend on speed.

Axis letters: N columns, the six freedoms of every rotor; p rows of an element.
"""

from __future__ import annotations

import math

import numpy as np

from dynamics.assembly.model import Model
from dynamics.errors import InputError
from dynamics.forces.elements import Element
from dynamics.forces.laws import Law
from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.load_course import BySpeed, Orders
from dynamics.loads.load_laws import ForceCourseLaws
from dynamics.loads.speed_torque_law import SpeedTorqueLaws
from dynamics.loads.unbalance_law import UnbalanceLaws
from dynamics.mechanism.bearing_elements import tilt_lever
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.carried_planets import ROTATION
from dynamics.mechanism.columns import column_count, section_rows, turn_row
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.phases import LoadPhase, angle_phase, frame_phase, repeating_phases, unbalance_phase
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

NO_MESH = -1
"""Index of the mesh of an element that reads no position."""


def applied_force_elements(model: Model) -> tuple[tuple[Element, ...], ForceCourseLaws]:
    """Return one element per applied force, and their laws.

    The rows of an element are its generalized force by force and moment, over their size in N. A moment over
    a lever counts as a force.
    """
    mechanism = model.mechanism
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    lever, vectors = tilt_lever(scene), mechanism.vectors
    phases = repeating_phases(scene, kinematics)
    elements = []
    size: list[float] = []  # of force and moment, N
    row_count: list[int] = []  # rows with a force; a row whose speed the law reads may follow them
    course_phase: list[int] = []  # index of the angle that the course of the force depends on
    frame_turn: list[int] = []  # index of the angle of the frame that the force turns with
    senses: list[int] = []
    for entry, force in enumerate(scene.forces):
        frame = frame_phase(scene, kinematics, force)
        rows = _wrench_rows(scene, rotors, force, in_frame=frame is not None)
        # a force of zero keeps rows of zeros
        size.append(math.hypot(*force.force, *(moment / lever for moment in force.moment)) or 1.0)
        row_count.append(len(rows))
        rows = rows / size[-1]
        sense = 1
        if isinstance(force.course, BySpeed):
            shaft = scene.shaft_index(force.course.shaft)
            sense = _running_sense(kinematics, shaft, f"forces[{entry}].course.shaft", force.course.shaft)
            speed_row = lever * turn_row(rotors, shaft, 0.0)  # the law reads its rate
            rows = np.concatenate([rows, speed_row[None]])
        senses.append(sense)
        course = force.course
        angle = angle_phase(scene, kinematics, force, course) if isinstance(course, Orders) else None
        course_phase.append(_position_index(scene, phases, angle))
        frame_turn.append(_position_index(scene, phases, frame))
        elements.append(
            Element(Law.APPLIED_FORCE, entry, NO_MESH, rows, np.zeros(len(rows)), rows @ vectors.T)
        )
    laws = ForceCourseLaws.packed(
        [force.course for force in scene.forces],
        size=np.array(size, dtype=float),
        lever=np.full(len(size), lever),
        sense=np.array(senses, dtype=float),
        rows=np.array(row_count, dtype=np.int64),
        phase=np.array(course_phase, dtype=np.int64),
        frame=np.array(frame_turn, dtype=np.int64),
        mean=np.array([_steady_part(scene, kinematics, force) for force in scene.forces]).reshape(-1, 2),
    )
    return tuple(elements), laws


def unbalance_elements(model: Model) -> tuple[tuple[Element, ...], UnbalanceLaws]:
    """Return one element per unbalance, and their laws."""
    mechanism = model.mechanism
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    lever, vectors = tilt_lever(scene), mechanism.vectors
    phases = repeating_phases(scene, kinematics)
    elements = []
    phase: list[int] = []
    for entry, part in enumerate(scene.unbalances):
        shaft = scene.shaft_index(part.shaft)
        if rotors[shaft].frame is not None:
            bound = "a shaft described in the fixed frame"
            remedy = "On a member of a planetary set use a force by speed that turns with it."
            raise InputError(f"unbalances[{entry}].shaft", part.shaft, bound, remedy)
        moves = section_rows(rotors, shaft, rotors[shaft].shaft.origin[2] + part.position)
        rows = np.array([moves[0], moves[1], lever * moves[ROTATION]])
        elements.append(Element(Law.UNBALANCE, entry, NO_MESH, rows, np.zeros(3), rows @ vectors.T))
        phase.append(_position_index(scene, phases, unbalance_phase(scene, kinematics, part)))
    laws = UnbalanceLaws(
        amount=np.array([part.amount for part in scene.unbalances], dtype=float),
        angle=np.array([part.angle for part in scene.unbalances], dtype=float),
        lever=np.full(len(phase), lever),
        phase=np.array(phase, dtype=np.int64),
        gravity=np.array(scene.gravity[:2], dtype=float),
        steady=np.zeros(1, dtype=np.bool_),
    )
    return tuple(elements), laws


def _wrench_rows(scene: Scene, rotors: Bodies, force: AppliedForce, in_frame: bool) -> FloatArray:
    """Return the generalized force of a force and moment, (p, N).

    For a force that turns with a frame the rows are: the part across the axis, the same part turned by 90
    degrees, and, if there is one, the part along the axis, which does not turn.
    """
    index = scene.shaft_index(force.shaft)
    moves = section_rows(rotors, index, rotors[index].shaft.origin[2] + force.position)
    wrench = np.array([*force.force, *force.moment])
    if not in_frame:
        return np.asarray((wrench @ moves)[None])
    fx, fy, fz, mx, my, mz = wrench
    rows = [[fx, fy, 0.0, mx, my, 0.0], [-fy, fx, 0.0, -my, mx, 0.0]]
    if fz or mz:
        rows.append([0.0, 0.0, fz, 0.0, 0.0, mz])
    return np.asarray(np.array(rows) @ moves)


def _steady_part(scene: Scene, kinematics: Kinematics, force: AppliedForce) -> tuple[float, float]:
    """Return the means of s cos a and s sin a over time.

    s is the factor of the force by its course and a the angle of the frame that it turns with. The means are
    not zero where an order of s is the rotation of the frame itself: part of such a force is constant in the
    fixed frame.
    """
    frame, course = frame_phase(scene, kinematics, force), force.course
    if frame is None or not isinstance(course, Orders):
        return 0.0, 0.0
    angle = angle_phase(scene, kinematics, force, course)
    mean_cos, mean_sin = 0.0, 0.0
    for order, amplitude, phase in zip(course.multiple, course.amplitude, course.phase, strict=True):
        for sense in (1, -1):
            if all(sense * order * a == b for a, b in zip(angle.rate, frame.rate, strict=True)):
                mean_cos += 0.5 * amplitude * math.cos(phase)
                mean_sin -= 0.5 * amplitude * sense * math.sin(phase)
    return mean_cos, mean_sin


def _running_sense(kinematics: Kinematics, shaft: int, field: str, name: str) -> int:
    """Return the sense in which a shaft turns; refuse a shaft at rest."""
    sense = kinematics.sense[shaft]
    if sense == 0:
        raise InputError(field, name, "a shaft that turns", "Give a held shaft's force by time.")
    return sense


def _position_index(scene: Scene, phases: tuple[LoadPhase, ...], phase: LoadPhase | None) -> int:
    """Return the index of a phase among the positions, of which those of meshes come first; -1: no phase."""
    return -1 if phase is None else len(scene.meshes) + phases.index(phase)


def speed_torque_elements(model: Model) -> tuple[tuple[Element, ...], SpeedTorqueLaws]:
    """Return one element per speed torque, and their laws.

    The coordinate of an element is the rotation in the shaft's sense times a radius. Its rate in the
    kinematic motion is the shaft's speed times that radius.
    """
    mechanism = model.mechanism
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    radius = tilt_lever(scene)
    elements = []
    for entry, part in enumerate(scene.speed_torques):
        shaft = scene.shaft_index(part.shaft)
        sense = kinematics.sense[shaft]
        if sense == 0:
            field = f"speed_torques[{entry}].shaft"
            raise InputError(field, part.shaft, "a shaft that turns", "A held shaft needs no load.")
        gradient = np.zeros((1, column_count(rotors)))
        gradient[0] += sense * radius * turn_row(rotors, shaft, part.position)
        drift = sense * radius * kinematics.float_ratio[shaft][None, :]
        elements.append(Element(Law.SPEED_TORQUE, entry, NO_MESH, gradient, np.zeros(1), drift))
    return tuple(elements), SpeedTorqueLaws.packed(scene.speed_torques, radius)
