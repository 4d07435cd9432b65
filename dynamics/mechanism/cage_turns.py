"""How the cages of bearings turn in the kinematic motion."""

from __future__ import annotations

from fractions import Fraction

from dynamics.bearings import RollingBearing
from dynamics.mechanism.kinematics import Kinematics
from dynamics.scene.scene import Scene

LARGEST_DENOMINATOR = 1_000_000
"""A cage's ratio is irrational: as a fraction it is off by at most a turn in 10^12."""


def cage_turns(
    scene: Scene, kinematics: Kinematics, passing: frozenset[str]
) -> tuple[tuple[Fraction, ...], ...]:
    """Return the revolutions per revolution of each law of the cages of the bearings `passing`, as given.

    In the frame in which the shaft is described. Nothing slips: a cage turns at (1 - gamma)/2 of the inner
    ring's speed and (1 + gamma)/2 of the outer's.
    """
    return tuple(
        _cage_turn(scene, kinematics, bearing)
        for bearing in scene.rolling_bearings
        if bearing.name in passing
    )


def _cage_turn(scene: Scene, kinematics: Kinematics, bearing: RollingBearing) -> tuple[Fraction, ...]:
    inner = Fraction(bearing.row.cage_ratio).limit_denominator(LARGEST_DENOMINATOR)
    shaft = scene.shaft_index(bearing.shaft)
    frame = scene.frame_index(shaft)
    still = (Fraction(0),) * len(kinematics.law_shaft)
    held = still if frame is None else kinematics.ratio[frame]
    # the outer ring is at rest, so in a frame it turns against that
    return tuple(inner * own - around for own, around in zip(kinematics.ratio[shaft], held, strict=True))
