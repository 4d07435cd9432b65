"""Phases: angles of frames, loads and cages, which follow the positions of the meshes in arrays.

A phase is an angle in turns that force elements read like the position of a mesh. It is the angle of one
rotating frame against another at a coupling between them, of a load that turns or repeats, or of the cage of
a rolling bearing. A *law* is a given motion of a train (k of them); rates are turns per turn of each law.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from dynamics.loads.applied_force import AppliedForce, Unbalance
from dynamics.loads.load_course import Orders
from dynamics.mechanism.frame_couplings import frame_couplings
from dynamics.mechanism.kinematics import Kinematics
from dynamics.mechanism.mechanism import Mechanism
from dynamics.scene.scene import Scene
from dynamics.types import FloatArray

LARGEST_DENOMINATOR = 1_000_000
"""Largest denominator of the fraction for the ratio of a cage, which is irrational: the fraction is in error
by at most one turn in 10^12."""


@dataclass(frozen=True)
class LoadPhase:
    """An angle in turns, by which a load repeats or turns."""

    rate: tuple[Fraction, ...]
    """Turns per turn of each law; exact."""
    turns: int
    """Number of turns after which the load repeats."""
    shaft: int | None
    """Shaft whose rotation in the freedoms, besides the laws, adds to the angle; None: no shaft."""
    position: float = 0.0
    """Axial position on that shaft, m."""


def angle_phase(scene: Scene, kinematics: Kinematics, force: AppliedForce, course: Orders) -> LoadPhase:
    """Return the phase of a force whose `course` is a sum of orders of a shaft's angle."""
    shaft = scene.shaft_index(course.shaft)
    return LoadPhase(kinematics.ratio[shaft], course.turns, shaft, _position(force, course.shaft))


def frame_phase(scene: Scene, kinematics: Kinematics, force: AppliedForce) -> LoadPhase | None:
    """Return the angle of a force against the frame of its shaft; None: it does not rotate against it."""
    if not any((*force.force[:2], *force.moment[:2])):
        return None  # along the axis alone
    frame = scene.frame_index(scene.shaft_index(force.shaft))
    shaft = None if force.turns_with is None else scene.shaft_index(force.turns_with)
    if frame is None and shaft is None:
        return None
    pairs = zip(_turns(kinematics, shaft), _turns(kinematics, frame), strict=True)
    rate = tuple(of_force - of_frame for of_force, of_frame in pairs)
    return LoadPhase(rate, 1, shaft, _position(force, force.turns_with))


def _turns(kinematics: Kinematics, shaft: int | None) -> tuple[Fraction, ...]:
    """Return the turns of a shaft per turn of each law; None: the fixed frame."""
    return (Fraction(0),) * len(kinematics.law_shaft) if shaft is None else kinematics.ratio[shaft]


def unbalance_phase(scene: Scene, kinematics: Kinematics, part: Unbalance) -> LoadPhase:
    """Return the phase of an unbalance: its shaft's rotation."""
    shaft = scene.shaft_index(part.shaft)
    return LoadPhase(kinematics.ratio[shaft], 1, shaft, part.position)


def _position(force: AppliedForce, shaft: str | None) -> float:
    """Return the position on `shaft` at which its angle counts, m.

    It is that of the force on its own shaft, and the left end of any other shaft.
    """
    return force.position if shaft == force.shaft else 0.0


def load_orders(scene: Scene, kinematics: Kinematics) -> FloatArray:
    """Return the highest order of every load, (loads, k): its fastest wave in turns per turn of each law."""
    rows = [_rates(unbalance_phase(scene, kinematics, part)) for part in scene.unbalances]
    for force in scene.forces:
        course, frame = force.course, frame_phase(scene, kinematics, force)
        row = np.zeros(len(kinematics.law_shaft)) if frame is None else _rates(frame)
        if isinstance(course, Orders):
            row = row + max(course.order, default=0.0) * _rates(angle_phase(scene, kinematics, force, course))
        rows.append(row)
    return np.array(rows).reshape(len(rows), len(kinematics.law_shaft))


def _rates(phase: LoadPhase) -> FloatArray:
    """Return turns per turn of each law, without sign, (k,)."""
    return np.abs([float(rate) for rate in phase.rate])


def frame_turns(scene: Scene, kinematics: Kinematics) -> tuple[tuple[Fraction, ...], ...]:
    """Return, for each frame coupling, the turns of its second frame against the first per turn of a law."""
    turns = []
    for part in frame_couplings(scene):
        frames = (scene.frame_index(end) for end in (part.first, part.second))
        first, second = (_turns(kinematics, frame) for frame in frames)
        turns.append(tuple(b - a for a, b in zip(first, second, strict=True)))
    return tuple(turns)


def cage_turns(
    scene: Scene, kinematics: Kinematics, passing: frozenset[str]
) -> tuple[tuple[Fraction, ...], ...]:
    """Return the turns of cages per turn of each law, for the bearings whose rolling elements pass.

    `passing` are their names; the order is that of the scene. The turns are in the frame in which the shaft
    is described. Nothing slips: a cage turns at (1 - gamma)/2 of the inner ring's speed and (1 + gamma)/2 of
    the outer ring's.
    """
    cages = []
    for bearing in scene.rolling_bearings:
        if bearing.name in passing:
            inner = Fraction(bearing.row.cage_ratio).limit_denominator(LARGEST_DENOMINATOR)
            shaft = scene.shaft_index(bearing.shaft)
            # the outer ring is fixed to the ground, so that it turns backwards in a rotating frame
            pin_turn = _turns(kinematics, scene.frame_index(shaft))
            pairs = zip(kinematics.ratio[shaft], pin_turn, strict=True)
            cages.append(tuple(inner * turn - around for turn, around in pairs))
    return tuple(cages)


def repeating_phases(scene: Scene, kinematics: Kinematics) -> tuple[LoadPhase, ...]:
    """Return the phases of frames, then the different ones of loads: those with exact ratios."""
    frames = tuple(LoadPhase(rate, 1, None) for rate in frame_turns(scene, kinematics))
    read: list[LoadPhase | None] = []
    for force in scene.forces:
        read.append(frame_phase(scene, kinematics, force))
        if isinstance(force.course, Orders):
            read.append(angle_phase(scene, kinematics, force, force.course))
    read += [unbalance_phase(scene, kinematics, part) for part in scene.unbalances]
    return (*frames, *dict.fromkeys(phase for phase in read if phase is not None))


def phases(mechanism: Mechanism) -> tuple[LoadPhase, ...]:
    """Return all phases in their order: those of exact ratio, then cages whose rolling elements pass."""
    scene, kinematics = mechanism.scene, mechanism.kinematics
    cages = cage_turns(scene, kinematics, mechanism.passing)
    return (*repeating_phases(scene, kinematics), *(LoadPhase(rate, 1, None) for rate in cages))
