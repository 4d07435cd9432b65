"""Errors of a table, by source.

The finite-element error comes from a second, coarser discretization solved at the same points; with
quadratic elements and Galerkin patches the error falls at least with the square of the element size, which
bounds what is left of the difference (`Discretization.remaining`). The table's error is measured at the
middles between its nodes. Where the plane stands in for three dimensions, a part of what it was corrected by
is its error; it is measured against three-dimensional solutions (docs/effects/finite_width.md). A plane that
is not corrected, requested by name or not, errs by what it leaves out of the finite width.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.estimates.position_errors import PositionErrors
from fe_contact.analysis.pairs.pair_contact import OperatingPoint, OperatingPoints
from fe_contact.analysis.pairs.solved_operating_points import deflected_operating_points
from fe_contact.contact import Candidates, ContactSolution
from fe_contact.planning.model_error import point_error
from fe_contact.planning.plan import Plan
from fe_contact.planning.planned import LEFT_OUT, left_out
from fe_contact.sampled import ALIGNMENTS, LOADS, sample_of, some_positions, spread, spread_around
from fe_contact.types import FloatArray, IntArray, Json, Status

# A table solved again at some of its points, on the rougher discretizations that measure its errors.
#
# Bodies, slices and corrections change; where teeth touch does not, so that the candidates of the run serve
# again unless the slices are others.

Axes = tuple[FloatArray, FloatArray, FloatArray]
"""Loads in N, misalignments and changes of the center distance in m of a table."""


@dataclass(frozen=True)
class TableSample:
    """Points of a table (P positions of each of T pitches, F, M, D) that are solved again.

    Attributes
    ----------
    position : ndarray, shape (P,)
        Of the table, in the first base pitch.
    period : int
        Base pitches T.
    axes : tuple of ndarray
        Loads, misalignments, changes of the center distance.
    rows : ndarray of int, shape (R,)
        Positions that are solved.
    nodes : tuple of ndarray of int
        Loads (f), misalignments (m) and changes of the center distance (d) that are.
    """

    position: FloatArray
    period: int
    axes: Axes
    rows: IntArray
    nodes: tuple[IntArray, IntArray, IntArray]

    @classmethod
    def of(cls, position: FloatArray, period: int, axes: Axes) -> TableSample:
        """Take at least 32 positions, four loads and three alignments of each axis, as far as there are."""
        load, skew, change = axes
        most = (
            sample_of(load.size, LOADS),
            sample_of(skew.size, ALIGNMENTS),
            sample_of(change.size, ALIGNMENTS),
        )
        return cls(position, period, axes, some_positions(position.size), most)

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
        """Their rows among those of the table, (T R,)."""
        return (np.arange(self.period)[:, None] * self.position.size + self.rows).ravel()

    def shaped(self, by_place: Sequence[FloatArray]) -> FloatArray:
        """Stack arrays (..., f) of the places solved into (..., f, m, d)."""
        stacked = np.stack(by_place, axis=-1)
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

    def taken(self, solutions: Sequence[ContactSolution]) -> FloatArray:
        """Return the STE of the table's own solutions at the points, (T R, f, m, d) in m."""
        loads = self.nodes[0]
        curves = [solutions[k].deflection[np.ix_(self.every_row, loads)] for k in self.places]
        return self.shaped(curves)

    def solved(self, points: OperatingPoints, known: OperatingPoints) -> FloatArray:
        """Solve the points on other places, (T R, f, m, d) in m; `known` are those of the table."""
        pitches, load = np.arange(self.period), self.axes[0][self.nodes[0]]
        chosen = [points.places[k] for k in self.places]
        where = [self.position[self.rows]] * len(chosen)
        candidates = self._candidates(chosen[0], [known.places[k] for k in self.places])
        return self.shaped(
            deflected_operating_points(chosen, where, load, pitches, points.workers, candidates)
        )

    def _candidates(self, point: OperatingPoint, known: Sequence[OperatingPoint]) -> list[Candidates] | None:
        """Return those of the table's places, which do not depend on the bodies.

        None in other slices and under other load patches, which have candidates of their own.
        """
        plans = point.contact.plan, known[0].contact.plan
        first, second = ((plan.discretization.slices, plan.patch) for plan in plans)
        if first != second:
            return None
        return [own.contact.candidates(own.model, self.position).rows(self.rows) for own in known]


CORRECTION_ERROR = 0.03
"""Error of the correction for a finite width in parts of the correction itself. The largest seen of mean,
peak-to-peak and harmonics on its pairs (docs/accuracy.md, "Constants") is 0.033, of peak-to-peak at a face of
1.2 modules, of which the mesh covers its part."""


@dataclass(frozen=True)
class _ErrorSources:
    """Error of STE in m by source; arrays (P, F, M, D).

    Attributes
    ----------
    discretization, slices, interpolation, contact, finite_width, model : ndarray
        Finite elements, slices of the face, table beside the node, contact, the plane for a finite width, and
        what the method leaves out.
    left_out : float
        Relative part of the mean STE that an uncorrected plane leaves out; it is part of `finite_width`.
    """

    discretization: FloatArray
    slices: FloatArray
    interpolation: FloatArray
    contact: FloatArray
    finite_width: FloatArray
    model: FloatArray
    left_out: float

    @property
    def total(self) -> FloatArray:
        """Sum of the sources at each point, m."""
        parts = self.discretization, self.slices, self.interpolation, self.contact, self.finite_width
        return np.asarray(sum(parts) + self.model)

    def to_json(self) -> Json:
        """Return the largest of each source by load, m, and the part that the plane leaves out.

        Beside a failed point errors are unknown and left out; None where that leaves none.
        """
        sources = {
            "discretisation_m": self.discretization,
            "slices_m": self.slices,
            "table_interpolation_m": self.interpolation,
            "contact_solver_m": self.contact,
            "finite_width_m": self.finite_width,
            "model_m": self.model,
        }
        worst = {name: _largest_known(values) for name, values in sources.items()}
        return worst | {"plane_for_finite_width_relative": self.left_out}


def _largest_known(errors: FloatArray) -> list[float | None]:
    """Return the largest number of errors (P, F, M, D) at each load; None if there is none."""
    worst = np.where(np.isnan(errors), -np.inf, errors).max(axis=(0, 2, 3))
    return [float(value) if np.isfinite(value) else None for value in worst]


@dataclass(frozen=True)
class Nested:
    """STE at some points of a table, from the run's own and rougher discretizations.

    Attributes
    ----------
    sample : TableSample
        The points.
    table : ndarray, shape (T R, f, m, d)
        The table's own, m.
    plane : ndarray
        Without the correction for a finite width; `table` if there is none.
    coarse : ndarray
        On the coarse meshes, without that correction.
    sliced : ndarray
        In half the slices; `table` in the plane.
    """

    sample: TableSample
    table: FloatArray
    plane: FloatArray
    coarse: FloatArray
    sliced: FloatArray


def estimate_errors(
    points: OperatingPoints,
    solutions: list[ContactSolution],
    nested: Nested,
    positions: PositionErrors,
    plan: Plan,
) -> _ErrorSources:
    """Combine the measured differences.

    Parameters
    ----------
    points : OperatingPoints
    solutions : list of ContactSolution
        The table's.
    nested : Nested
    positions : PositionErrors
        The largest of the assessed operating points stand for every place.
    plan : Plan
    """
    made, pair = plan.discretization, points.places[0].contact.pair
    missing = left_out(pair, made)

    def left(these: FloatArray, those: FloatArray, part: float) -> FloatArray:
        """Return a part of the differences of STE, at all points."""
        return nested.sample.spread_points(part * np.nan_to_num(np.abs(these - those)))

    free_ends = left(nested.table, nested.plane, CORRECTION_ERROR)
    if missing:
        curves = [LEFT_OUT * missing * np.nan_to_num(np.abs(solution.deflection)) for solution in solutions]
        free_ends = points.gathered(curves)
    return _ErrorSources(
        left(nested.plane, nested.coarse, made.remaining),
        left(nested.table, nested.sliced, made.remaining_slices),
        np.broadcast_to(positions.band[:, :, None, None], (*positions.band.shape, *points.shape)),
        points.gathered([contact_error(solution) for solution in solutions]),
        free_ends,
        points.gathered([_left_by_model(solution, points, plan) for solution in solutions]),
        missing,
    )


def _left_by_model(solution: ContactSolution, points: OperatingPoints, plan: Plan) -> FloatArray:
    """Return what the method leaves out at points (P, F), m."""
    return point_error(points.nominal.pair, plan.load, np.nan_to_num(solution.deflection))


def contact_error(solution: ContactSolution) -> FloatArray:
    """Return the contact solver's error (P, F): its largest relative residual times the STE, m."""
    worst = np.nan_to_num(solution.residuals.max(axis=2), posinf=0.0)
    return np.asarray(np.nan_to_num(np.abs(solution.deflection)) * worst)


def worst_residual(solution: ContactSolution) -> float:
    """Return the largest of the four residuals over all converged points."""
    good = solution.status == Status.CONVERGED
    return float(solution.residuals[good].max()) if good.any() else 0.0
