"""Speeds of all laws by that of the first that turns, and the exact common period of meshes and loads.

A law is a drive, or the free rotation of a train without a drive. The leading law is the first that turns.
"""

from __future__ import annotations

import math

import numpy as np

from bounds import above, at_least
from dynamics.assembly.assemble import System
from dynamics.checks import finite
from dynamics.errors import InputError
from dynamics.mechanism.kinematics import proportional_speeds
from dynamics.types import FloatArray

MAX_SPEEDS = 100_000  # most speeds of a response
LARGEST_DENOMINATOR = 10_000  # largest integer in a proportion of speeds


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
    if speeds.size > MAX_SPEEDS:
        raise InputError(
            "speed", f"{speeds.size} values", f"at most {MAX_SPEEDS} values", "Take wider steps."
        )
    for index, value in enumerate(speeds):
        finite(f"speed[{index}]", float(value))
        if value < 0.0 or (above_zero and value == 0.0):
            remedy = "The scene says in which sense it turns."
            bound = above(0.0) if above_zero else at_least(0.0)
            raise InputError(f"speed[{index}]", float(value), bound, remedy)
        if index and value <= speeds[index - 1]:
            bound = above(float(speeds[index - 1]), name="the one before it,")
            raise InputError(f"speed[{index}]", float(value), bound, "Sort the list and drop repeats.")
    return speeds
