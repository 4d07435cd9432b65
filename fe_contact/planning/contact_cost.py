"""Cost of the contact of a table and of its error estimate: positions to assemble, points to solve.

Constants fitted to tables of 3 to 70 candidates in the plane and over the face, met within 0.6 to 1.5 where
the search ends with the positions expected; a level without a floor may ask for twice as many.
"""

from __future__ import annotations

from typing import NamedTuple

from fe_contact.contact import ContactModel
from fe_contact.contact.problem import POINTS
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.plan import Plan
from fe_contact.sampled import ALIGNMENTS, LOADS, WIDE_INTERVALS, WIDE_PROBES, some_positions

_PLANE_POSITION, _PLANE_POINT, _PLANE_CANDIDATE = 4e-5, 3e-6, 0.55e-6
_FACE_POSITION = 1.4e-6
"""Per slice of a tooth pair and square of the elements of a module along the profile."""
_FACE_CANDIDATE, _FACE_SQUARE = 2.9e-6, 1.0e-7
_PLANE_EXPECTED, _FACE_EXPECTED = 118, 76
"""Positions that the search ends with; of 10 helical pairs 64 to 145, with a tolerance 64 to 66."""
_TRIED_PER_NODE, _TRIED_PER_START = 9, 4
"""Positions looked at for each node that the search adds, and for each that it begins with."""
_JUDGED = 3
_SOLVED_MIDDLES = 0.25
"""Part of the intervals between fixed positions whose middles are solved, at most."""
_HELD_OUT_DISTANCES = 16
"""Positions at which an interval of center distances is assessed."""
_PLANE_CHECK = 6e-3
"""CPU seconds that the estimate of errors takes beside its solutions."""
_TABLE_POINT = 2e-6
"""CPU seconds to interpolate one point of a table."""


_HELD_POSITIONS, _HELD_PART = 320, 2.5
"""Positions whose compliance is held at once: of a search that begins with 64, and in parts of fixed ones."""


_POINT_NUMBERS = 25
"""Numbers that are kept of a touching point."""


class Work(NamedTuple):
    """CPU seconds to assemble one position, and to solve one load at it."""

    position: float
    point: float

    def of(self, positions: float, points: float) -> float:
        """Return the CPU seconds of so many positions and points."""
        return positions * self.position + points * self.point


def contact_seconds(
    pair: ParallelAxes,
    plan: Plan,
    model: ContactModel,
    alignments: tuple[int, int],
    *,
    with_errors: bool = True,
) -> tuple[float, float, float]:
    """CPU seconds of the search of positions, of the table, and of the solutions that measure its errors."""
    kept, loads = expected_positions(plan), plan.load.size
    points, distances = alignments[0] * alignments[1], alignments[1]
    assessed, rows = min(points, _JUDGED), model.period * points
    tried = expected_tries(plan)
    work = unit_work(pair, plan, plan.discretization.slices)
    search = work.of(tried * distances, tried * assessed * loads)
    table = work.of(kept * distances, kept * rows * (loads + plan.support.size))
    return search, table, _errors(pair, plan, model.period, alignments) if with_errors else 0.0


def _errors(pair: ParallelAxes, plan: Plan, period: int, alignments: tuple[int, int]) -> float:
    """CPU seconds of rougher solutions of some of the table, middles, and held-out points of its axes."""
    made, kept, loads = plan.discretization, expected_positions(plan), plan.load.size
    work = unit_work(pair, plan, made.slices)
    rougher = [work, *([work] if made.corrected else [])]
    if made.slices > 1:
        rougher.append(unit_work(pair, plan, made.coarse_slices))
    some, rows = min(loads, LOADS), some_positions(kept).size
    skews, distances = (min(count, ALIGNMENTS) for count in alignments)
    seconds = sum(w.of(rows * distances, rows * period * skews * distances * some) for w in rougher)
    if plan.positions is not None:
        middles, assessed = _SOLVED_MIDDLES * kept, min(alignments[0] * alignments[1], _JUDGED)
        seconds += work.of(middles * alignments[1], middles * period * assessed * some)
    held = rows * (_held_out_loads(loads) + (alignments[0] - 1) * some)
    apart = _HELD_OUT_DISTANCES * (alignments[1] - 1)
    seconds += work.of(apart, held + apart * some)
    return _PLANE_CHECK + seconds + _TABLE_POINT * kept * period * alignments[0] * alignments[1] * loads


def _held_out_loads(loads: int) -> int:
    """Return how many loads are held out between so many."""
    return (loads - 1) * (WIDE_PROBES if loads - 1 <= WIDE_INTERVALS else 1)


def contact_bytes(pair: ParallelAxes, plan: Plan) -> float:
    """Return the bytes of compliance and touching points that are held at once."""
    held = _HELD_POSITIONS if plan.positions is None else _HELD_PART * plan.positions
    count = candidates(pair, plan.discretization.slices)
    points = count * (POINTS if plan.discretization.slices > 1 else 1)
    return 8.0 * held * (count**2 + _POINT_NUMBERS * points)


def candidates(pair: ParallelAxes, slices: int) -> float:
    """Return about how many slices of tooth pairs a position has."""
    return float((pair.transverse_contact_ratio + pair.overlap_ratio + 1.0) * slices)


def unit_work(pair: ParallelAxes, plan: Plan, slices: int) -> Work:
    """Return what one position and one point of it cost in so many slices."""
    made = plan.discretization
    count = candidates(pair, slices)
    if not isinstance(made, FaceDiscretization):
        return Work(_PLANE_POSITION, _PLANE_POINT + _PLANE_CANDIDATE * count)
    elements = max(pair.pinion.normal_module / recipe.flank_size for recipe in made.recipes)
    return Work(_FACE_POSITION * elements**2 * count, _FACE_CANDIDATE * count + _FACE_SQUARE * count**2)


def expected_tries(plan: Plan) -> int:
    """Return the positions at which the search usually solves; none if they are requested."""
    if plan.positions is not None:
        return 0
    begun = plan.nodes.start
    return _TRIED_PER_START * begun + _TRIED_PER_NODE * max(expected_positions(plan) - begun, 0)


def expected_positions(plan: Plan) -> int:
    """Return the positions in a base pitch: requested, or those that the search usually ends with."""
    if plan.positions is not None:
        return plan.positions
    return _FACE_EXPECTED if isinstance(plan.discretization, FaceDiscretization) else _PLANE_EXPECTED
