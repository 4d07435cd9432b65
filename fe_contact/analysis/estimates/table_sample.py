"""A table solved again at some of its points, on the rougher discretizations that measure its errors.

Axes of a table, in upper case, and of its sample, in lower case: positions P of each of T base pitches (R of
them in the sample), loads F (f), misalignments M (m), changes of the center distance D (d).
"""

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
    """The points of a table (T P, F, M, D) that are solved again."""

    position: FloatArray
    """Positions of the table in the first base pitch. Shape (P,)."""
    period: int
    """Number T of base pitches."""
    axes: Axes
    """Loads, misalignments, changes of the center distance."""
    rows: IntArray
    """Indices of the positions that are solved again. Shape (R,)."""
    nodes: tuple[IntArray, IntArray, IntArray]
    """Indices of the loads (f,), misalignments (m,) and center distances (d,) that are solved again."""

    @classmethod
    def of(cls, position: FloatArray, period: int, axes: Axes) -> TableSample:
        """Return a sample of at least 32 positions and at most `LOADS` loads and `ALIGNMENTS` alignments."""
        load, skew, change = (axis.size for axis in axes)
        nodes = sample_of(load, LOADS), sample_of(skew, ALIGNMENTS), sample_of(change, ALIGNMENTS)
        return cls(position, period, axes, sampled_positions(position.size), nodes)

    @property
    def places(self) -> list[int]:
        """Indices of the alignments that are solved, among all (M D) with the center distance fastest."""
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
        """Stack arrays (..., f), one for each of the `places`, into (..., f, m, d)."""
        stacked = np.stack(by_point, axis=-1)
        return stacked.reshape(*stacked.shape[:-1], self.nodes[1].size, self.nodes[2].size)

    def spread(self, values: FloatArray) -> FloatArray:
        """Interpolate values (..., f, m, d) linearly to all loads and alignments, (..., F, M, D)."""
        for axis, (knots, sample) in enumerate(zip(self.axes, self.nodes, strict=True), start=-3):
            values = spread(knots, sample, values, axis)
        return values

    def spread_points(self, values: FloatArray) -> FloatArray:
        """Interpolate values (T R, f, m, d) linearly to all points of the table, (T P, F, M, D)."""
        knots = (np.arange(self.period)[:, None] + self.position).ravel()
        return spread_around(knots, self.period, self.every_row, self.spread(values))

    def taken(self, table: SteDatabase) -> FloatArray:
        """Return STE and load arm of `table` at the points of the sample, (2, T R, f, m, d) in m."""
        curves = np.stack([table.static_transmission_error, table.load_arm])
        return np.asarray(curves[np.ix_(np.arange(2), self.every_row, *self.nodes)])

    def solved(
        self, points: OperatingPoints, known: OperatingPoints, starts: Sequence[Start] | None = None
    ) -> FloatArray:
        """Solve the sample on other operating points; return STE and load arm, (2, T R, f, m, d) in m.

        `known` are operating points that the table or the sample was solved on. `starts` has forces near the
        solution for each of the `places`; only a table of one pitch has any.
        """
        chosen = [points.places[k] for k in self.places]
        curves = deflected_operating_points(
            chosen,
            position=[self.position[self.rows]] * len(chosen),
            load=self.axes[0][self.nodes[0]],
            pitches=np.arange(self.period),
            workers=points.workers,
            candidates=self._candidates(chosen[0], [known.places[k] for k in self.places]),
            starts=starts,
        )
        return self.shaped([np.moveaxis(curve, -1, 0) for curve in curves])

    def start(self, problem: ContactProblem, solution: ContactSolution) -> Start | None:
        """Return the forces at one alignment of the table as a start; None where the pitches differ."""
        if self.period > 1:
            return None
        force = solution.force[np.ix_(self.rows, self.nodes[0])]
        return Start(problem.candidates, np.nan_to_num(force))

    def _candidates(self, point: OperatingPoint, points: Sequence[OperatingPoint]) -> list[Candidates] | None:
        """Return the contact candidates of the sample as `points` keep them: bodies do not change them.

        None where `point` has other slices or load patches than `points`, and so other candidates, or where
        these are not kept.
        """
        plan, known_plan = point.contact.plan, points[0].contact.plan
        if plan.discretization.slices != known_plan.discretization.slices or plan.patch != known_plan.patch:
            return None
        kept = [self._kept_candidates(known) for known in points]
        complete = [candidates for candidates in kept if candidates is not None]
        return complete if len(complete) == len(kept) else None

    def _kept_candidates(self, point: OperatingPoint) -> Candidates | None:
        """Return the candidates of the sample from a problem at its positions, or at all of the table."""
        at_rows = point.contact.cached_problem(point.model, self.position[self.rows])
        if at_rows is not None:
            return at_rows.candidates
        everywhere = point.contact.cached_problem(point.model, self.position)
        return None if everywhere is None else everywhere.candidates.rows(self.rows)


@dataclass(frozen=True)
class Nested:
    """STE and load arm at some points of a table, on the discretization of the run and on rougher ones.

    Each array has the shape (2, T R, f, m, d): STE first, then the load arm.
    """

    sample: TableSample
    """The sampled points."""
    table: FloatArray
    """Values of the table itself, m."""
    plane: FloatArray
    """Values without the correction for the finite face width, m; `table` itself if there is none."""
    patched: FloatArray
    """Values under the wider load patches of the coarse meshes, without the correction, m."""
    coarse: FloatArray
    """Values under the wider load patches on the coarse meshes, without the correction, m."""
    sliced: FloatArray
    """Values with half the number of slices, m; `table` itself in a plane model, which has no slices."""

    @property
    def parts(self) -> tuple[Nested, Nested]:
        """The values of STE and of load arm, each with arrays (T R, f, m, d)."""
        # (2, 5, T R, f, m, d): the five arrays of each quantity in the order of the fields
        fields = np.stack([self.table, self.plane, self.patched, self.coarse, self.sliced], axis=1)
        return Nested(self.sample, *fields[0]), Nested(self.sample, *fields[1])
