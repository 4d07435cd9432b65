"""A rolling bearing's force from its displacement, its displacement from a load, and what follows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dynamics.bearings import BallBearing, RollerBearing
from dynamics.bearings.ball_elements import (
    BallElements,
    RowPlacement,
    axial_seat,
    ball_reaction,
    balls,
    balls_energy,
)
from dynamics.bearings.roller_elements import RollerElements, roller_reaction, rollers, rollers_energy
from dynamics.bearings.rolling_bearing import BOTH, check_locating
from dynamics.bearings.seat import SEAT
from dynamics.errors import SolveError
from dynamics.kernels.by_address import by_address
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import Routine
from dynamics.types import FloatArray

TOLERANCE = 1e-12  # unbalanced force over the load, at which the search ends
STEPS = 500  # most Newton steps to the displacement under a load
FIRST_DAMPING = 1e9  # damping of the first step, N/m
MIN_DAMPING = 1.0  # least damping, N/m; without damping the tangent of unloaded elements is singular


@dataclass(frozen=True)
class Reaction:
    """The force of a bearing under a displacement, and its derivatives.

    The bearing has Z elements of L laminae each; a ball is one lamina.
    """

    force: FloatArray
    """Force and moment of the inner ring on the outer, N and N m. Shape (5,)."""
    tangent: FloatArray
    """Derivative of the force in the displacement, symmetric. Shape (5, 5)."""
    viscous: FloatArray
    """Derivative of the force in the rate of displacement, if the damping of an element is its load times 1
    s/m. Shape (5, 5).
    """
    energy: float
    """Energy in the contacts, J."""
    slope: float
    """Derivative of the energy in the angle of the cage, J/rad."""
    load: FloatArray
    """Normal loads of the elements, N; each copy of an element has the load of a whole element. Shape (Z
    copies, L).
    """


class LoadedBearing:
    """A bearing in the arrays that compiled laws read.

    Raises `InputError`: a ring of a row with a contact angle slides.

    Parameters
    ----------
    copies : int
        Number of evenly spaced copies that share the stiffness of an element. With 1 the force varies as the
        cage turns (element passing). With more it is nearly the average over the passing of an element.
    locating : str
        Directions along z in which the rings are held in their seats: both, positive, negative, none. A ring
        that is not held slides to where it carries no axial force.
    """

    def __init__(self, bearing: BallBearing | RollerBearing, copies: int = 1, locating: str = BOTH) -> None:
        check_locating(bearing, locating)
        self.bearing, self.copies = bearing, copies
        self._local = by_address(LocalState.empty(SEAT, SEAT))
        self._load = np.zeros((bearing.count * copies, bearing.laminae))
        placement = RowPlacement(copies, damping=1.0, locating=locating)
        if isinstance(bearing, BallBearing):
            self._laws: Any = by_address(BallElements.packed([(bearing, placement)]))
            self._react: Any = ball_reaction
            routines: tuple[Routine, ...] = (axial_seat, balls, balls_energy)
        else:
            self._laws = by_address(RollerElements.packed([(bearing, placement)]))
            self._react = roller_reaction
            routines = rollers, rollers_energy
        for routine in routines:
            routine.prepare(self._laws, self._local)

    def evaluate(self, displacement: ArrayLike, angle: float = 0.0) -> Reaction:
        """Return the reaction to `displacement` (5,) of the inner ring against the outer.

        Parameters
        ----------
        displacement : (5,) array_like
            x, y, z (m), tilt_x, tilt_y (rad) about the bearing's center.
        angle : float
            Angle of the first element from x towards y, rad.
        """
        local = self._local
        local.coordinate[:], local.position[0] = displacement, angle / (2.0 * math.pi)
        energy, slope = self._react(self._laws, local, self._load)
        matrices = local.tangent.copy(), local.viscous.copy()
        load = self.copies * self._load
        return Reaction(local.force.copy(), *matrices, energy, slope / (2.0 * math.pi), load)

    def displacement(
        self,
        load: ArrayLike,
        angle: float = 0.0,
        start: ArrayLike = (0.0, 0.0, 0.0, 0.0, 0.0),
        fixed: Sequence[int] = (),
    ) -> FloatArray:
        """Return the displacement (5,) at which the bearing carries `load` (5,), N and N m.

        Damped Newton steps lower the potential: the energy in the contacts less the work of the load. In
        directions in which the bearing does not resist, the displacement stays at `start`. So do the
        coordinates that are `fixed`, such as the tilts (3, 4) of a shaft that does not tilt; the load on them
        does not count. Raises `SolveError`: no displacement carries the load.
        """
        target, d = np.asarray(load, dtype=float), np.array(start, dtype=float)
        free = np.setdiff1d(np.arange(SEAT), fixed)
        lever = self.bearing.pitch_diameter / 2.0
        scale = np.array([1.0, 1.0, 1.0, lever, lever])  # moments count as forces at the pitch circle
        allowed = TOLERANCE * float(np.linalg.norm((target / scale)[free]))
        damping, reaction = FIRST_DAMPING, self.evaluate(d, angle)
        for _ in range(STEPS):
            residual = (target - reaction.force)[free]
            size = float(np.linalg.norm(residual / scale[free]))
            if size <= allowed:
                return d
            damped = reaction.tangent + damping * np.diag(scale**2)
            step = np.zeros(SEAT)
            step[free] = np.linalg.solve(damped[np.ix_(free, free)], residual)
            trial = self.evaluate(d + step, angle)
            potential_drop = float(target @ step) - (trial.energy - reaction.energy)
            is_closer = np.linalg.norm(((target - trial.force) / scale)[free]) < size
            if potential_drop > 0.0 or is_closer:
                d, reaction, damping = d + step, trial, max(damping / 10.0, MIN_DAMPING)
            else:
                damping *= 4.0
        raise SolveError(f"the bearing does not carry the load: {size:.3g} N are left after {STEPS} steps")
