"""Interpolation error between the alignments of a table, and the alignments that bring it down.

A held-out alignment is solved at some positions and loads. Where the table misses it by more than a goal
allows, the middle of the interval becomes a node, and both halves are measured again.

Axis letters: I intervals between the nodes of the axis, F loads of the table, l loads that are solved, R
positions that are solved, M misalignments, D changes of the center distance; 23 quantities of a curve
(`curve_quantities`). A probe is the place of a held-out alignment in its interval, as a fraction.
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
from fe_contact.analysis.estimates.interval_halving import curve_differences, halved
from fe_contact.analysis.estimates.tolerance_shares import allowed_errors
from fe_contact.analysis.estimates.validation_loads import AWAY
from fe_contact.analysis.pairs.contact_lines import deflected_operating_points
from fe_contact.analysis.tables import SolvedTable
from fe_contact.contact import Start
from fe_contact.sampled import LOADS, sample_of, sampled_positions, spread
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_quantities import MEAN, PEAK_TO_PEAK
from fe_contact.ste.fields import CENTER_DISTANCE, GRID, MISALIGNMENT
from fe_contact.types import BoolArray, FloatArray, IntArray

MIDDLE = (0.5,)
QUARTERS = (0.25, 0.5, 0.75)
"""`MIDDLE`, `QUARTERS`: Probes of an interval. Between three nodes or more the error of a cubic may vanish in
the middle. With a goal, the quarters are solved once the middle meets it.
"""
MAX_HALVINGS = 5
"""Halvings of an interval of requested alignments: 20 um become intervals of 0.6 um."""
ROUNDING = 1e-9
"""Difference of two alignments over the shortest interval, below which they are the same."""


@dataclass(frozen=True)
class AlignmentErrors:
    """Error between the nodes of an axis of alignments."""

    solved_table: SolvedTable
    """Solved table with the inserted alignments."""
    error: FloatArray
    """Largest difference of interpolant and solution in the interval after each node, m. Shape (I, F)."""
    change: FloatArray
    """Change of mean, peak-to-peak and harmonics at the held-out alignment, m. Shape (23, I, F)."""
    limit: str
    """Reason why intervals that miss the goal got no further node; empty where all meet it."""


@dataclass(frozen=True)
class ValidationAlignments:
    """An axis of a table compared with solutions between its nodes.

    The alignments between the nodes are solved at that node of the other axis of alignments that is nearest
    to zero. A longer period is assessed in its first pitch, at some of its positions and loads. `truths` are
    the solutions (R, l), m, by their place on the axis; NaN where a solution did not converge.
    """

    axis: str
    """"misalignment" or "center_distance_change"."""
    goal_of: GoalOf | None
    """Function from the table to the goal that its intervals must meet; None: no nodes are inserted."""

    def errors(self, solved_table: SolvedTable) -> AlignmentErrors:
        """Measure the error of every interval of a table; with a goal insert nodes until it is met."""
        truths: dict[float, FloatArray] = {}
        solved_table, limit = halved(
            solved_table,
            lambda table: self._middles_beyond(table, truths),
            lambda table, middles: with_inserted_nodes(table, self.axis, middles),
            MAX_HALVINGS,
            "a point between them has no solution",
        )
        self._solve(solved_table, self._missing(solved_table, truths, self._last_probes), truths)
        error, change = self._spread(solved_table, *self._errors(solved_table, truths))
        return AlignmentErrors(solved_table, error, change, limit)

    @property
    def _last_probes(self) -> tuple[float, ...]:
        """The probes that measure the errors of the finished axis.

        The middle alone measures a center distance without a goal, since each one needs a compliance.
        """
        return MIDDLE if self.goal_of is None and self.axis == CENTER_DISTANCE else QUARTERS

    def _middles_beyond(self, solved_table: SolvedTable, truths: dict[float, FloatArray]) -> FloatArray:
        """Return the middles of intervals that miss the goal, and add solutions that measure this."""
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
        # from (2 quantities, F, M, D) to (2, nodes of the axis, F, nodes of the other axis)
        allowed = np.moveaxis(allowed_errors(solved_table.table, goal.tolerance), GRID.index(self.axis), 1)
        minimum = np.minimum(allowed[:, 1:], allowed[:, :-1])  # (2, I, F, others)
        share = (change[[MEAN, PEAK_TO_PEAK]][..., None] / minimum).max(axis=(0, 2, 3))
        return np.asarray(share > goal.shares(self.axis))

    def _missing(
        self,
        solved_table: SolvedTable,
        truths: Mapping[float, FloatArray],
        probes: tuple[float, ...],
        intervals: BoolArray | None = None,
    ) -> FloatArray:
        """Return the held-out alignments, m, not solved yet, of all or of the marked `intervals` (I,)."""
        nodes = getattr(solved_table.table, self.axis)
        known = np.array([*truths, *nodes])
        marked = np.ones(nodes.size - 1, bool) if intervals is None else intervals
        low, width = nodes[:-1][marked, None], np.diff(nodes)[marked, None]
        alignments = (low + np.array(probes) * width).ravel().tolist()
        near = ROUNDING * np.diff(nodes).min()
        return np.array([value for value in alignments if not np.any(np.abs(known - value) <= near)])

    def _solve(
        self, solved_table: SolvedTable, alignments: FloatArray, truths: dict[float, FloatArray]
    ) -> None:
        """Solve held-out alignments, m, and add the solutions to `truths`."""
        if not alignments.size:
            return
        rows, loads = self._sample(solved_table)
        table = solved_table.table
        other = np.array([self._other_node(table)])
        points = alignment_points(solved_table, {self.axis: alignments, self._other: other})
        starts = None
        position = solved_table.nodes.position
        if self.axis == MISALIGNMENT:  # of one center distance, whose compliance the table has
            first = points.places[0]
            take_compliance(solved_table, first)
            first.contact.keep_rows(first.model, position, rows)
            starts = [self._start(solved_table, rows, loads, value) for value in alignments.tolist()]
        positions, load = [position[rows]] * alignments.size, table.force[loads]
        solved = deflected_operating_points(
            points.places, positions, load, None, points.workers, starts=starts
        )
        for alignment, curves in zip(alignments.tolist(), solved, strict=True):
            truths[alignment] = curves[..., 0]  # the transmission error

    def _start(
        self, solved_table: SolvedTable, rows: IntArray, loads: IntArray, misalignment: float
    ) -> Start:
        """Return forces to start from at a misalignment, interpolated between its neighbor nodes."""
        table = solved_table.table
        nodes, changes = table.misalignment, table.center_distance_change
        above = int(np.searchsorted(nodes, misalignment))
        part = (misalignment - nodes[above - 1]) / (nodes[above] - nodes[above - 1])
        nearest = int(np.argmin(np.abs(changes)))
        # solutions stand by misalignment, then by center distance
        problem, lower = solved_table.solved[(above - 1) * changes.size + nearest]
        _, upper = solved_table.solved[above * changes.size + nearest]
        first, second = lower.force[np.ix_(rows, loads)], upper.force[np.ix_(rows, loads)]
        return Start(problem.candidates, first + part * (second - first))

    def _errors(
        self, solved_table: SolvedTable, truths: Mapping[float, FloatArray]
    ) -> tuple[FloatArray, FloatArray]:
        """Return the largest differences (I, l) in intervals, and changes of the quantities (23, I, l), m.

        Differences are those of the table from the solutions `truths`, times `AWAY`.
        """
        rows, loads = self._sample(solved_table)
        table, position = first_pitch(solved_table.table), solved_table.nodes.position[rows]
        probes = np.array(sorted(truths))
        other = self._other_node(table)
        alignment = (probes[:, None], other) if self.axis == MISALIGNMENT else (other, probes[:, None])
        curves = table.ste(position[:, None, None], table.force[loads], *alignment)  # (R, probes, l)
        truth = np.stack([truths[value] for value in probes.tolist()], axis=1)
        error, change = (AWAY * difference for difference in curve_differences(position, curves, truth))
        nodes = getattr(table, self.axis)
        inside = [(probes > low) & (probes < high) for low, high in pairwise(nodes.tolist())]
        return (
            np.stack([error[members].max(axis=0) for members in inside]),
            np.stack([change[:, members].max(axis=1) for members in inside], axis=1),
        )

    def _spread(
        self, solved_table: SolvedTable, error: FloatArray, change: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Interpolate errors (I, l) and changes (23, I, l) to all loads of a table, (I, F) and (23, I, F)."""
        _, loads = self._sample(solved_table)
        force = solved_table.table.force
        return spread(force, loads, error, 1), spread(force, loads, change, 2)

    @property
    def _other(self) -> str:
        """The other axis of alignments."""
        return MISALIGNMENT if self.axis == CENTER_DISTANCE else CENTER_DISTANCE

    def _other_node(self, table: SteDatabase) -> float:
        """Return the node of the other axis that is nearest to zero."""
        return float(min(getattr(table, self._other).tolist(), key=abs))

    def _sample(self, solved_table: SolvedTable) -> tuple[IntArray, IntArray]:
        """Return the indices of the positions (R,) and of the loads (l,) that are solved."""
        rows = sampled_positions(solved_table.nodes.position.size)
        return rows, sample_of(solved_table.table.force.size, LOADS)


def first_pitch(table: SteDatabase) -> SteDatabase:
    """Return a table of a longer period as one of its first base pitch, to interpolate at its positions."""
    if table.period == 1:
        return table
    rows = int(np.searchsorted(table.position, 1.0))
    arrays = {
        name: getattr(table, name)[:rows]
        for name, dimensions in table.stored.items()
        if dimensions[0] == "position"
    }
    return replace(table, **arrays, period=1)
