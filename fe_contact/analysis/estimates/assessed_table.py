"""Everything that is known of the errors of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.estimates.held_out_axes import AxisError, held_out_axes
from fe_contact.analysis.estimates.position_errors import PositionErrors, position_errors
from fe_contact.analysis.pairs.contact_lines import Solved, deflected_operating_points
from fe_contact.analysis.pairs.pair_contact import OperatingPoint, OperatingPoints
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.tables import PositionNodes
from fe_contact.contact import Candidates, ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.model_error import model_errors, point_error
from fe_contact.planning.plan import FaceDiscretization, Plan
from fe_contact.planning.plane_bias import LEFT_OUT, PlaneBias
from fe_contact.sampled import ALIGNMENTS, LOADS, sample_of, some_positions, spread, spread_around
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve import AT_NODES, BETWEEN_NODES, METHOD, PLANE, SOURCES
from fe_contact.ste.curve_quantities import (
    BY_SOURCE,
    FIRST_HARMONIC,
    PEAK_TO_PEAK,
    QUANTITIES,
    error_bound,
    mean_of_curves,
    quantity_changes,
)
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


# Errors of a table, by source.
#
# The finite-element error comes from a second, coarser discretization solved at the same points; with
# quadratic elements and Galerkin patches the error falls at least with the square of the element size,
# which bounds what is left of the difference (`Discretization.remaining`). The table's error is measured
# at the middles between its nodes. Where the plane stands in for three dimensions, a part of what it was
# corrected by is its error; it is measured against three-dimensional solutions
# (docs/effects.md#finite_width). A plane that is not corrected, requested by name or not, errs by what it
# leaves out of the finite width.

CORRECTION_ERROR = 0.03
"""Error of the correction for a finite width in parts of the correction itself. The largest seen of mean,
peak-to-peak and harmonics on its pairs (docs/lab/accuracy.md, "Constants") is 0.033, of peak-to-peak at a
face of 1.2 modules, of which the mesh covers its part."""


@dataclass(frozen=True)
class _ErrorSources:
    """Error of STE in m by source; arrays (P, F, M, D).

    Attributes
    ----------
    discretization, slices, interpolation, contact, plane, method : ndarray
        Finite elements, slices of the face, table beside the node, contact, the plane for a finite width, and
        what the method leaves out.
    left_out : float
        Relative part of the mean STE that an uncorrected plane leaves out; it is part of `plane`.
    """

    discretization: FloatArray
    slices: FloatArray
    interpolation: FloatArray
    contact: FloatArray
    plane: FloatArray
    method: FloatArray
    left_out: float

    @property
    def total(self) -> FloatArray:
        """Sum of the sources at each point, m."""
        parts = self.discretization, self.slices, self.interpolation, self.contact, self.plane
        return np.asarray(sum(parts) + self.method)

    def to_json(self) -> Json:
        """Return the largest of each source by load, m, and the part that the plane leaves out.

        Beside a failed point errors are unknown and left out; None where that leaves none.
        """
        sources = {
            "discretisation_m": self.discretization,
            "slices_m": self.slices,
            "table_interpolation_m": self.interpolation,
            "contact_solver_m": self.contact,
            f"{PLANE}_m": self.plane,
            f"{METHOD}_m": self.method,
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
    patched : ndarray
        Under the wider load patches of the coarse meshes, without that correction.
    coarse : ndarray
        Under these on the coarse meshes.
    sliced : ndarray
        In half the slices; `table` in the plane.
    """

    sample: TableSample
    table: FloatArray
    plane: FloatArray
    patched: FloatArray
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
    solutions : list of ContactSolution
        The table's.
    positions : PositionErrors
        The largest of the assessed operating points stand for every place.
    """
    made, pair = plan.discretization, points.places[0].contact.pair
    bias, nominal = PlaneBias.of(pair, made), points.nominal.pair
    missing = abs(bias.mean) if bias else 0.0

    def left(these: FloatArray, those: FloatArray, part: float) -> FloatArray:
        """Return a part of the differences of STE, at all points."""
        return nested.sample.spread_points(part * np.nan_to_num(np.abs(these - those)))

    free_ends = left(nested.table, nested.plane, CORRECTION_ERROR)
    if missing:
        curves = [LEFT_OUT * missing * np.nan_to_num(np.abs(solution.deflection)) for solution in solutions]
        free_ends = points.gathered(curves)
    face, lags = isinstance(made, FaceDiscretization), [np.nan_to_num(each.deflection) for each in solutions]
    return _ErrorSources(
        left(nested.patched, nested.coarse, made.remaining)
        + left(nested.plane, nested.patched, plan.remaining_patches),
        left(nested.table, nested.sliced, made.remaining_slices),
        np.broadcast_to(positions.band[:, :, None, None], (*positions.band.shape, *points.shape)),
        points.gathered([_contact_error(solution) for solution in solutions]),
        free_ends,
        points.gathered([point_error(nominal, plan.load, lag, over_face=face) for lag in lags]),
        missing,
    )


def _contact_error(solution: ContactSolution) -> FloatArray:
    """Return the contact solver's error (P, F): its largest relative residual times the STE, m."""
    worst = np.nan_to_num(solution.residuals.max(axis=2), posinf=0.0)
    return np.asarray(np.nan_to_num(np.abs(solution.deflection)) * worst)


def worst_residual(solution: ContactSolution) -> float:
    """Return the largest of the four residuals over all converged points."""
    good = solution.status == Status.CONVERGED
    return float(solution.residuals[good].max()) if good.any() else 0.0


# Errors of mean, peak-to-peak and harmonics, by source.
#
# Each quantity is computed from nested discretizations, the run's own and a rougher one, and the change
# between the two is carried on to the error that is left by the order known, as the point bands are
# (`error_estimate`). Errors common to all positions so count in the mean alone, and what bends the curve in
# peak-to-peak and harmonics. Between the nodes of an axis the changes at held-out points count.

LEFT_BY_MESH = {
    "plane": {"draft": (0.20, 0.20, 0.22), "standard": (0.35, 0.45, 0.45)},
    "spur": {"draft": (0.8, 0.8, 2.9), "standard": (0.8, 0.8, 2.2)},
    "thin": {"draft": (1.4, 3.6, 2.9), "standard": (1.4, 1.4, 2.2)},
    "helical": {"draft": (1.1, 2.0, 2.0), "standard": (0.7, 1.3, 1.8)},
}
"""Error left of mean, peak-to-peak and harmonics over the change to the coarse mesh: in the plane, of
elements half as large; over the face of a spur pair of solid gears, what second order leaves of elements of
two thirds; of one with a thin rim, more; of a helical pair, over what second order leaves of that change
(`FaceDiscretization.remaining`). Coarse meshes are not in the range yet in which errors fall with a power of
the size: a draft in the plane leaves less of its change than a finer mesh, one over the face more. Set on the
pairs of docs/lab/accuracy.md ("Constants"); the level fine has the parts of standard."""
HARMONIC_SHARE = 0.3
"""Least change of harmonic k of a helical pair over that of peak-to-peak, times the root of k: half the
slices and coarse meshes err in other harmonics than the table, whose own may hardly change."""


def curve_errors(
    points: OperatingPoints,
    solutions: list[ContactSolution],
    nested: Nested,
    positions: PositionErrors,
    plan: Plan,
) -> FloatArray:
    """Return the errors at the nodes of the table, (6, 22, F, M, D) in m: sources `AT_NODES`.

    Parameters are those of `estimate_errors`. Errors of the discretization are those at the loads and
    alignments that were solved again, and interpolated between them.
    """
    made, sample, pair = plan.discretization, nested.sample, points.nominal.pair
    helical = isinstance(made, FaceDiscretization) and pair.base_helix_angle != 0.0
    # on the curve: half the slices may multiply a small ripple, and no part of that is what many change
    many_slices = nested.table + made.remaining_slices * (nested.table - nested.sliced)
    parts = 1.0, _left_by_mesh(pair, plan, helical), plan.remaining_patches, 1.0, CORRECTION_ERROR
    own, by_mesh, by_patches, by_slices, free_ends = _changes(
        sample,
        (nested.table, nested.patched, nested.plane, nested.table, nested.table),
        (np.zeros_like(nested.table), nested.coarse, nested.patched, many_slices, nested.plane),
        np.stack(np.broadcast_arrays(*parts)),
        helical,
    )
    if bias := PlaneBias.of(pair, made):
        free_ends = bias.errors(pair, own)
    by_source = {
        "discretisation": np.hypot(by_mesh, by_patches),
        "slices": by_slices,
        "contact_solver": _by_solver(points, solutions, sample),
        PLANE: free_ends,
        "position": np.broadcast_to(
            positions.curves[:, :, None, None], (*positions.curves.shape, *points.shape)
        ),
        METHOD: model_errors(pair, plan.load, own, over_face=isinstance(made, FaceDiscretization)),
    }
    return np.stack([by_source[name] for name in AT_NODES])


def _changes(
    sample: TableSample,
    these: Sequence[FloatArray],
    those: Sequence[FloatArray],
    parts: FloatArray,
    helical: bool,
) -> FloatArray:
    """Return parts (k, 22) of the changes of k sets of curves (T R, f, m, d), (k, 22, F, M, D) in m."""
    first, second = np.stack(these, axis=1), np.stack(those, axis=1)
    rows = sample.knots.size
    change = quantity_changes(sample.knots, first.reshape(rows, -1), second.reshape(rows, -1), sample.period)
    change = parts.T[:, :, None, None, None] * change.reshape(QUANTITIES, *first.shape[1:])
    return sample.spread(np.moveaxis(_shared(change) if helical else change, 1, 0))


def _by_solver(points: OperatingPoints, solutions: list[ContactSolution], sample: TableSample) -> FloatArray:
    """Errors (22, F, M, D) that the residuals of the contact can make."""
    knots = (np.arange(points.period)[:, None] + sample.position).ravel()
    return points.gathered(
        [
            error_bound(knots, _contact_error(solution), solution.deflection, points.period)
            for solution in solutions
        ]
    )


def _left_by_mesh(pair: ParallelAxes, plan: Plan, helical: bool) -> FloatArray:
    """Error left over the change to the coarse mesh, (22,)."""
    made = plan.discretization
    straight = "spur" if all(gear.web is None for gear in plan.bodies(pair)) else "thin"
    kind = ("helical" if helical else straight) if isinstance(made, FaceDiscretization) else "plane"
    mean, ripple, harmonics = LEFT_BY_MESH[kind]["draft" if plan.level == "draft" else "standard"]
    part = np.array([mean, ripple, *[harmonics] * (QUANTITIES - FIRST_HARMONIC)])
    return part * made.remaining if helical else part


def _shared(change: FloatArray) -> FloatArray:
    """Let every harmonic change (22, ...) by its share of peak-to-peak at least."""
    number = np.arange(1, QUANTITIES - FIRST_HARMONIC + 1).reshape(-1, *[1] * (change.ndim - 1))
    least = HARMONIC_SHARE * change[PEAK_TO_PEAK] / np.sqrt(number)
    return np.concatenate([change[:FIRST_HARMONIC], np.maximum(change[FIRST_HARMONIC:], least)])


def with_axes(at_nodes: FloatArray, axes: Mapping[str, AxisError]) -> FloatArray:
    """Append the interpolation along the axes: (9, 22, F, M, D).

    What was assessed at one alignment stands for all of them. An interval that was not assessed has NaN.
    """
    shape = at_nodes.shape[1:]
    between = []
    for i, name in enumerate(BETWEEN_NODES):
        errors = np.zeros(shape)
        intervals = np.moveaxis(errors, 1 + i, 1)[:, : shape[1 + i] - 1]  # a view
        intervals[...] = axes[name].change[..., None] if name in axes else np.nan
        between.append(errors)
    return np.concatenate([at_nodes, np.stack(between)])


def _summary(errors: FloatArray) -> Json:
    """Return the largest over the alignments of each source by load, m, and what was not estimated.

    A source is not estimated if it is unknown anywhere.
    """
    known = {name: source for name, source in zip(SOURCES, errors, strict=True) if not np.isnan(source).any()}
    largest = {
        name: {label: source[i].max(axis=(1, 2)).tolist() for label, i in BY_SOURCE.items()}
        for name, source in known.items()
    }
    return {"curve_error": largest, "not_estimated": [name for name in SOURCES if name not in known]}


@dataclass(frozen=True)
class AssessedTable:
    """Errors of a table.

    Attributes
    ----------
    band : ndarray, shape (P, F, M, D)
        Of every point, m; NaN where not estimated.
    curve_error : ndarray, shape (9, 22, F, M, D)
        Of mean, peak-to-peak and harmonics by source, m; NaN where not estimated.
    by_source, held_out : dict
        The largest by source; what was measured between the nodes of each axis.
    bias : PlaneBias, optional
        What the plane leaves out of a finite width where it is not corrected.
    """

    band: FloatArray
    curve_error: FloatArray
    by_source: Json
    held_out: Json
    bias: PlaneBias | None

    def to_json(self) -> Json:
        """Return what the receipt says of the errors."""
        sources = {"error_by_source": self.by_source, "held_out": self.held_out}
        bias = {"bias": self.bias.to_json()} if self.bias else {}
        return sources | bias | _summary(self.curve_error)


def assessed_table(
    table: SteDatabase,
    fine: OperatingPoints,
    coarse: OperatingPoints,
    solved: Solved,
    nodes: PositionNodes,
    checked: Checked,
    plan: Plan,
) -> AssessedTable:
    """Solve the table once more on each rougher discretization, and held-out points of its axes.

    Parameters
    ----------
    table : SteDatabase
        As solved on `fine`.
    fine, coarse : OperatingPoints
        On the meshes of the run and on the coarse ones.
    solved : list of (ContactProblem, ContactSolution)
        Of every place.
    """
    made, solutions = plan.discretization, [solution for _, solution in solved]
    axes = plan.load, table.misalignment, table.center_distance_change
    sample = TableSample.of(nodes.position, fine.period, axes)
    own = sample.taken(solutions)
    plane = sample.solved(fine.in_plane_strain, fine) if made.corrected else own
    sliced = sample.solved(fine.in_slices(made.coarse_slices), fine) if made.slices > 1 else own
    patched = sample.solved(fine.in_plane_strain.in_coarse_patches, fine)
    nested = Nested(sample, own, plane, patched, sample.solved(coarse, fine), sliced)
    positions = position_errors(nodes, fine, solutions, plan)
    measured = fine, solutions, nested, positions, plan
    sources, errors = estimate_errors(*measured), curve_errors(*measured)
    between = held_out_axes(table, fine, checked.request.scene, checked.decided, solved)
    held_out = {name: error.to_json() for name, error in between.items()}
    bias = plane_bias(table, fine, plan)
    return AssessedTable(sources.total, with_axes(errors, between), sources.to_json(), held_out, bias)


def unassessed_table(table: SteDatabase, points: OperatingPoints, plan: Plan) -> AssessedTable:
    """Return the errors of a table of which none was estimated, but for what is known in closed form."""
    bias = plane_bias(table, points, plan)
    left = {"plane_for_finite_width_relative": abs(bias.mean) if bias else 0.0}
    unknown = np.full(table.error_estimate.shape, np.nan)
    errors = np.full((len(SOURCES), QUANTITIES, plan.load.size, *points.shape), np.nan)
    return AssessedTable(unknown, errors, left, {}, bias)


def plane_bias(table: SteDatabase, points: OperatingPoints, plan: Plan) -> PlaneBias | None:
    """Return what the plane leaves out of the curves of a table."""
    pair, ste = points.nominal.pair, table.static_transmission_error
    bias = PlaneBias.of(pair, plan.discretization)
    own = np.stack([mean_of_curves(table.position, ste, table.period), np.ptp(ste, axis=0)])
    return bias and bias.of_curves(pair, own)
