"""A bearing by geometry as the linear bushing that it is for small motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from dynamics.bearings import Bushing
from dynamics.bearings.loaded_bearing import LoadedBearing
from dynamics.bearings.matrix import matrix_rows


def tangent_bushing(
    bearing: LoadedBearing, seat: tuple[str, str, float], displacement: ArrayLike, angle: float = 0.0
) -> Bushing:
    """Return the bushing with force and tangent of `bearing` at a displacement.

    Exact there and to first order about it. Where loads follow from statics alone, take
    `LoadedBearing.displacement` of the load; otherwise the displacement at which a scene rests on these
    bushings is the next, better one (Newton's method).

    Parameters
    ----------
    bearing : LoadedBearing
        Bearing whose outer ring the ground holds and whose center is on the shaft's axis.
    seat : (str, str, float)
        Name of the bushing, its shaft, position along it (m).
    displacement : (5,) array_like
        Displacement of the shaft at the bushing: x, y, z (m), tilt_x, tilt_y (rad).
    angle : float
        Angle of the first element from x towards y, rad.
    """
    name, shaft, position = seat
    at = bearing.evaluate(displacement, angle)
    preload = at.tangent @ np.asarray(displacement, dtype=float) - at.force
    stiffness = matrix_rows(0.5 * (at.tangent + at.tangent.T))
    return Bushing(name, shaft, position, stiffness=stiffness, preload=tuple(map(float, preload)))
