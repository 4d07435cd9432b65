"""The angles that loads read: how fast they turn with the laws, and after how many turns loads repeat."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from dynamics.loads.applied_force import AppliedForce
from dynamics.loads.load_course import Orders
from dynamics.loads.unbalance import Unbalance
from dynamics.mechanism.kinematics import Kinematics
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray


@dataclass(frozen=True)
class LoadPhase:
    """An angle in turns.

    Attributes
    ----------
    rate : tuple of Fraction
        Turns per turn of each law; exact.
    turns : int
        Turns after which what reads it repeats.
    shaft : int or None
        The shaft whose own rotation adds to it.
    position : float
        Where along that shaft, m.
    """

    rate: tuple[Fraction, ...]
    turns: int
    shaft: int | None
    position: float = 0.0


def angle_phase(scene: Scene, kinematics: Kinematics, force: AppliedForce, course: Orders) -> LoadPhase:
    """Return the phase of a course by angle."""
    shaft = scene.shaft_index(course.shaft)
    return LoadPhase(kinematics.ratio[shaft], course.turns, shaft, _position(force, course.shaft))


def frame_phase(scene: Scene, kinematics: Kinematics, force: AppliedForce) -> LoadPhase | None:
    """Return how a force turns against the frame in which its shaft is described; None: it does not."""
    if not any((*force.force[:2], *force.moment[:2])):
        return None  # along the axis alone
    own = scene.frame_index(scene.shaft_index(force.shaft))
    shaft = None if force.turns_with is None else scene.shaft_index(force.turns_with)
    if own is None and shaft is None:
        return None
    none = (Fraction(0),) * len(kinematics.law_shaft)
    turned = none if shaft is None else kinematics.ratio[shaft]
    back = none if own is None else kinematics.ratio[own]
    rate = tuple(a - b for a, b in zip(turned, back, strict=True))
    return LoadPhase(rate, 1, shaft, _position(force, force.turns_with))


def unbalance_phase(scene: Scene, kinematics: Kinematics, part: Unbalance) -> LoadPhase:
    """Return the phase of an unbalance: its shaft's rotation."""
    shaft = scene.shaft_index(part.shaft)
    return LoadPhase(kinematics.ratio[shaft], 1, shaft, part.position)


def _position(force: AppliedForce, shaft: str | None) -> float:
    """Return where the angle of `shaft` counts: where the force acts if it is its own, else the left end."""
    return force.position if shaft == force.shaft else 0.0


def load_phases(scene: Scene, kinematics: Kinematics) -> tuple[LoadPhase, ...]:
    """Return all phases that loads read, each once."""
    phases: list[LoadPhase | None] = []
    for force in scene.forces:
        phases.append(frame_phase(scene, kinematics, force))
        if isinstance(force.course, Orders):
            phases.append(angle_phase(scene, kinematics, force, force.course))
    phases += [unbalance_phase(scene, kinematics, part) for part in scene.unbalances]
    return tuple(dict.fromkeys(phase for phase in phases if phase is not None))


def load_orders(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Return the highest order of every load, (loads, k): turns per turn of each law, of its fastest wave."""
    rows = [_rates(unbalance_phase(scene, kinematics, part)) for part in scene.unbalances]
    for force in scene.forces:
        course, frame = force.course, frame_phase(scene, kinematics, force)
        row = np.zeros(len(kinematics.law_shaft)) if frame is None else _rates(frame)
        if isinstance(course, Orders):
            row = row + max(course.order, default=0.0) * _rates(angle_phase(scene, kinematics, force, course))
        rows.append(row)
    return np.array(rows).reshape(len(rows), len(kinematics.law_shaft))


def _rates(phase: LoadPhase) -> FloatArray:
    """Return turns per turn of each law, without their senses, (k,)."""
    return np.abs([float(rate) for rate in phase.rate])
