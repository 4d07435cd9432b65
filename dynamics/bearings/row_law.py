"""A row of rolling elements as the law of a bearing in a scene."""

from __future__ import annotations

import math
from functools import cached_property, lru_cache

import numpy as np
import scipy

from dynamics.bearings import BallBearing, RollerBearing
from dynamics.bearings.ball_elements import BallElements, RowPlacement
from dynamics.bearings.bearing_law import BearingDuty
from dynamics.bearings.loaded_bearing import LoadedBearing, Reaction
from dynamics.bearings.roller_elements import EXPONENT, RollerElements
from dynamics.bearings.rolling_bearing import RollingBearing
from dynamics.types import FloatArray

AVERAGED = 64
"""Elements in all, at least, whose force is taken for the average over the passing of an element."""
PASSING_ANGLES = 8
MIN_PRESS = 1e-6  # m; of one element: sets the typical load of a bearing that nothing loads


class _RowLaw:
    """The law of a bearing.

    `passing`: whether its elements pass one by one; False: their average over the passing. Preload, damping
    and typical stiffness are those of the average.
    """

    def __init__(self, bearing: RollingBearing, passing: bool = False) -> None:
        self.bearing, self.row, self.passing = bearing, bearing.row, passing
        self.copies = math.ceil(AVERAGED / bearing.row.count)
        self.loaded = LoadedBearing(bearing.row, self.copies, bearing.locating)

    @property
    def arrays(self) -> type[BallElements] | type[RollerElements]:
        return BallElements if isinstance(self.row, BallBearing) else RollerElements

    @property
    def bushing(self) -> str:
        return self.bearing.name

    acts_at = bushing

    @property
    def lever(self) -> float:
        """Radius that makes lengths of tilts, m."""
        return self.row.pitch_diameter / 2.0

    @cached_property
    def shift(self) -> float:
        """Displacement of the inner ring against the outer, along z, where the shaft is not displaced, m.

        What makes the axial preload, and what temperatures add. Raises `SolveError`: no displacement makes
        it.
        """
        if self.bearing.axial_preload == 0.0:
            return self.bearing.axial_shift
        preloaded = self.loaded.displacement((0.0, 0.0, self.bearing.axial_preload, 0.0, 0.0))
        return float(preloaded[2]) + self.bearing.axial_shift

    def rows(self, duty: BearingDuty) -> FloatArray:
        return np.diag([1.0, 1.0, 1.0, self.lever, self.lever])

    def typical(self, duty: BearingDuty) -> FloatArray:
        """Return the stiffness of the rows at the typical load, (5,), N/m."""
        return np.diag(self._under(duty)[1].tangent) / np.diag(self.rows(duty)) ** 2

    def way(self, duty: BearingDuty) -> float:
        """Return the displacement under the typical load across the axis, m."""
        return self._under(duty)[0]

    def tangent_error(self, duty: BearingDuty) -> float:
        way, at = self._under(duty)
        return way - float(at.force[0] / at.tangent[0, 0])

    def laid_out(self, duty: BearingDuty) -> tuple[BallBearing | RollerBearing, RowPlacement]:
        at = self._under(duty)[1]
        critical = 2.0 * math.sqrt(float(at.tangent[0, 0]) * duty.mass)
        damping = self.bearing.damping_ratio * critical / float(at.viscous[0, 0])
        copies = 1 if self.passing else self.copies
        return self.row, RowPlacement(copies, self.lever, self.shift, damping, self.bearing.locating)

    def passing_motion(self, duty: BearingDuty) -> float:
        """Return how far the shaft moves as an element passes, from peak to peak along the load, m."""
        loaded, pitch = LoadedBearing(self.row, 1, self.bearing.locating), 2.0 * math.pi / self.row.count
        angles = np.arange(PASSING_ANGLES) * pitch / PASSING_ANGLES
        return float(np.ptp([self._under(duty, loaded, float(angle))[0] for angle in angles]))

    def _under(
        self, duty: BearingDuty, loaded: LoadedBearing | None = None, angle: float = 0.0
    ) -> tuple[float, Reaction]:
        """Return displacement and answer under the typical load across the axis, nothing else moving."""
        exponent = 1.5 if isinstance(self.row, BallBearing) else EXPONENT
        load = max(duty.load, self.row.element_stiffness * MIN_PRESS**exponent)

        def reaction(way: float) -> Reaction:
            return (loaded or self.loaded).evaluate((way, 0.0, self.shift, 0.0, 0.0), angle)

        far = MIN_PRESS
        while reaction(far).force[0] < load:
            far *= 2.0
        way = float(scipy.optimize.brentq(lambda x: float(reaction(x).force[0]) - load, 0.0, far, xtol=1e-15))
        return way, reaction(way)


@lru_cache(maxsize=1024)
def row_law(bearing: RollingBearing, passing: bool = False) -> _RowLaw:
    """Return the law of `bearing`, laid out once."""
    return _RowLaw(bearing, passing)
