"""Interpolation error between the alignments of a table, and the alignments that bring it down.

A held-out alignment is solved at some positions and loads. Where the table misses it by more than a goal
allows, the middle of the interval becomes a node, and both halves are measured again.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fe_contact.analysis.estimates.inserted_places import (
    alignment_points,
    take_compliance,
    with_inserted_nodes,
)
from fe_contact.analysis.estimates.interval_goal import GoalOf
from fe_contact.analysis.estimates.tolerance_shares import allowed_errors
from fe_contact.analysis.estimates.validation_loads import AWAY, halvings_reached
from fe_contact.analysis.pairs.contact_lines import deflected_operating_points
from fe_contact.analysis.tables import SolvedTable
from fe_contact.contact import Start
from fe_contact.sampled import LOADS, sample_of, sampled_positions, spread
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_quantities import (
    FIRST_HARMONIC,
    MEAN,
    OFF_MESH,
    PEAK_TO_PEAK,
    quantity_changes,
)
from fe_contact.ste.fields import CENTER_DISTANCE, GRID, MISALIGNMENT
from fe_contact.types import BoolArray, FloatArray, IntArray

MIDDLE, QUARTERS = (0.5,), (0.25, 0.5, 0.75)
"""Held-out alignments in parts of an interval. Between three nodes or more the error of a cubic may vanish in
the middle; with a goal the quarters are solved once the middle meets it."""
MAX_HALVINGS = 5
"""Halvings of an interval of requested alignments: 20 um become intervals of 0.6 um."""


@dataclass(frozen=True)
class AlignmentErrors:
    """Error between the nodes of an axis of alignments."""

    solved_table: SolvedTable
    """Solved table with the inserted alignments."""
    error: FloatArray
    """Largest difference of interpolant and solution in the interval after each node, m. Shape (I, F)."""
    change: FloatArray
    """Change of mean, peak-to-peak and harmonics by the difference at the held-out alignment, m. Shape (23,
    I, F).
    """
    limit: str
    """Reason why intervals that miss the goal got no further node; empty where all meet it."""


@dataclass(frozen=True)
class ValidationAlignments:
    """An axis of a table compared with solutions between its nodes.

    On the other axis of alignments they are solved at the node nearest to zero. A longer period is assessed
    in its first pitch, at some of its positions and loads.
    """

    axis: str
    """"misalignment" or "center_distance_change"."""
    goal_of: GoalOf | None
    """Nodes are inserted until their intervals meet the goal of the table."""

    def errors(self, solved_table: SolvedTable) -> AlignmentErrors:
        """Measure the error of every interval of a table; with a goal insert nodes until it is met."""
        truths: dict[float, FloatArray] = {}
        limit = ""
        for left in range(MAX_HALVINGS, -1, -1):
            further = self._further(solved_table, truths)
            if not further.size:
                break
            if not left:
                limit = halvings_reached(MAX_HALVINGS)
                break
            more = with_inserted_nodes(solved_table, self.axis, further)
            if more is None:
                limit = "a point between them has no solution"
                break
            solved_table = more
        self._solve(solved_table, self._missing(solved_table, truths, self._last_probes), truths)
        error, change = self._spread(solved_table, *self._errors(solved_table, truths))
        return AlignmentErrors(solved_table, error, change, limit)

    @property
    def _last_probes(self) -> tuple[float, ...]:
        """Return the held-out alignments of a finished axis; each center distance needs a compliance."""
        return MIDDLE if self.goal_of is None and self.axis == CENTER_DISTANCE else QUARTERS

    def _further(self, solved_table: SolvedTable, truths: dict[float, FloatArray]) -> FloatArray:
        """Return the middles of intervals that miss the goal; solve the held-out points that measure it."""
        if self.goal_of is None:
            return np.empty(0)
        nodes = getattr(solved_table.table, self.axis)
        middles = nodes[:-1] + MIDDLE[0] * np.diff(nodes)
        self._solve(solved_table, self._missing(solved_table, truths, MIDDLE), truths)
        beyond = self._beyond(solved_table, truths)
        if not beyond.all():
            self._solve(solved_table, self._missing(solved_table, truths, QUARTERS, ~beyond), truths)
            beyond = self._beyond(solved_table, truths)
        return np.asarray(middles[beyond])

    def _beyond(self, solved_table: SolvedTable, truths: Mapping[float, FloatArray]) -> BoolArray:
        """Return the intervals (I,) of an axis that miss the goal; those without a solution do not count."""
        assert self.goal_of is not None
        _, change = self._spread(solved_table, *self._errors(solved_table, truths))
        goal = self.goal_of(solved_table.table)
        # of (2, F, M, D), which has quantities in the place of positions
        allowed = np.moveaxis(allowed_errors(solved_table.table, goal.tolerance), GRID.index(self.axis), 1)
        minimum = np.minimum(allowed[:, 1:], allowed[:, :-1])  # (2, I, F, others)
        share = (change[[MEAN, PEAK_TO_PEAK]][..., None] / minimum).max(axis=(0, 2, 3))
        return np.asarray(share > goal.shares(self.axis))

    def _missing(
        self,
        solved_table: SolvedTable,
        truths: Mapping[float, FloatArray],
        probes: tuple[float, ...],
        of: BoolArray | None = None,
    ) -> FloatArray:
        """Return the held-out alignments of intervals of an axis that are not solved yet."""
        nodes = getattr(solved_table.table, self.axis)
        known = np.array([*truths, *nodes])
        chosen = np.ones(nodes.size - 1, bool) if of is None else of
        probed = [
            low + part * (high - low)
            for (low, high), wished in zip(pairwise(nodes.tolist()), chosen, strict=True)
            if wished
            for part in probes
        ]
        near = 1e-9 * np.diff(nodes).min()
        return np.array([at for at in probed if not np.any(np.abs(known - at) <= near)])

    def _solve(self, solved_table: SolvedTable, at: FloatArray, truths: dict[float, FloatArray]) -> None:
        """Solve held-out alignments, (R, l) in m each; NaN where a solution did not converge."""
        if not at.size:
            return
        rows, loads = self._sample(solved_table)
        table = solved_table.table
        other = np.array([self._other_node(table)])
        points = alignment_points(solved_table, {self.axis: at, self._other: other})
        starts = None
        position = solved_table.nodes.position
        if self.axis == MISALIGNMENT:  # all of one center distance, of which the table has the compliance
            first = points.places[0]
            take_compliance(solved_table, first)
            first.contact.keep_rows(first.model, position, rows)
            starts = [self._start(solved_table, rows, loads, skew) for skew in at.tolist()]
        where = [position[rows]] * at.size
        load = table.force[loads]
        solved = deflected_operating_points(points.places, where, load, None, points.workers, starts=starts)
        truths.update(zip(at.tolist(), (curves[..., 0] for curves in solved), strict=True))

    def _start(self, solved_table: SolvedTable, rows: IntArray, loads: IntArray, at: float) -> Start:
        """Return the start of a misalignment between the solutions at its neighbor nodes."""
        table = solved_table.table
        nodes, changes = table.misalignment, table.center_distance_change
        above = int(np.searchsorted(nodes, at))
        part = (at - nodes[above - 1]) / (nodes[above] - nodes[above - 1])
        nearest = int(np.argmin(np.abs(changes)))
        lower, upper = (solved_table.solved[m * changes.size + nearest] for m in (above - 1, above))
        first, second = (solution.force[np.ix_(rows, loads)] for _, solution in (lower, upper))
        return Start(lower[0].candidates, first + part * (second - first))

    def _errors(
        self, solved_table: SolvedTable, truths: Mapping[float, FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Largest differences (I, l) in every interval and changes of the quantities (23, I, l), m."""
        rows, loads = self._sample(solved_table)
        table, position = first_pitch(solved_table.table), solved_table.nodes.position[rows]
        at = np.array(sorted(truths))
        other = self._other_node(table)
        alignment = (at[:, None], other) if self.axis == MISALIGNMENT else (other, at[:, None])
        curves = table.ste(position[:, None, None], table.force[loads], *alignment)  # (R, probes, l)
        truth = np.stack([truths[x] for x in at.tolist()], axis=1)
        error = AWAY * np.abs(curves - truth).max(axis=0)
        flat = curves.reshape(len(curves), -1), truth.reshape(len(truth), -1)
        change = AWAY * quantity_changes(position, *flat, 1).reshape(-1, *truth.shape[1:])
        # one pitch has no orders beside the mesh: they count as the harmonic that changes most
        change[OFF_MESH] = change[FIRST_HARMONIC:].max(axis=0)
        nodes = getattr(table, self.axis)
        inside = [(at > low) & (at < high) for low, high in pairwise(nodes.tolist())]
        return (
            np.stack([error[members].max(axis=0) for members in inside]),
            np.stack([change[:, members].max(axis=1) for members in inside], axis=1),
        )

    def _spread(
        self, solved_table: SolvedTable, error: FloatArray, change: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Carry errors (I, l) and changes (23, I, l) on to all loads of a table."""
        force, (_, loads) = solved_table.table.force, self._sample(solved_table)
        return spread(force, loads, error, 1), spread(force, loads, change, 2)

    @property
    def _other(self) -> str:
        """The other axis of alignments."""
        return MISALIGNMENT if self.axis == CENTER_DISTANCE else CENTER_DISTANCE

    def _other_node(self, table: SteDatabase) -> float:
        """Return the node of the other axis that is nearest to zero."""
        return float(min(getattr(table, self._other).tolist(), key=abs))

    def _sample(self, solved_table: SolvedTable) -> tuple[IntArray, IntArray]:
        """Return the positions of a pitch and the loads that are solved."""
        rows = sampled_positions(solved_table.nodes.position.size)
        return rows, sample_of(solved_table.table.force.size, LOADS)


def first_pitch(table: SteDatabase) -> SteDatabase:
    """Return the first base pitch of a longer period: interpolation at its positions needs no other pitch."""
    if table.period == 1:
        return table
    rows = int(np.searchsorted(table.position, 1.0))
    arrays = {
        name: getattr(table, name)[:rows]
        for name, dimensions in table.stored.items()
        if dimensions[0] == "position"
    }
    return replace(table, **arrays, period=1)
