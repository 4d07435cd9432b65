"""A bearing's force against displacement in one direction, from a table; and its compiled law.

The curve consists of S *pieces*: straight below the table, cubic between its points, straight above it. A law
works with a local coordinate in m and a force in N; a *lever*, a radius in m, turns tilts and moments into
such.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np

from dynamics.bearings.bearing_law import BearingDuty, SceneBearingLaw
from dynamics.checks import finite, increasing, one_of
from dynamics.errors import InputError
from dynamics.kernels.cubics import Cubics, area, piece_at, value_and_slope
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.types import FloatArray
from host.optional_modules import scipy

DIRECTIONS = ("x", "y", "z", "tilt_x", "tilt_y")
"""Directions of a curve, in the order of the five motions of a bearing."""


class SpringCurveLaws(NamedTuple):
    """Force-displacement curves of l bearings."""

    force: Cubics
    """Force over displacement: N over m, or N m over rad."""
    energy: FloatArray
    """Energy at the start of each piece less that at zero displacement, J. Shape (S,) over all bearings."""
    lever: FloatArray
    """Coordinate over displacement: 1, or a radius in m for tilts. Shape (l,)."""

    @classmethod
    def packed(cls, laws: Sequence[tuple[SpringCurve, BearingDuty]]) -> SpringCurveLaws:
        """Lay out laws, each with the duty of its bearing."""
        pieces = [part.pieces() for part, _ in laws]
        energies = [_energies(start, coefficient) for start, coefficient in pieces]
        levers = [part.lever(duty) for part, duty in laws]
        return cls(
            Cubics.packed(pieces),
            np.concatenate([np.empty(0), *energies]),
            np.array(levers, dtype=float),
        )


@dataclass(frozen=True)
class SpringCurve(SceneBearingLaw):
    """A force on the ground by the displacement of the shaft in one direction of a bushing.

    The force adds to the linear forces of the bushing, damping included. The curve passes through the points
    without overshoot (Fritsch and Carlson) and continues with the end slopes beyond them.
    """

    bushing: str
    """Bushing or planet bearing to which the curve belongs."""
    direction: str
    """One of x, y, z, tilt_x, tilt_y, with at most one curve each. On a planet bearing x points away from the
    carrier's axis.
    """
    displacement: tuple[float, ...]
    """Displacements of the table, m, or rad for a tilt; strictly increasing, at least 2."""
    force: tuple[float, ...]
    """Forces of the table, N, or moments, N m, for a tilt; strictly increasing."""

    def __post_init__(self) -> None:
        one_of("direction", self.direction, DIRECTIONS)
        size = increasing("displacement", self.displacement).size
        if size < 2:
            raise InputError("displacement", self.displacement, "at least 2 values")
        if len(self.force) != size:
            raise InputError("force", len(self.force), f"as many values as displacements ({size})")
        for index, value in enumerate(self.force):
            finite(f"force[{index}]", value)
        increasing("force", self.force, "A bearing whose force falls with displacement is unstable.")

    arrays: ClassVar[type[SpringCurveLaws]] = SpringCurveLaws

    @property
    def acts_at(self) -> str:
        """The bearing and the direction."""
        return f"{self.bushing}.{self.direction}"

    @property
    def slope(self) -> float:
        """Mean stiffness over the table, N/m or N m/rad."""
        return (self.force[-1] - self.force[0]) / (self.displacement[-1] - self.displacement[0])

    def lever(self, duty: BearingDuty) -> float:
        """Return coordinate over displacement: 1, or the radius in m for tilts."""
        return duty.lever if self.direction.startswith("tilt") else 1.0

    def rows(self, duty: BearingDuty) -> FloatArray:
        """Return the local coordinate per motion x, y, z, tilt_x, tilt_y of the bearing, (1, 5)."""
        return self.lever(duty) * np.eye(5)[[DIRECTIONS.index(self.direction)]]

    def array_entry(self, duty: BearingDuty) -> tuple[SpringCurve, BearingDuty]:
        """Return the curve as `SpringCurveLaws.packed` takes it."""
        return self, duty

    def row_stiffness(self, duty: BearingDuty) -> FloatArray:
        """Return the mean stiffness of the curve, (1,), N/m."""
        return np.array([self.slope / self.lever(duty) ** 2])

    def tangent_error(self, duty: BearingDuty) -> float:
        """Return the deviation of the table from a straight line through its value at 0, m; of a tilt 0."""
        if self.direction.startswith("tilt"):
            return 0.0
        ways, forces = np.array(self.displacement), np.array(self.force)
        straight = np.interp(0.0, ways, forces) + self.slope * ways
        deviation = float(np.max(np.abs(forces - straight))) / self.slope
        return min(deviation, float(np.max(np.abs(ways[[0, -1]]))))  # no more than the reach of the table

    def scaled(self, factor: float) -> SpringCurve:
        """Return the curve with all its forces times `factor`."""
        return replace(self, force=tuple(factor * value for value in self.force))

    def after_growth(self, growth: float) -> SpringCurve:
        """Return the curve where the shaft has grown by `growth` (m) along z: shifted, if it acts along z."""
        if self.direction != "z" or not growth:
            return self
        return replace(self, displacement=tuple(x - growth for x in self.displacement))

    @property
    def holds_axially(self) -> bool:
        """Whether the curve acts along z."""
        return self.direction == "z"

    @property
    def fixed_direction(self) -> str | None:
        """Name of the direction field, unless the curve acts along the axis (None)."""
        return None if self.direction == "z" else "direction"

    def pieces(self) -> tuple[FloatArray, FloatArray]:
        """Return the starts of the pieces (S,) and their ascending coefficients (S, 4).

        A piece counts the displacement from its start. The first, straight one lies below the table: it
        starts at the table's first point, as the second piece does, and counts backwards.
        """
        x, f = np.asarray(self.displacement, dtype=float), np.asarray(self.force, dtype=float)
        inside = scipy.interpolate.PchipInterpolator(x, f)
        slope = inside.derivative()
        first, last = [[f[0], float(slope(x[0])), 0.0, 0.0]], [[f[-1], float(slope(x[-1])), 0.0, 0.0]]
        # scipy has coefficients in descending order, (4, S - 2)
        return np.array([x[0], *x]), np.concatenate([first, inside.c[::-1].T, last])


def _energies(start: FloatArray, c: FloatArray) -> FloatArray:
    """Return the energy at the start of each piece, J, 0 at zero displacement; `c` (S, 4): coefficients."""
    inside = np.array([_area(c[k], start[k + 1] - start[k]) for k in range(1, start.size - 1)])
    from_first = np.concatenate([[0.0, 0.0], np.cumsum(inside)])  # two zeros: pieces 0 and 1 start together
    # the piece that holds zero displacement
    piece = max(int(np.searchsorted(start[1:], 0.0, side="right")), 0)
    return np.asarray(from_first - from_first[piece] - _area(c[piece], -start[piece]))


def _area(c: FloatArray, s: float) -> float:
    """Return the integral of a cubic with ascending coefficients `c` from 0 to s."""
    return float(s * (c[0] + s * (c[1] / 2.0 + s * (c[2] / 3.0 + s * c[3] / 4.0))))


@routine
def spring_curve(laws: SpringCurveLaws, entry: int, local: LocalState, row: int) -> None:
    """Write force and derivative at the coordinate of `row`."""
    lever = laws.lever[entry]
    force, slope = value_and_slope(laws.force, entry, local.coordinate[row] / lever)
    local.force[row] = local.elastic[row] = force / lever
    local.tangent[row, 0] = slope / (lever * lever)


@routine
def spring_curve_energy(laws: SpringCurveLaws, entry: int, local: LocalState, row: int) -> float:
    """Return the energy at the coordinate of `row` less that at 0, J."""
    displacement = local.coordinate[row] / laws.lever[entry]
    piece = piece_at(laws.force, entry, displacement)
    stored = area(laws.force, piece, displacement - laws.force.start[piece])
    return float(laws.energy[piece] + stored)
