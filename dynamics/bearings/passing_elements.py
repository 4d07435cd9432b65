"""Element passing: how a shaft moves under a constant load as the elements pass it, without inertia."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dynamics.bearings import BallBearing, RollerBearing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.types import FloatArray

ANGLES = 32  # usual number of cage angles over the passing of an element


@dataclass(frozen=True)
class _ElementPassing:
    """The motion of a bearing's inner ring over the passing of one element."""

    order: float
    """Passings per revolution of the inner ring, the outer at rest."""
    angle: FloatArray
    """Angle of the first element from x towards y, rad: one pitch, its end left out. Shape (T,)."""
    displacement: FloatArray
    """Displacement of the inner ring, m and rad. Shape (T, 5)."""

    @property
    def peak_to_peak(self) -> FloatArray:
        """Return the size of the motion in each direction, (5,), m and rad."""
        return np.asarray(np.ptp(self.displacement, axis=0))


def element_passing(
    bearing: BallBearing | RollerBearing, load: ArrayLike, angles: int = ANGLES
) -> _ElementPassing:
    """Return the motion of `bearing` under `load` (5,), N and N m, at evenly spaced angles of the cage.

    Raises `SolveError`: the bearing does not carry the load.
    """
    loaded = LoadedBearing(bearing)
    pitch = 2.0 * math.pi / bearing.count
    angle = np.arange(angles) * pitch / angles
    displacements = [loaded.displacement(load, float(turned)) for turned in angle]
    return _ElementPassing(bearing.count * bearing.cage_ratio, angle, np.array(displacements))
