"""Compiled kinematic motion, flank positions and external forces at a time."""

from __future__ import annotations

import math

from dynamics.forces.compiled import compiled, inner
from dynamics.forces.table_lookup import wrapped
from dynamics.system.arrays import LawArrays, Reference, SystemArrays
from dynamics.types import FloatArray


@inner
def piece_at(law: LawArrays, index: int, time: float) -> int:
    """Return the piece of law `index` that holds `time`."""
    piece = law.first[index]
    while piece + 1 < law.first[index + 1] and time >= law.start[piece + 1]:
        piece += 1
    return int(piece)


@compiled
def law_value(law: LawArrays, index: int, time: float) -> float:
    """Return the value of law `index`."""
    piece = piece_at(law, index, time)
    s, c = time - law.start[piece], law.coefficient
    return float(c[piece, 0] + s * (c[piece, 1] + s * (c[piece, 2] + s * c[piece, 3])))


@compiled
def drive_motion(reference: Reference, time: float) -> tuple[float, float, float, float]:
    """Return the drive's whole revolutions, fraction of one (0..1), speed (rad/s), acceleration (rad/s^2)."""
    piece = piece_at(reference.speed, 0, time)
    s, c = time - reference.speed.start[piece], reference.speed.coefficient
    angle = s * (c[piece, 0] + s * (c[piece, 1] / 2.0 + s * (c[piece, 2] / 3.0 + s * c[piece, 3] / 4.0)))
    turns = reference.fraction[piece] + angle / (2.0 * math.pi)
    whole = math.floor(turns)
    speed = c[piece, 0] + s * (c[piece, 1] + s * (c[piece, 2] + s * c[piece, 3]))
    acceleration = c[piece, 1] + s * (2.0 * c[piece, 2] + 3.0 * s * c[piece, 3])
    return reference.whole[piece] + whole, turns - whole, speed, acceleration


@compiled
def flank_phase(reference: Reference, flank: int, whole: float, fraction: float) -> float:
    """Return the flank's position in the kinematic motion, in [0, period): whole periods drop exactly.

    Base pitches per revolution are a fraction of integers, so that what whole revolutions add is an integer
    number of periods and a remainder of integers: no digit is lost however far the shafts have turned.
    """
    numerator, denominator = reference.numerator[flank], reference.denominator[flank]
    cycle = denominator * reference.period[flank]
    remainder = (int(whole) % cycle) * numerator % cycle
    phase = remainder / denominator + fraction * numerator / denominator + reference.offset[flank]
    return wrapped(phase, float(reference.period[flank]))


@inner
def external_force(system: SystemArrays, time: float, acceleration: float, force: FloatArray) -> None:
    """Write loads and the inertial force of the kinematic motion into `force` (n,)."""
    for i in range(force.size):
        force[i] = system.inertial[i] * acceleration
    for load in range(system.load.reference.size):
        torque = law_value(system.load.torque, load, time)
        for i in range(force.size):
            force[i] += system.load.direction[load, i] * torque
