"""Rotating-frame forces: gyroscopic moments, Coriolis and centripetal terms, loads; their compiled law."""

from __future__ import annotations

from typing import NamedTuple

from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import BoolArray, FloatArray


class RotatingFrameLaws(NamedTuple):
    """l elements in y = (a, b) across the axis of a shaft of spin w in a frame of speed W.

    With J = z x the inertia resists by (c_1 w + c_2 W) J y' + (c_3 w W + c_4 W^2) y, a ground damper seen
    from the frame by c_5 W J y, and a body off the frame's axis is pulled outwards by l W^2.

    Attributes
    ----------
    factor : (l, 5) array
        c_1 to c_5: kg, kg/rad ..., N s/m.
    load : (l, 2) array
        l: mass times arm from the frame's axis, kg m.
    lever : (l,) array
        Of the row of the spin, m: row over angle.
    spinning : (l,) bool array
        Whether a third row adds the shaft's own rotation to the spin of the kinematic motion.
    """

    factor: FloatArray
    load: FloatArray
    lever: FloatArray
    spinning: BoolArray


@routine
def rotating_frame(laws: RotatingFrameLaws, entry: int, local: LocalState, row: int, e: int) -> None:
    """Write forces and derivatives into the rows of element `e`, the first of which is `row`.

    The row of the spin carries no force: what stays 0 is 0 from the start.
    """
    coordinate, rate, force, elastic = local.coordinate, local.rate, local.force, local.elastic
    tangent, viscous = local.tangent, local.viscous
    spin, frame = local.speed[e, 0], local.speed[e, 1]
    rows = 2
    if laws.spinning[entry]:
        rows = 3
        spin += rate[row + 2] / laws.lever[entry]
    c = laws.factor
    swirl = c[entry, 0] * spin + c[entry, 1] * frame
    hold = c[entry, 2] * spin * frame + c[entry, 3] * frame * frame
    drag = c[entry, 4] * frame
    for k in range(2):
        other, sign = 1 - k, 2.0 * k - 1.0  # J y = (-y_2, y_1)
        here, there = coordinate[row + k], coordinate[row + other]
        elastic[row + k] = hold * here - laws.load[entry, k] * frame * frame
        force[row + k] = sign * (swirl * rate[row + other] + drag * there) + elastic[row + k]
        tangent[row + k, k], tangent[row + k, other] = hold, sign * drag
        viscous[row + k, other] = sign * swirl
        if rows == 2:
            continue
        by_spin = sign * c[entry, 0] * rate[row + other] + c[entry, 2] * frame * here
        viscous[row + k, 2] = by_spin / laws.lever[entry]


@routine
def rotating_frame_energy(laws: RotatingFrameLaws, entry: int, local: LocalState, row: int, e: int) -> float:
    """Return the energy of the terms in y and of the load, J; negative where they push outwards."""
    spin, frame, y = local.speed[e, 0], local.speed[e, 1], local.coordinate
    hold = laws.factor[entry, 2] * spin * frame + laws.factor[entry, 3] * frame**2
    pulled = frame**2 * (laws.load[entry, 0] * y[row] + laws.load[entry, 1] * y[row + 1])
    return float(0.5 * hold * (y[row] ** 2 + y[row + 1] ** 2) - pulled)
