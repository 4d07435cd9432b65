"""A rolling bearing's force from its displacement, and its displacement from a load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from dynamics.errors import SolveError
from dynamics.forces.ball_elements import ball_elements
from dynamics.forces.bearing_seat import make_seat
from dynamics.forces.by_address import by_address
from dynamics.forces.roller_elements import roller_elements
from dynamics.rolling_bearings.ball_bearing import BallBearing
from dynamics.rolling_bearings.roller_bearing import RollerBearing
from dynamics.types import FloatArray

TOLERANCE = 1e-12  # of the load
STEPS = 500


@dataclass(frozen=True)
class Reaction:
    """The answer of a bearing of Z elements in L laminae each (balls: 1) to a displacement.

    Attributes
    ----------
    force : (5,) array
        Of the inner ring on the outer, N, N m.
    tangent : (5, 5) array
        Its derivative in the displacement, symmetric.
    energy : float
        Stored in the contacts, J.
    slope : float
        Derivative of the energy in the angle of the cage, J/rad.
    load : (Z, L) array
        Normal loads of the elements, N; with copies (Z copies, L): that of a whole element in each place.
    """

    force: FloatArray
    tangent: FloatArray
    energy: float
    slope: float
    load: FloatArray


class LoadedBearing:
    """A bearing laid out for compiled evaluation.

    Parameters
    ----------
    bearing : BallBearing or RollerBearing
    copies : int
        Each element as so many that share its stiffness, evenly spaced. 1: the elements as they are, whose
        force varies as the cage turns (element passing). More: its average over the passing of an element.
    """

    def __init__(self, bearing: BallBearing | RollerBearing, copies: int = 1) -> None:
        self.bearing, self.copies = bearing, copies
        self._seat = make_seat(bearing.count * copies, bearing.laminae)
        self._at = by_address(self._seat)
        self._elements = by_address(bearing.elements(copies))
        balls = isinstance(bearing, BallBearing)
        self._law: Callable[..., tuple[float, float]] = ball_elements if balls else roller_elements

    def evaluate(self, displacement: ArrayLike, angle: float = 0.0) -> Reaction:
        """Return the answer to `displacement` (5,) of the inner ring against the outer.

        Parameters
        ----------
        displacement : (5,) array_like
            x, y, z (m), tilt_x, tilt_y (rad) about the bearing's center.
        angle : float
            Of the first element from x towards y, rad.
        """
        seat = self._seat
        seat.displacement[:] = displacement
        energy, slope = self._law(self._elements, 0, angle, self._at)
        return Reaction(seat.force.copy(), seat.tangent.copy(), energy, slope, self.copies * seat.load)

    def displacement(
        self, load: ArrayLike, angle: float = 0.0, start: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0)
    ) -> FloatArray:
        """Return the displacement (5,) at which the bearing carries `load` (5,), N and N m.

        Damped Newton steps reduce energy less work of the load. Where the bearing does not resist, it stays
        at `start`.

        Raises
        ------
        SolveError
            If no displacement carries the load.
        """
        wanted, d = np.asarray(load, dtype=float), np.array(start, dtype=float)
        lever = self.bearing.pitch_diameter / 2.0
        scale = np.array([1.0, 1.0, 1.0, lever, lever])
        floor = TOLERANCE * float(np.linalg.norm(wanted / scale))
        damping, now = 1e9, self.evaluate(d, angle)  # N/m
        for _ in range(STEPS):
            missing = wanted - now.force
            if float(np.linalg.norm(missing / scale)) <= floor:
                return d
            step = np.linalg.solve(now.tangent + damping * np.diag(scale**2), missing)
            then = self.evaluate(d + step, angle)
            gained = float(wanted @ step) - (then.energy - now.energy)
            closer = np.linalg.norm((wanted - then.force) / scale) < np.linalg.norm(missing / scale)
            if gained > 0.0 or closer:
                d, now, damping = d + step, then, damping / 10.0
            else:
                damping *= 4.0
        left = float(np.linalg.norm((wanted - now.force) / scale))
        raise SolveError(f"the bearing does not carry the load: {left:.3g} N are left after {STEPS} steps")
