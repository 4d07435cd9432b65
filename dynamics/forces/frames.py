"""Forces of rotating frames: gyroscopic moments, Coriolis and centripetal terms, couplings across frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import BoolArray, FloatArray


@dataclass(frozen=True)
class FrameTerm:
    """A term of a rotating-frame element."""

    rows: FloatArray
    """Gradient of the term's coordinates across the axis in all rotors' freedoms; coordinates in m. Shape
    (2, N).
    """
    factors: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    """Factors c_1 to c_5 of `RotatingFrameLaws`."""
    load: tuple[float, float] = (0.0, 0.0)
    """Load l of `RotatingFrameLaws`, kg m."""

    def plus(self, other: FrameTerm) -> FrameTerm:
        """Return the sum of two terms whose rows move alike."""
        a, b, c, d, e = (x + y for x, y in zip(self.factors, other.factors, strict=True))
        load = (self.load[0] + other.load[0], self.load[1] + other.load[1])
        return replace(self, factors=(a, b, c, d, e), load=load)


class RotatingFrameLaws(NamedTuple):
    """l elements in y = (a, b) across the axis of a shaft of spin w in a frame of speed W.

    With J = z x the inertia resists by (c_1 w + c_2 W) J y' + (c_3 w W + c_4 W^2) y, a ground damper seen
    from the frame by c_5 W J y, and a body off the frame's axis is pulled outwards by l W^2.
    """

    factor: FloatArray
    """c_1 to c_5: kg, kg/rad ..., N s/m. Shape (l, 5)."""
    load: FloatArray
    """l: mass times arm from the frame's axis, kg m. Shape (l, 2)."""
    lever: FloatArray
    """Coordinate of the spin's row over its angle, m. Shape (l,)."""
    spinning: BoolArray
    """Whether a third row adds the shaft's own rotation to the spin of the kinematic motion. Shape (l,)."""

    @classmethod
    def packed(cls, terms: Sequence[FrameTerm], lever: float, spinning: Sequence[bool]) -> RotatingFrameLaws:
        """Lay out `terms`; `spinning` says whose shaft adds its own rotation to the spin."""
        return cls(
            np.array([term.factors for term in terms], dtype=float).reshape(-1, 5),
            np.array([term.load for term in terms], dtype=float).reshape(-1, 2),
            np.full(len(terms), lever),
            np.array(spinning, dtype=np.bool_),
        )


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
        along, across = coordinate[row + k], coordinate[row + other]
        elastic[row + k] = hold * along - laws.load[entry, k] * frame * frame
        force[row + k] = sign * (swirl * rate[row + other] + drag * across) + elastic[row + k]
        tangent[row + k, k], tangent[row + k, other] = hold, sign * drag
        viscous[row + k, other] = sign * swirl
        if rows == 2:
            continue
        by_spin = sign * c[entry, 0] * rate[row + other] + c[entry, 2] * frame * along
        viscous[row + k, 2] = by_spin / laws.lever[entry]


@routine
def rotating_frame_energy(laws: RotatingFrameLaws, entry: int, local: LocalState, row: int, e: int) -> float:
    """Return the energy of the terms in y and of the load, J; negative where they push outwards."""
    spin, frame, y = local.speed[e, 0], local.speed[e, 1], local.coordinate
    hold = laws.factor[entry, 2] * spin * frame + laws.factor[entry, 3] * frame**2
    pulled = frame**2 * (laws.load[entry, 0] * y[row] + laws.load[entry, 1] * y[row + 1])
    return float(0.5 * hold * (y[row] ** 2 + y[row + 1] ** 2) - pulled)
