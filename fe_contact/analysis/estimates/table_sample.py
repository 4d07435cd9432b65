"""A table solved again at some of its points, on the rougher discretizations that measure its errors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.pairs.contact_lines import deflected_operating_points
from fe_contact.analysis.pairs.operating_points import OperatingPoint, OperatingPoints
from fe_contact.contact import Candidates, ContactProblem, ContactSolution, Start
from fe_contact.sampled import ALIGNMENTS, LOADS, sample_of, sampled_positions, spread, spread_around
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, IntArray

Axes = tuple[FloatArray, FloatArray, FloatArray]
"""Loads in N, misalignments and changes of the center distance in m of a table."""


@dataclass(frozen=True)
class TableSample:
    """Points of a table (P positions of each of T pitches, F, M, D) that are solved again."""

    position: FloatArray
    """Positions of the table in the first base pitch. Shape (P,)."""
    period: int
    """Number T of base pitches."""
    axes: Axes
    """Loads, misalignments, changes of the center distance."""
    rows: IntArray
    """Positions that are solved. Shape (R,)."""
    nodes: tuple[IntArray, IntArray, IntArray]
    """Loads (f), misalignments (m) and changes of the center distance (d) that are."""

    @classmethod
    def of(cls, position: FloatArray, period: int, axes: Axes) -> TableSample:
        """Take at least 32 positions, four loads and three alignments of each axis, as far as there are."""
        load, skew, change = axes
        misaligned = (
            sample_of(load.size, LOADS),
            sample_of(skew.size, ALIGNMENTS),
            sample_of(change.size, ALIGNMENTS),
        )
        return cls(position, period, axes, sampled_positions(position.size), misaligned)

    @property
    def places(self) -> list[int]:
        """The places of the alignments that are solved, center distance running fastest."""
        _, skews, changes = self.nodes
        return [int(m) * self.axes[2].size + int(d) for m in skews for d in changes]

    @property
    def knots(self) -> FloatArray:
        """Positions of all pitches that are solved, (T R,)."""
        return (np.arange(self.period)[:, None] + self.position[self.rows]).ravel()

    @property
    def every_row(self) -> IntArray:
        """Indices of the solved positions of all pitches among the positions of the table, (T R,)."""
        return (np.arange(self.period)[:, None] * self.position.size + self.rows).ravel()

    def shaped(self, by_point: Sequence[FloatArray]) -> FloatArray:
        """Stack arrays (..., f) of the places solved into (..., f, m, d)."""
        stacked = np.stack(by_point, axis=-1)
        return stacked.reshape(*stacked.shape[:-1], self.nodes[1].size, self.nodes[2].size)

    def spread(self, values: FloatArray) -> FloatArray:
        """Carry values (..., f, m, d) on to all loads and alignments, (..., F, M, D)."""
        for axis, (knots, sample) in enumerate(zip(self.axes, self.nodes, strict=True), start=-3):
            values = spread(knots, sample, values, axis)
        return values

    def spread_points(self, values: FloatArray) -> FloatArray:
        """Carry values (T R, f, m, d) on to all points of the table, (T P, F, M, D)."""
        knots = (np.arange(self.period)[:, None] + self.position).ravel()
        return spread_around(knots, self.period, self.every_row, self.spread(values))

    def taken(self, table: SteDatabase) -> FloatArray:
        """Return the table's own STE and load arm at the points, (2, T R, f, m, d) in m."""
        curves = np.stack([table.static_transmission_error, table.load_arm])
        return np.asarray(curves[np.ix_(np.arange(2), self.every_row, *self.nodes)])

    def solved(
        self, points: OperatingPoints, known: OperatingPoints, starts: Sequence[Start] | None = None
    ) -> FloatArray:
        """Solve the points on other places, (2, T R, f, m, d) in m; `known` are those of the table.

        `starts` has forces near the solution for each of the `places`; of one pitch.
        """
        pitches, load = np.arange(self.period), self.axes[0][self.nodes[0]]
        chosen = [points.places[k] for k in self.places]
        where = [self.position[self.rows]] * len(chosen)
        candidates = self._candidates(chosen[0], [known.places[k] for k in self.places])
        curves = deflected_operating_points(chosen, where, load, pitches, points.workers, candidates, starts)
        return self.shaped([np.moveaxis(curve, -1, 0) for curve in curves])

    def start(self, problem: ContactProblem, solution: ContactSolution) -> Start | None:
        """Return the forces of one place of the table at the points; None where the pitches differ."""
        if self.period > 1:
            return None
        force = solution.force[np.ix_(self.rows, self.nodes[0])]
        return Start(problem.candidates, np.nan_to_num(force))

    def _candidates(self, point: OperatingPoint, known: Sequence[OperatingPoint]) -> list[Candidates] | None:
        """Return the contact candidates of the table's points, which do not depend on the bodies.

        None in other slices and under other load patches, which have candidates of their own.
        """
        plans = point.contact.plan, known[0].contact.plan
        first, second = ((plan.discretization.slices, plan.patch) for plan in plans)
        if first != second:
            return None
        return [point.contact.candidates(point.model, self.position).rows(self.rows) for point in known]


@dataclass(frozen=True)
class Nested:
    """STE and load arm at some points of a table, on the discretization of the run and on rougher ones."""

    sample: TableSample
    """The sampled points."""
    table: FloatArray
    """Values of the table itself, m. Shape (2, T R, f, m, d)."""
    plane: FloatArray
    """Values without the correction for a finite width, m; equal to `table` if there is no correction."""
    patched: FloatArray
    """Values under the wider load patches of the coarse meshes, without the correction, m."""
    coarse: FloatArray
    """Values under the wider load patches on the coarse meshes, without the correction, m."""
    sliced: FloatArray
    """Values with half the number of slices, m; equal to `table` in the plane."""

    @property
    def parts(self) -> tuple[Nested, Nested]:
        """The values of STE and of load arm, each with arrays (T R, f, m, d)."""
        every = np.stack([self.table, self.plane, self.patched, self.coarse, self.sliced], axis=1)
        return Nested(self.sample, *every[0]), Nested(self.sample, *every[1])
