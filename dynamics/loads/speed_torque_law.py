"""The compiled law of torques that depend on speed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.kernels.cubics import Cubics, value_and_slope
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.loads.applied_force import SpeedTorque
from dynamics.types import FloatArray


class SpeedTorqueLaws(NamedTuple):
    """Torque-speed curves of l shafts."""

    torque: Cubics
    """Torque over speed, N m over rad/s."""
    radius: FloatArray
    """Radius by which torques become forces and angles become displacements, m. Shape (l,)."""

    @classmethod
    def packed(cls, parts: Sequence[SpeedTorque], radius: float) -> SpeedTorqueLaws:
        """Lay out the curves of `parts`."""
        curves = [(part.curve.start, np.asarray(part.curve.coefficient)) for part in parts]
        return cls(Cubics.packed(curves), np.full(len(parts), radius))


@routine
def speed_torque(laws: SpeedTorqueLaws, entry: int, local: LocalState, row: int) -> None:
    """Write force and derivative at the speed that the rate of `row` and the kinematic motion make."""
    radius = laws.radius[entry]
    speed = (local.rate[row] + local.drift[row]) / radius
    torque, slope = value_and_slope(laws.torque, entry, speed)
    local.force[row], local.viscous[row, 0] = torque / radius, slope / (radius * radius)
