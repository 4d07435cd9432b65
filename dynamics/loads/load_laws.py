"""The compiled laws of loads: torques by speed, forces by time, speed or angle, unbalances.

A law is a constant size times a factor, which follows the time, the speed or the angle of a shaft. A row is
one generalized force on the mechanism. Compiled code reads the records of arrays below.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from dynamics.kernels.cubics import Cubics, value_and_slope
from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.loads.load_course import BySpeed, Course, Orders
from dynamics.loads.time_law import TimeLaw
from dynamics.types import BoolArray, FloatArray, IntArray

BY_TIME, BY_SPEED, BY_ANGLE = 0, 1, 2  # kinds of factors: the variable that they depend on
AXIAL_ROW = 2  # row of a turning force along the axis; rows 0 and 1 turn with cosine and sine


class ForceCourseLaws(NamedTuple):
    """Laws of l applied forces, each of which acts on the rows of its element.

    A force that stands still has one row, on which it acts with size s; s is its factor. A force that turns
    with a frame by the angle a has two rows across the axis, with size s cos a and size s sin a, and a third
    with size s if it has a part along the axis. Behind these a force by speed has a row without force: it
    reads the speed of the shaft on which the factor depends.
    """

    kind: IntArray
    """Variable of the factor: time, speed or angle. Shape (l,)."""
    size: FloatArray
    lever: FloatArray
    sense: FloatArray
    """`size`, `lever`, `sense`: Size of the force, N; motion along the row of the speed per rotation of the
    shaft, m; sense in which the speed counts, +1 or -1. Shape (l,) each.
    """
    rows: IntArray
    """Number of rows that carry force, 1, 2 or 3. Shape (l,)."""
    phase: IntArray
    frame: IntArray
    """`phase`, `frame`: Indices among the positions (`LocalState.position`) of the angle of the factor and of
    the angle of the frame, both in turns; -1: there is none. Shape (l,) each.
    """
    factor: Cubics
    """Factors by time (s) and by speed (rad/s)."""
    first_order: IntArray
    order: FloatArray
    amplitude: FloatArray
    angle: FloatArray
    """`first_order`, `order`, `amplitude`, `angle`: First order of each load in the flat arrays, then the
    orders of factors by angle, their amplitudes and their angles, rad. (l + 1,) int, (O,), (O,), (O,) arrays.
    """
    constant: FloatArray
    """Constant part of factors by angle. Shape (l,)."""
    mean: FloatArray
    """Mean of s cos a and s sin a over a turn; zero unless the factor depends on an angle. Shape (l, 2)."""
    steady: BoolArray
    """Whether means act in place of forces that change with an angle. Shape (1,)."""

    @classmethod
    def packed(cls, courses: Sequence[Course], **others: Any) -> ForceCourseLaws:
        """Lay out courses; `others` are the fields that do not follow from them."""
        empty = Orders("", (), (), ())  # no orders: holds the position of a factor by time or by speed
        angular = [course if isinstance(course, Orders) else empty for course in courses]
        kinds = {TimeLaw: BY_TIME, BySpeed: BY_SPEED, Orders: BY_ANGLE}
        return cls(
            kind=np.array([kinds[type(course)] for course in courses], dtype=np.int64),
            factor=Cubics.packed([_pieces(course) for course in courses]),
            first_order=np.cumsum([0, *(len(part.order) for part in angular)], dtype=np.int64),
            # multiples of 1/d, so that they repeat after d turns
            order=np.array([float(order) for part in angular for order in part.multiple], dtype=float),
            amplitude=np.array([size for part in angular for size in part.amplitude], dtype=float),
            angle=np.array([phase for part in angular for phase in part.phase], dtype=float),
            constant=np.array([part.mean for part in angular], dtype=float),
            steady=np.zeros(1, dtype=np.bool_),
            **others,
        )

    def starting_at(self, time: float) -> ForceCourseLaws:
        """Return the laws on a clock that reads 0 at `time`, s."""
        by_time = np.repeat(self.kind == BY_TIME, np.diff(self.factor.first))  # for each piece of the cubics
        return self._replace(factor=self.factor._replace(start=self.factor.start - time * by_time))

    def frozen_at(self, time: float) -> ForceCourseLaws:
        """Return the laws with constant factors by time, of the values at `time`, s."""
        factor, coefficient = self.factor, self.factor.coefficient.copy()
        for entry in np.flatnonzero(self.kind == BY_TIME):
            first, end = factor.first[entry], factor.first[entry + 1]
            piece = first + int(np.searchsorted(factor.start[first + 1 : end], time, side="right"))
            elapsed, cubic = time - factor.start[piece], factor.coefficient[piece]
            value = cubic[0] + elapsed * (cubic[1] + elapsed * (cubic[2] + elapsed * cubic[3]))
            coefficient[first:end] = [value, 0.0, 0.0, 0.0]
        return self._replace(factor=factor._replace(coefficient=coefficient))


def _pieces(course: Course) -> tuple[FloatArray, FloatArray]:
    """Start and coefficients of the pieces of a factor by time or by speed."""
    if isinstance(course, TimeLaw):
        return course.polynomials()
    if isinstance(course, BySpeed):
        return course.curve.start, np.asarray(course.curve.coefficient, dtype=float)
    return np.empty(0), np.empty((0, 4))


@routine
def applied_force(laws: ForceCourseLaws, entry: int, local: LocalState, row: int) -> None:
    """Write the forces of the law `entry` on its rows, the first of which is `row`, and their slopes.

    Forces of the local state are positive where they resist motion, so applied ones have the sign -1. A slope
    is that of a force by the rate of the row of the speed, which follows the rows with force.
    """
    rows, size = laws.rows[entry], laws.size[entry]
    kind, steady = laws.kind[entry], laws.steady[0]
    slope = 0.0  # of the factor; over rad/s where the kind is BY_SPEED, else not used
    lever = laws.sense[entry] * laws.lever[entry]
    if kind == BY_ANGLE:
        factor = laws.constant[entry]
        if not steady:
            rotation = 2.0 * math.pi * local.position[laws.phase[entry]]
            for k in range(laws.first_order[entry], laws.first_order[entry + 1]):
                factor += laws.amplitude[k] * math.cos(laws.order[k] * rotation + laws.angle[k])
    else:
        variable = local.clock[0]
        if kind == BY_SPEED:  # the row of the speed: rate of the vibration, and drift of the kinematic motion
            variable = (local.rate[row + rows] + local.drift[row + rows]) / lever
        factor, slope = value_and_slope(laws.factor, entry, variable)
    cosine, sine = 1.0, 0.0
    if laws.frame[entry] >= 0:
        angle = 2.0 * math.pi * local.position[laws.frame[entry]]
        cosine, sine = math.cos(angle), math.sin(angle)
    for k in range(rows):
        share = 1.0 if k == AXIAL_ROW else (sine if k == 1 else cosine)
        value = factor * share
        if steady and k < AXIAL_ROW and rows > 1:  # only a turning force has more than one row
            value, share = laws.mean[entry, k], 0.0
        local.force[row + k] = -size * value
        if kind == BY_SPEED:
            local.viscous[row + k, rows] = -size * slope * share / lever
