"""The force elements of applied forces and of unbalances."""

from __future__ import annotations

import math

import numpy as np

from dynamics.arrays.elements import Element
from dynamics.assembly.phases import repeating_phases
from dynamics.effects.force_terms import frame_lever
from dynamics.errors import InputError
from dynamics.kernels.law import Law
from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.force_course import ForceCourseLaws, pack_courses
from dynamics.loads.load_course import BySpeed, Orders
from dynamics.loads.unbalance_force import UnbalanceLaws
from dynamics.mechanism.bodies import Bodies
from dynamics.mechanism.columns import section_rows, turn_row
from dynamics.mechanism.freedoms import ROTATION
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.load_phases import LoadPhase, angle_phase, frame_phase, unbalance_phase
from dynamics.mechanism.mechanism import Mechanism
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


def force_course_elements(mechanism: Mechanism) -> tuple[tuple[Element, ...], ForceCourseLaws]:
    """Return one element per applied force, and their laws.

    The rows are those of the force and moment as one generalized force per newton, the moment by a lever.
    """
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    lever, known, vectors = frame_lever(scene), repeating_phases(scene, kinematics), mechanism.vectors
    elements, size, carrying, read, turned, senses = [], [], [], [], [], []
    for entry, force in enumerate(scene.forces):
        frame = frame_phase(scene, kinematics, force)
        rows = _wrench_rows(scene, rotors, force, frame is not None)
        size.append(math.hypot(*force.force, *(moment / lever for moment in force.moment)) or 1.0)
        carrying.append(len(rows))
        rows = rows / size[-1]
        sense = 1
        if isinstance(force.course, BySpeed):
            shaft = scene.shaft_index(force.course.shaft)
            sense = _sense(kinematics, shaft, f"forces[{entry}].course.shaft", force.course.shaft)
            rows = np.concatenate([rows, lever * turn_row(rotors, shaft, 0.0)[None]])
        senses.append(sense)
        course = force.course
        angle = angle_phase(scene, kinematics, force, course) if isinstance(course, Orders) else None
        read.append(_index(scene, known, angle))
        turned.append(_index(scene, known, frame))
        elements.append(Element(Law.APPLIED_FORCE, entry, -1, rows, np.zeros(len(rows)), rows @ vectors.T))
    laws = ForceCourseLaws(
        **pack_courses([force.course for force in scene.forces]),
        size=np.array(size, dtype=float),
        lever=np.full(len(size), lever),
        sense=np.array(senses, dtype=float),
        rows=np.array(carrying, dtype=np.int64),
        phase=np.array(read, dtype=np.int64),
        frame=np.array(turned, dtype=np.int64),
        mean=np.array([_mean(scene, kinematics, force) for force in scene.forces]).reshape(-1, 2),
        steady=np.zeros(1, dtype=np.bool_),
    )
    return tuple(elements), laws


def unbalance_elements(mechanism: Mechanism) -> tuple[tuple[Element, ...], UnbalanceLaws]:
    """Return one element per unbalance, and their laws.

    Raises
    ------
    InputError
        If the shaft of one is described in the frame of a carrier.
    """
    scene, rotors, kinematics = mechanism.scene, mechanism.rotors, mechanism.kinematics
    lever, known, vectors = frame_lever(scene), repeating_phases(scene, kinematics), mechanism.vectors
    elements, read = [], []
    for entry, part in enumerate(scene.unbalances):
        shaft = scene.shaft_index(part.shaft)
        if rotors[shaft].frame is not None:
            bound = "a shaft described in the fixed frame"
            advice = "On a member of a planetary set use a force by speed that turns with it."
            raise InputError(f"unbalances[{entry}].shaft", part.shaft, bound, advice)
        moves = section_rows(rotors, shaft, rotors[shaft].shaft.origin[2] + part.position)
        rows = np.array([moves[0], moves[1], lever * moves[ROTATION]])
        elements.append(Element(Law.UNBALANCE, entry, -1, rows, np.zeros(3), rows @ vectors.T))
        read.append(_index(scene, known, unbalance_phase(scene, kinematics, part)))
    laws = UnbalanceLaws(
        np.array([part.amount for part in scene.unbalances], dtype=float),
        np.array([part.angle for part in scene.unbalances], dtype=float),
        np.full(len(read), lever),
        np.array(read, dtype=np.int64),
        np.array(scene.gravity[:2], dtype=float),
        np.zeros(1, dtype=np.bool_),
    )
    return tuple(elements), laws


def _wrench_rows(scene: Scene, rotors: Bodies, force: AppliedForce, turning: bool) -> FloatArray:
    """Return the generalized force of the whole, or where it turns of its part across and along, (p, N)."""
    index = scene.shaft_index(force.shaft)
    moves = section_rows(rotors, index, rotors[index].shaft.origin[2] + force.position)
    wrench = np.array([*force.force, *force.moment])
    if not turning:
        return np.asarray((wrench @ moves)[None])
    fx, fy, fz, mx, my, mz = wrench
    rows = [[fx, fy, 0.0, mx, my, 0.0], [-fy, fx, 0.0, -my, mx, 0.0]]
    if fz or mz:
        rows.append([0.0, 0.0, fz, 0.0, 0.0, mz])
    return np.asarray(np.array(rows) @ moves)


def _mean(scene: Scene, kinematics: Kinematics, force: AppliedForce) -> tuple[float, float]:
    """Return the means of s cos a and s sin a for a factor s by the angle and the frame's angle a.

    A first order of the very angle that the frame turns by stands still in part.
    """
    frame, course = frame_phase(scene, kinematics, force), force.course
    if frame is None or not isinstance(course, Orders):
        return 0.0, 0.0
    angle = angle_phase(scene, kinematics, force, course)
    along, across = 0.0, 0.0
    for order, amplitude, phase in zip(course.multiple, course.amplitude, course.phase, strict=True):
        for sense in (1, -1):
            if all(sense * order * a == b for a, b in zip(angle.rate, frame.rate, strict=True)):
                along += 0.5 * amplitude * math.cos(phase)
                across -= 0.5 * amplitude * sense * math.sin(phase)
    return along, across


def _sense(kinematics: Kinematics, shaft: int, field: str, name: str) -> int:
    sense = kinematics.sense[shaft]
    if sense == 0:
        raise InputError(field, name, "a shaft that turns", "Give a held shaft's force by time.")
    return sense


def _index(scene: Scene, known: tuple[LoadPhase, ...], phase: LoadPhase | None) -> int:
    """Return where a phase is among the positions; -1: there is none."""
    return -1 if phase is None else len(scene.meshes) + known.index(phase)
