"""A torque on a shaft that depends on its speed, and its compiled law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.checks import finite
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.loads.speed_curve import SpeedCurve
from dynamics.types import FloatArray, IntArray


@dataclass(frozen=True)
class SpeedTorque:
    """A torque by speed: a fan that resists, a motor that drives.

    Attributes
    ----------
    name : str
        Unique among the speed torques.
    shaft : str
        The shaft it acts on.
    curve : SpeedCurve
        Torque against the sense of the shaft's kinematic motion, N m, at the speed in that sense, rad/s.
    position : float
        Where along a flexible shaft it acts, m from its left end.
    """

    name: str
    shaft: str
    curve: SpeedCurve
    position: float = 0.0

    def __post_init__(self) -> None:
        finite("position", self.position)


class SpeedTorqueLaws(NamedTuple):
    """Curves one after the other in flat arrays.

    Attributes
    ----------
    first : (l + 1,) int array
        First piece of each curve.
    start : (S,) array
        Start of the pieces, rad/s.
    coefficient : (S, 4) array
        Ascending, in N m and rad/s.
    radius : (l,) array
        At which torques count as forces and angles as displacements, m.
    """

    first: IntArray
    start: FloatArray
    coefficient: FloatArray
    radius: FloatArray


def pack_speed_torques(parts: Sequence[SpeedTorque], radius: float) -> SpeedTorqueLaws:
    """Lay out the curves of `parts`."""
    starts = [part.curve.start for part in parts]
    return SpeedTorqueLaws(
        np.cumsum([0, *(start.size for start in starts)], dtype=np.int64),
        np.concatenate([np.empty(0), *starts]),
        np.concatenate([np.empty((0, 4)), *(np.asarray(part.curve.coefficient) for part in parts)]),
        np.full(len(parts), radius),
    )


@routine
def speed_torque(laws: SpeedTorqueLaws, entry: int, local: LocalState, row: int) -> None:
    """Write force and derivative at the speed that the rate of `row` and the kinematic motion make."""
    radius = laws.radius[entry]
    speed = (local.rate[row] + local.drift[row]) / radius
    piece = laws.first[entry]
    while piece + 1 < laws.first[entry + 1] and speed >= laws.start[piece + 1]:
        piece += 1
    s, c = speed - laws.start[piece], laws.coefficient
    torque = c[piece, 0] + s * (c[piece, 1] + s * (c[piece, 2] + s * c[piece, 3]))
    slope = c[piece, 1] + s * (2.0 * c[piece, 2] + 3.0 * s * c[piece, 3])
    local.force[row], local.viscous[row, 0] = torque / radius, slope / (radius * radius)
