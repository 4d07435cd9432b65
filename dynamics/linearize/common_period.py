"""The exact common period of meshes and loads at constant speed.

A law is the rotation that a drive imposes. Rates are base pitches of a mesh, or turns of a phase, per
revolution of the leading law, which is the first that turns.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from dynamics.assembly.assemble import System
from dynamics.errors import InputError
from dynamics.linearize.operating_speeds import LARGEST_DENOMINATOR
from dynamics.mechanism.phases import repeating_phases
from dynamics.types import FloatArray

AGREEMENT = 1e-12  # relative error of a proportion of integers that counts as exact


@dataclass(frozen=True)
class CommonPeriod:
    """Base pitches after which all meshes are in phase again, with the laws' speeds in fixed proportion.

    After them, frames that a coupling crosses have turned by whole revolutions, and loads by angle repeat.
    """

    law: int
    """The leading law: the first that turns."""
    proportion: FloatArray
    """Speed of each law over that of `law`. Shape (k,)."""
    revolutions: Fraction
    """Revolutions of the law's shaft in one common period."""
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
    phase_rates = [
        (sum((turn * part for turn, part in zip(phase.rate, proportion, strict=True)), Fraction(0)), phase)
        for phase in repeating_phases(scene, system.kinematics)
    ]
    turns += [phase.turns / abs(rate) for rate, phase in phase_rates if rate]
    if not any(rates):
        turns.append(Fraction(1))  # one turn of the leading shaft, by which orders then count
    # the least common multiple of the fractions in lowest terms
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
