"""Speeds of all laws by that of the first that turns, and the exact common period of meshes and loads."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bounds import above, at_least
from dynamics.assembly.assemble import System
from dynamics.checks import finite
from dynamics.errors import InputError
from dynamics.mechanism.kinematics import proportional_speeds
from dynamics.mechanism.phases import repeating_phases
from dynamics.types import FloatArray

# Speeds of all laws in proportion to that of the first that turns.


MOST_SPEEDS = 100_000
LARGEST_DENOMINATOR = 10_000
AGREEMENT = 1e-12


def leading_law(system: System) -> int:
    """Return the first drive or free rotation that turns.

    Raises
    ------
    InputError
        If all are at rest.
    """
    extreme = [part.speed.extreme for part in system.scene.references]
    leading = next((index for index, speed in enumerate(extreme) if speed != 0.0), None)
    if leading is None:
        raise InputError("drives", 0.0, "rotating, at least one of them", "Give one a speed other than 0.")
    return leading


def law_speeds(system: System, speed: float) -> FloatArray:
    """Return the speeds (k,) of all laws in rad/s where the leading one has `speed`.

    They keep the proportion of their extreme speeds in the scene, and their senses: `speed` is a magnitude.
    """
    extreme = proportional_speeds(system.scene)
    return np.asarray(extreme * (speed / abs(extreme[leading_law(system)])))


def mesh_frequencies(system: System, speed: FloatArray) -> FloatArray:
    """Return the mesh frequency of every mesh in Hz at speeds (S,) of the leading law in rad/s, (m, S)."""
    per_unit = np.abs(system.kinematics.float_mesh_rate @ law_speeds(system, 1.0)) / (2.0 * math.pi)
    return np.asarray(per_unit[:, None] * np.abs(speed))


def checked_speeds(speed: FloatArray | list[float] | tuple[float, ...], *, above_zero: bool) -> FloatArray:
    """Return speeds (S,) in rad/s that increase.

    Raises
    ------
    InputError
        If one is not finite, below 0 (or 0), not above the one before, or there are too many.
    """
    speeds = np.atleast_1d(np.asarray(speed, dtype=float))
    if speeds.size > MOST_SPEEDS:
        raise InputError(
            "speed", f"{speeds.size} values", f"at most {MOST_SPEEDS} values", "Take wider steps."
        )
    for index, value in enumerate(speeds):
        finite(f"speed[{index}]", float(value))
        if value < 0.0 or (above_zero and value == 0.0):
            advice = "The scene says in which sense it turns."
            bound = above(0.0) if above_zero else at_least(0.0)
            raise InputError(f"speed[{index}]", float(value), bound, advice)
        if index and value <= speeds[index - 1]:
            bound = above(float(speeds[index - 1]), name="the one before it,")
            raise InputError(f"speed[{index}]", float(value), bound, "Sort the list and drop repeats.")
    return speeds


@dataclass(frozen=True)
class CommonPeriod:
    """After how many base pitches all meshes are in phase again, with the laws' speeds in fixed proportion.

    Frames that a coupling crosses have turned by whole revolutions then, too, and loads by angle repeat.
    """

    law: int
    """The leading law: the first that turns."""
    proportion: FloatArray
    """Speed of each law over that of `law`. Shape (k,)."""
    revolutions: Fraction
    """Of the law's shaft in one common period."""
    pitches: tuple[int, ...]
    """Base pitches of each mesh in one common period, > 0 in its driver's sense; 0: at rest."""

    @property
    def counted(self) -> int:
        """Base pitches of the first mesh that turns in one common period, by which orders are counted.

        Without a mesh: revolutions of the leading shaft.
        """
        pitches = next((abs(pitches) for pitches in self.pitches if pitches), None)
        return int(self.revolutions) if pitches is None else pitches

    def duration(self, speed: float) -> float:
        """Return the common period in s at the law's speed in rad/s."""
        return 2.0 * math.pi * float(self.revolutions) / abs(speed)


def common_period(system: System) -> CommonPeriod:
    """Return the common period of the meshes of `system`, from the extreme speeds of its drives.

    Raises
    ------
    InputError
        If torques alone move a train, or the speeds of two drives are in no proportion of small integers.
    """
    scene = system.scene
    if scene.free_rotations:
        suggestion = "Impose the rotation of one shaft; a drive with a stiffness still lets it vibrate."
        raise InputError(
            "free_rotations", len(scene.free_rotations), "none: a drive sets the period", suggestion
        )
    extreme = [drive.speed.extreme for drive in scene.drives]
    law = next(index for index, speed in enumerate(extreme) if speed != 0.0)
    proportion = [_proportion(f"drives[{k}].speed", speed / extreme[law]) for k, speed in enumerate(extreme)]
    forward = 1 if extreme[law] > 0.0 else -1
    rates = [
        forward * sum((rate * part for rate, part in zip(row, proportion, strict=True)), Fraction(0))
        for row in system.kinematics.mesh_rate
    ]
    turns = [
        Fraction(mesh.table.period) / abs(rate)
        for mesh, rate in zip(scene.meshes, rates, strict=True)
        if rate
    ]
    turning = [
        (sum((turn * part for turn, part in zip(phase.rate, proportion, strict=True)), Fraction(0)), phase)
        for phase in repeating_phases(scene, system.kinematics)
    ]
    turns += [phase.turns / abs(rate) for rate, phase in turning if rate]
    if not any(rates):
        turns.append(Fraction(1))  # of the leading shaft, by which orders then count
    revolutions = Fraction(
        math.lcm(*(turn.numerator for turn in turns)), math.gcd(*(turn.denominator for turn in turns))
    )
    return CommonPeriod(
        law,
        np.array([float(part) for part in proportion]),
        revolutions,
        tuple(int(revolutions * rate) for rate in rates),
    )


def _proportion(field: str, value: float) -> Fraction:
    fraction = Fraction(value).limit_denominator(LARGEST_DENOMINATOR)
    if abs(float(fraction) - value) > AGREEMENT * abs(value):
        bound = (
            f"in a proportion of integers up to {LARGEST_DENOMINATOR} to that of the first drive that turns"
        )
        raise InputError(field, value, bound, "Without one the meshes have no common period.")
    return fraction
