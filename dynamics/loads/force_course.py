"""The compiled law of applied forces: a factor by time, speed or angle, turned with a shaft."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from dynamics.kernels.local_state import LocalState
from dynamics.kernels.routine import routine
from dynamics.loads.load_course import BySpeed, Course, Orders
from dynamics.loads.time_law import TimeLaw
from dynamics.types import BoolArray, FloatArray, IntArray

BY_TIME, BY_SPEED, BY_ANGLE = 0, 1, 2


class ForceCourseLaws(NamedTuple):
    """l applied forces in y: along, and where they turn across, then along the axis if they have such a part.

    With the factor s and the angle a of the frame they act by size s along the first row, or by size s cos a,
    size s sin a and size s along the three. A last row, of the shaft whose speed counts, carries no force.

    Attributes
    ----------
    kind : (l,) int array
        What the factor depends on.
    size, lever, sense : (l,) arrays
        N; last row over rotation, m; +1 or -1: the sense in which the speed counts.
    rows : (l,) int array
        1, 2 or 3 rows that carry force.
    phase, frame : (l,) int arrays
        Phases among the positions, in turns: of the factor, of the frame; -1: none.
    first, start, coefficient : (l + 1,) int, (S,), (S, 4) arrays
        Pieces of factors by time (s) and by speed (rad/s): first of each, start, ascending coefficients.
    first_order, order, amplitude, angle : (l + 1,) int, (O,), (O,), (O,) arrays
        Of factors by angle; rad.
    constant : (l,) array
        Constant part of factors by angle.
    mean : (l, 2) array
        Mean of s cos a and s sin a over a turn, of factors by angle.
    steady : (1,) bool array
        Whether means act in place of what changes with an angle.
    """

    kind: IntArray
    size: FloatArray
    lever: FloatArray
    sense: FloatArray
    rows: IntArray
    phase: IntArray
    frame: IntArray
    first: IntArray
    start: FloatArray
    coefficient: FloatArray
    first_order: IntArray
    order: FloatArray
    amplitude: FloatArray
    angle: FloatArray
    constant: FloatArray
    mean: FloatArray
    steady: BoolArray

    def starting_at(self, time: float) -> ForceCourseLaws:
        """Return the laws with `time` (s) as 0."""
        by_time = np.repeat(self.kind == BY_TIME, np.diff(self.first))
        return self._replace(start=self.start - time * by_time)

    def held_at(self, time: float) -> ForceCourseLaws:
        """Return the laws with factors by time for ever as they are at `time`, s."""
        coefficient = self.coefficient.copy()
        for entry in np.flatnonzero(self.kind == BY_TIME):
            first, end = self.first[entry], self.first[entry + 1]
            piece = first + int(np.searchsorted(self.start[first + 1 : end], time, side="right"))
            elapsed, cubic = time - self.start[piece], self.coefficient[piece]
            value = cubic[0] + elapsed * (cubic[1] + elapsed * (cubic[2] + elapsed * cubic[3]))
            coefficient[first:end] = [value, 0.0, 0.0, 0.0]
        return self._replace(coefficient=coefficient)


def pack_courses(courses: Sequence[Course]) -> dict[str, np.ndarray]:
    """Lay out courses: the fields of `ForceCourseLaws` that follow from them alone."""
    pieces = [_pieces(course) for course in courses]
    angular = [course if isinstance(course, Orders) else Orders("", (), (), ()) for course in courses]
    kinds = {TimeLaw: BY_TIME, BySpeed: BY_SPEED, Orders: BY_ANGLE}
    per_order = {
        name: np.concatenate([np.empty(0), *(np.asarray(getattr(part, of), dtype=float) for part in angular)])
        for name, of in (("amplitude", "amplitude"), ("angle", "phase"))
    }
    exact = [float(order) for part in angular for order in part.multiple]
    return {
        "kind": np.array([kinds[type(course)] for course in courses], dtype=np.int64),
        "first": np.cumsum([0, *(start.size for start, _ in pieces)], dtype=np.int64),
        "start": np.concatenate([np.empty(0), *(start for start, _ in pieces)]),
        "coefficient": np.concatenate([np.empty((0, 4)), *(values for _, values in pieces)]),
        "first_order": np.cumsum([0, *(len(part.order) for part in angular)], dtype=np.int64),
        "order": np.array(exact, dtype=float),
        **per_order,
        "constant": np.array([part.mean for part in angular], dtype=float),
    }


def _pieces(course: Course) -> tuple[FloatArray, FloatArray]:
    """Start and coefficients of the pieces of a factor by time or by speed."""
    if isinstance(course, TimeLaw):
        return course.polynomials()
    if isinstance(course, BySpeed):
        return course.curve.start, np.asarray(course.curve.coefficient, dtype=float)
    return np.empty(0), np.empty((0, 4))


@routine
def applied_force(laws: ForceCourseLaws, entry: int, local: LocalState, row: int) -> None:
    """Write forces, which resist as all do, and how they change with the speed."""
    rows, size, steady = laws.rows[entry], laws.size[entry], laws.steady[0]
    kind, factor, slope = laws.kind[entry], 0.0, 0.0
    if kind == BY_ANGLE:
        factor = laws.constant[entry]
        if not steady:
            turned = 2.0 * math.pi * local.position[laws.phase[entry]]
            for k in range(laws.first_order[entry], laws.first_order[entry + 1]):
                factor += laws.amplitude[k] * math.cos(laws.order[k] * turned + laws.angle[k])
    else:
        at = local.clock[0]
        if kind == BY_SPEED:
            lever = laws.sense[entry] * laws.lever[entry]
            at = (local.rate[row + rows] + local.drift[row + rows]) / lever
        piece = laws.first[entry]
        while piece + 1 < laws.first[entry + 1] and at >= laws.start[piece + 1]:
            piece += 1
        s, c = at - laws.start[piece], laws.coefficient
        factor = c[piece, 0] + s * (c[piece, 1] + s * (c[piece, 2] + s * c[piece, 3]))
        slope = c[piece, 1] + s * (2.0 * c[piece, 2] + 3.0 * s * c[piece, 3])
    cosine, sine = 1.0, 0.0
    if laws.frame[entry] >= 0:
        angle = 2.0 * math.pi * local.position[laws.frame[entry]]
        cosine, sine = math.cos(angle), math.sin(angle)
    for k in range(rows):
        share = 1.0 if k == 2 else (sine if k == 1 else cosine)
        value = factor * share
        if steady and k < 2 and rows > 1:
            value, share = laws.mean[entry, k], 0.0
        local.force[row + k] = -size * value
        if kind == BY_SPEED:
            lever = laws.sense[entry] * laws.lever[entry]
            local.viscous[row + k, rows] = -size * slope * share / lever
