"""A row of rolling elements as the law of a bearing in a scene.

The typical load is the load across the axis that the scene expects of the bearing, `BearingDuty.load`. The
rows of a law are its coordinates, in m: x, y, z and both tilts times a lever.
"""

from __future__ import annotations

import math
from functools import cached_property, lru_cache

import numpy as np

from dynamics.bearings import BallBearing, RollerBearing
from dynamics.bearings.ball_elements import BallElements, RowPlacement
from dynamics.bearings.bearing_law import BearingDuty
from dynamics.bearings.loaded_bearing import LoadedBearing, Reaction
from dynamics.bearings.roller_elements import EXPONENT, RollerElements
from dynamics.bearings.rolling_bearing import RollingBearing
from dynamics.types import FloatArray
from host.optional_modules import scipy

AVERAGED = 64
"""Least number of elements, copies included, at which the force hardly varies as the cage turns.

A row of fewer elements gets copies that share the stiffness: its force is then the average over the passing
of an element.
"""
PASSING_ANGLES = 8
"""Angles of the cage within one element pitch at which the motion of the shaft is computed."""
MIN_PRESS = 1e-6
"""Approach, m, of one element whose force is the least typical load; an unloaded bearing has no stiffness."""
BALL_EXPONENT = 1.5
"""Exponent of the approach in the force of a ball (Hertzian point contact)."""


class _RowLaw:
    """The force of a rolling bearing on the shaft, see `BearingLaw` for the terms.

    `passing` says whether the force varies as each element passes; otherwise it is the average over the
    passing. Preload, damping and typical stiffness are always those of the average.
    """

    def __init__(self, bearing: RollingBearing, passing: bool = False) -> None:
        self.bearing = bearing
        self.row = bearing.row
        self.passing = passing
        self.copies = math.ceil(AVERAGED / bearing.row.count)
        self.loaded = LoadedBearing(bearing.row, self.copies, bearing.locating)

    @property
    def arrays(self) -> type[BallElements] | type[RollerElements]:
        """The type of the packed arrays for the compiled evaluation."""
        return BallElements if isinstance(self.row, BallBearing) else RollerElements

    @property
    def bushing(self) -> str:
        """The name of the bearing."""
        return self.bearing.name

    acts_at = bushing  # the law acts in all directions: the name alone tells it from other laws

    @property
    def lever(self) -> float:
        """Radius, m, that turns a tilt into a length."""
        return self.row.pitch_diameter / 2.0

    @cached_property
    def shift(self) -> float:
        """Displacement, m, of the inner ring against the outer along z while the shaft is not displaced.

        It is the displacement that causes the axial preload, plus the one that temperatures add. Raises
        `SolveError`: no displacement causes the preload.
        """
        if self.bearing.axial_preload == 0.0:
            return self.bearing.axial_shift
        preloaded = self.loaded.displacement((0.0, 0.0, self.bearing.axial_preload, 0.0, 0.0))
        return float(preloaded[2]) + self.bearing.axial_shift

    def rows(self, duty: BearingDuty) -> FloatArray:
        """Return the coordinates, m, per displacement x, y, z, tilt_x, tilt_y, (5, 5)."""
        return np.diag([1.0, 1.0, 1.0, self.lever, self.lever])

    def row_stiffness(self, duty: BearingDuty) -> FloatArray:
        """Return the stiffness of the rows at the typical load, (5,), N/m."""
        _, reaction = self._at_typical_load(duty)
        # tilt stiffness, N m/rad, over the lever squared is a stiffness of lengths, N/m
        return np.diag(reaction.tangent) / np.diag(self.rows(duty)) ** 2

    def deflection(self, duty: BearingDuty) -> float:
        """Return the displacement under the typical load across the axis, m."""
        displacement, _ = self._at_typical_load(duty)
        return displacement

    def tangent_error(self, duty: BearingDuty) -> float:
        """Return the displacement under the typical load, less what the tangent there predicts of it, m."""
        displacement, reaction = self._at_typical_load(duty)
        return displacement - float(reaction.force[0] / reaction.tangent[0, 0])

    def array_entry(self, duty: BearingDuty) -> tuple[BallBearing | RollerBearing, RowPlacement]:
        """Return the row and its placement, from which `arrays` are packed."""
        _, reaction = self._at_typical_load(duty)
        critical = 2.0 * math.sqrt(float(reaction.tangent[0, 0]) * duty.mass)
        # `viscous` is the damping at 1 s/m: the quotient is the damping of an element over its load, s/m
        damping = self.bearing.damping_ratio * critical / float(reaction.viscous[0, 0])
        copies = 1 if self.passing else self.copies
        return self.row, RowPlacement(copies, self.lever, self.shift, damping, self.bearing.locating)

    def passing_motion(self, duty: BearingDuty) -> float:
        """Return the motion of the shaft as an element passes, from peak to peak along the load, m."""
        loaded = LoadedBearing(self.row, 1, self.bearing.locating)  # one copy: the elements as they are
        pitch = 2.0 * math.pi / self.row.count
        angles = np.arange(PASSING_ANGLES) * pitch / PASSING_ANGLES
        displacements = []
        for angle in angles:
            displacement, _ = self._at_typical_load(duty, loaded, float(angle))
            displacements.append(displacement)
        return float(np.ptp(displacements))

    def _at_typical_load(
        self, duty: BearingDuty, bearing: LoadedBearing | None = None, angle: float = 0.0
    ) -> tuple[float, Reaction]:
        """Return the displacement along x, m, under the typical load along x, and the reaction to it.

        The other displacements stay 0, but for the shift along z. `angle` is that of the cage, rad.
        """
        exponent = BALL_EXPONENT if isinstance(self.row, BallBearing) else EXPONENT
        load = max(duty.load, self.row.element_stiffness * MIN_PRESS**exponent)

        def reaction(x: float) -> Reaction:
            return (bearing or self.loaded).evaluate((x, 0.0, self.shift, 0.0, 0.0), angle)

        def excess_force(x: float) -> float:
            return float(reaction(x).force[0] - load)

        upper = MIN_PRESS  # doubled until the root lies between 0 and it
        while excess_force(upper) < 0.0:
            upper *= 2.0
        displacement = float(scipy.optimize.brentq(excess_force, 0.0, upper, xtol=1e-15))  # m
        return displacement, reaction(displacement)


@lru_cache(maxsize=1024)
def row_law(bearing: RollingBearing, passing: bool = False) -> _RowLaw:
    """Return the law of `bearing`; equal bearings share one law."""
    return _RowLaw(bearing, passing)
