"""Interpolation error of a table between the nodes of its axes, measured at points it does not hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.estimates.held_out_loads import HeldOutLoads
from fe_contact.analysis.estimates.interval_goal import IntervalGoal
from fe_contact.analysis.pairs.contact_lines import deflected_operating_points
from fe_contact.analysis.pairs.pair_contact import OperatingPoint, OperatingPoints, operating_points
from fe_contact.analysis.request.solved_run import Solved
from fe_contact.contact import Start
from fe_contact.effects import ContactScene
from fe_contact.errors import DatabaseError
from fe_contact.sampled import LOADS, sample_of, some_positions, spread
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_quantities import BESIDE_MESH, FIRST_HARMONIC, QUANTITIES, quantity_changes
from fe_contact.ste.database import SupportLoads
from fe_contact.types import FloatArray, IntArray, Json

POSITIONS = 16
"""Positions at which an interval of center distances is assessed: each needs a compliance of its own."""

Curves = tuple[FloatArray, FloatArray]
"""Interpolant and solutions, (positions, L) in m."""


@dataclass(frozen=True)
class AxisError:
    """Error of STE between the nodes of one axis.

    Attributes
    ----------
    at : ndarray, shape (I,)
        The middle of every interval: of loads the geometric mean in N, beside which the quarters are held
        out, too; of misalignments or changes of the center distance in m.
    error : ndarray, shape (I, L) or (I, 1)
        Largest difference between interpolant and solution over the positions in m, at each load of the
        table; of the held-out loads themselves for the axis of loads. NaN where a solution did not converge.
    change : ndarray, shape (23, I, L) or (23, I, 1)
        What that does to mean, peak-to-peak and harmonics, m; bounds of it from `error` for center distances,
        which are not assessed at all positions.
    inserted : SupportLoads, optional
        Solutions at loads beside those requested, with which the table has these errors.
    """

    at: FloatArray
    error: FloatArray
    change: FloatArray
    inserted: SupportLoads | None = None

    def to_json(self) -> Json:
        """Return plain JSON; intervals without a solution hold null."""
        rows = [[float(e) if np.isfinite(e) else None for e in row] for row in self.error]
        inserted = [] if self.inserted is None else self.inserted.force.tolist()
        return {"at": self.at.tolist(), "error_m": rows, "inserted": inserted}


def held_out_axes(
    table: SteDatabase,
    points: OperatingPoints,
    scene: ContactScene,
    choices: Mapping[str, str],
    solved: Solved,
    goal: IntervalGoal | None = None,
) -> dict[str, AxisError]:
    """Solve one held-out point in every interval of every axis that has one.

    Positions are some of the table's, so that the axis alone is interpolated; what is missed between
    positions `table_nodes` measures. Loads and misalignments are assessed at 32 of them or more; center
    distances at those where the curves of the neighboring nodes differ most. On the other axes the point
    stands at the node nearest to zero; a longer period is assessed in its first pitch.

    Parameters
    ----------
    table : SteDatabase
        As computed.
    points : OperatingPoints
        That it was computed at.
    scene : ContactScene
        With the axes of the table.
    choices : mapping
        Effect name to "on" or "off", as decided for the whole table.
    solved : list of (ContactProblem, ContactSolution)
        Of every place, in all base pitches: held-out loads and misalignments start from the nearest ones.
    goal : IntervalGoal, optional
        Insert loads until their intervals meet it; not in a table of which base pitches are derived.

    Returns
    -------
    dict of str to AxisError
        By the name of the axis; empty for a table with failed points, or whose transmission error does not
        rise with load everywhere: neither can be interpolated.
    """
    if table.n_failed:
        return {}
    table = _first_pitch(table)
    assessed = _Assessed(table, some_positions(table.position.size), points, scene, choices, solved, goal)
    axes = {
        "force": (table.force, assessed.force),
        "misalignment": (table.misalignment, assessed.misalignment),
        "center_distance_change": (table.center_distance_change, assessed.center_distance_change),
    }
    several = {name: assess for name, (nodes, assess) in axes.items() if nodes.size > 1}
    try:
        if several:
            table.ste(table.position[0], table.force[0])
    except DatabaseError:
        return {}
    return {name: assess() for name, assess in several.items()}


def _first_pitch(table: SteDatabase) -> SteDatabase:
    """Return the first base pitch of a longer period: at its own positions the rest does not matter."""
    if table.period == 1:
        return table
    rows = int(np.searchsorted(table.position, 1.0))
    arrays = {
        name: getattr(table, name)[:rows]
        for name, dimensions in table.stored.items()
        if dimensions[0] == "position"
    }
    return replace(table, **arrays, period=1)


@dataclass(frozen=True)
class _Assessed:
    """The first pitch of a table that is held against solutions at some of its positions."""

    table: SteDatabase
    rows: IntArray
    places: OperatingPoints
    scene: ContactScene
    choices: Mapping[str, str]
    solved: Solved
    goal: IntervalGoal | None = None

    def force(self) -> AxisError:
        """Assess the loads, and insert those that the goal asks for."""
        force = self.table.force
        goal = None if any(point.derived is not None for point in self.places.places) else self.goal
        errors = HeldOutLoads(self.table, self.rows, self.places, self.solved).errors(goal)
        middles = np.sqrt(force[1:] * force[:-1])
        return AxisError(middles, errors.error[:, None], errors.change[..., None], errors.inserted)

    def misalignment(self) -> AxisError:
        """Assess the misalignments, at some loads."""
        force, some = self.table.force, sample_of(self.table.force.size, LOADS)
        middles, d = _middles(self.table.misalignment), self._nearest("center_distance_change")
        pairs = self._curves(self._held_out(middles, d), force[some], middles, d[0])
        change = np.stack([self._changes(curves) for curves in pairs], axis=1)
        error = np.array([_worst(curves) for curves in pairs])
        return AxisError(middles, spread(force, some, error, 1), spread(force, some, change, 2))

    def center_distance_change(self) -> AxisError:
        """Assess the changes of the center distance, at some loads and at the positions that tell most."""
        force, some = self.table.force, sample_of(self.table.force.size, LOADS)
        middles, m = _middles(self.table.center_distance_change), self._nearest("misalignment")
        position = [self.table.position[rows] for rows in _telling(self.table)]
        points, workers = self._held_out(m, middles), self.places.workers
        solved = deflected_operating_points(points, position, force[some], None, workers)
        held_out = zip(position, solved, middles, strict=True)
        worst = [
            _worst((self._tabulated(where, force[some], m[0], x), own[..., 0])) for where, own, x in held_out
        ]
        errors = spread(force, some, np.array(worst), 1)
        return AxisError(middles, errors, np.stack([errors, *[2.0 * errors] * (QUANTITIES - 1)]))

    def _curves(
        self, points: Sequence[OperatingPoint], load: FloatArray, misalignment: FloatArray, change: float
    ) -> list[Curves]:
        """Interpolant and solutions (positions, L) of places at misalignments, m; NaN where not converged."""
        position = self.table.position[self.rows]
        first, workers = points[0], self.places.workers
        first.contact.keep_rows(first.model, self.table.position, self.rows)
        starts = [self._start(load, x, change) for x in misalignment]
        where = [position] * len(points)
        solved = deflected_operating_points(points, where, load, None, workers, starts=starts)
        tabulated = [self._tabulated(position, load, x, change) for x in misalignment]
        return [(own, curves[..., 0]) for own, curves in zip(tabulated, solved, strict=True)]

    def _start(self, load: FloatArray, misalignment: float, change: float) -> Start:
        """Start between the solutions at the nodes around the points: of loads, and of misalignments."""
        below, above, share = _around(self.table.force, load)
        low, high, part = _around(self.table.misalignment, np.array([misalignment]))
        first, second = (self.solved[self._place(int(m[0]), change)] for m in (low, high))

        def between(force: FloatArray) -> FloatArray:
            lower, upper = (force[np.ix_(self.rows, loads)] for loads in (below, above))
            return np.asarray(lower + share[:, None] * (upper - lower))

        lower, upper = (between(solution.force) for _, solution in (first, second))
        return Start(first[0].candidates, lower + part * (upper - lower))

    def _place(self, m: int, change: float) -> int:
        """Return which operating point of the table has misalignment `m`, the nearest in center distance."""
        nodes = self.table.center_distance_change
        return m * nodes.size + int(np.argmin(np.abs(nodes - change)))

    def _tabulated(self, position: FloatArray, load: FloatArray, *alignment: float) -> FloatArray:
        """Interpolant (positions, L), m."""
        return self.table.ste(position[:, None], load, *alignment)

    def _changes(self, curves: Curves) -> FloatArray:
        """Return the changes of the quantities, (23, L) in m.

        Of one pitch, which has no orders beside the mesh: they count as the harmonic that changes most.
        """
        changes = quantity_changes(self.table.position[self.rows], *curves, 1)
        changes[BESIDE_MESH] = changes[FIRST_HARMONIC:].max(axis=0)
        return changes

    def _nearest(self, name: str) -> FloatArray:
        nodes: FloatArray = getattr(self.table, name)
        return nodes[[int(np.argmin(np.abs(nodes)))]]

    def _held_out(self, misalignment: FloatArray, change: FloatArray) -> tuple[OperatingPoint, ...]:
        here = replace(self.scene, misalignment=misalignment, center_distance_change=change)
        return operating_points(here, self.choices, self.places.nominal).places


def _around(nodes: FloatArray, at: FloatArray) -> tuple[IntArray, IntArray, FloatArray]:
    """Return the nodes below and above points of an axis, and the part of the way that each point is on."""
    above = np.clip(np.searchsorted(nodes, at), min(1, nodes.size - 1), nodes.size - 1)
    below = np.maximum(above - 1, 0)
    step = nodes[above] - nodes[below]
    return below, above, (at - nodes[below]) / np.where(step > 0.0, step, 1.0)


def _worst(curves: Curves) -> FloatArray:
    """Largest difference (L,) over the positions, m."""
    return np.asarray(np.abs(curves[0] - curves[1]).max(axis=0))


def _telling(table: SteDatabase) -> list[IntArray]:
    """Return the rows that tell most of the error of every interval of center distances.

    Those in which the transmission errors at its two ends differ most, in parts of their largest difference
    at each load: there handovers move.
    """
    m = int(np.argmin(np.abs(table.misalignment)))
    step = np.abs(np.diff(table.static_transmission_error[:, :, m, :], axis=2))
    telling = (step / np.maximum(step.max(axis=0), 1e-300)).max(axis=1)
    return [np.sort(np.argsort(column, kind="stable")[-POSITIONS:]) for column in telling.T]


def _middles(nodes: FloatArray) -> FloatArray:
    return np.asarray(0.5 * (nodes[:-1] + nodes[1:]))
