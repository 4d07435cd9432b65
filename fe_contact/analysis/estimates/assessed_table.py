"""Everything that is known of the errors of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.estimates.error_estimate import (
    CORRECTION_ERROR,
    Nested,
    TableSample,
    contact_error,
    estimate_errors,
)
from fe_contact.analysis.estimates.held_out_axes import AxisError, held_out_axes
from fe_contact.analysis.estimates.position_errors import PositionErrors, position_errors
from fe_contact.analysis.pairs.pair_contact import OperatingPoints
from fe_contact.analysis.pairs.solved_operating_points import Solved
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.tables import PositionNodes
from fe_contact.contact import ContactSolution
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.model_error import model_errors, of_bending
from fe_contact.planning.plan import Plan
from fe_contact.planning.planned import LEFT_OUT, left_out
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES, BETWEEN_NODES, SOURCES
from fe_contact.ste.curve_quantities import (
    FIRST_HARMONIC,
    MEAN,
    PEAK_TO_PEAK,
    QUANTITIES,
    error_bound,
    quantity_changes,
)
from fe_contact.types import FloatArray, Json

# Errors of mean, peak-to-peak and harmonics, by source.
#
# Each quantity is computed from nested discretizations, the run's own and a rougher one, and the change
# between the two is carried on to the error that is left by the order known of the discretization, as the
# point bands are (`error_estimate`). Errors common to all positions so count in the mean alone, and what
# bends the curve in peak-to-peak and harmonics. Between the nodes of an axis the changes at held-out points
# count.

LEFT_BY_MESH = {
    "plane": {"draft": (0.28, 0.20, 0.22), "standard": (0.28, 0.32, 0.32)},
    "spur": {"draft": (1.4, 3.6, 2.9), "standard": (1.4, 1.4, 2.2)},
    "helical": {"draft": (1.1, 2.0, 2.0), "standard": (0.7, 1.8, 1.8)},
}
"""Error left of mean, peak-to-peak and harmonics over the change to the coarse mesh: in the plane, of
elements half as large; over the face of a spur pair, of elements of two thirds; of a helical pair, over what
second order leaves of that change (`FaceDiscretization.remaining`). Coarse meshes are not in the range yet in
which errors fall with a power of the size: a draft in the plane leaves less of its change than a finer mesh,
one over the face more. Set on pairs that docs/accuracy.md names under "Constants"; the level fine has the
parts of standard."""
HARMONIC_SHARE = 0.3
"""Least change of harmonic k of a helical pair over that of peak-to-peak, times the root of k: half the
slices and coarse meshes err in other harmonics than the table, whose own may hardly change."""
SHOWN = {"mean_m": MEAN, "peak_to_peak_m": PEAK_TO_PEAK, "first_harmonic_m": FIRST_HARMONIC}


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
    own, by_mesh, by_slices, free_ends = _changes(
        sample,
        (nested.table, nested.plane, nested.table, nested.table),
        (np.zeros_like(nested.table), nested.coarse, many_slices, nested.plane),
        np.stack(np.broadcast_arrays(1.0, _left_by_mesh(plan, helical), 1.0, CORRECTION_ERROR)),
        helical,
    )
    if missing := left_out(pair, made):
        free_ends = LEFT_OUT * missing * of_bending(pair, own)
    by_source = {
        "discretisation": by_mesh,
        "slices": by_slices,
        "contact_solver": _by_solver(points, solutions, sample),
        "finite_width": free_ends,
        "position": np.broadcast_to(
            positions.curves[:, :, None, None], (*positions.curves.shape, *points.shape)
        ),
        "model": model_errors(pair, plan.load, own),
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
            error_bound(knots, contact_error(solution), solution.deflection, points.period)
            for solution in solutions
        ]
    )


def _left_by_mesh(plan: Plan, helical: bool) -> FloatArray:
    """Error left over the change to the coarse mesh, (22,)."""
    made = plan.discretization
    kind = ("helical" if helical else "spur") if isinstance(made, FaceDiscretization) else "plane"
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


def _unestimated(points: OperatingPoints, plan: Plan) -> FloatArray:
    """Return the errors of a run in which none was estimated, (9, 22, F, M, D): NaN."""
    return np.full((len(SOURCES), QUANTITIES, plan.load.size, *points.shape), np.nan)


def _summary(errors: FloatArray) -> Json:
    """Return the largest over the alignments of each source by load, m, and what was not estimated.

    A source is not estimated if it is unknown anywhere.
    """
    known = {name: source for name, source in zip(SOURCES, errors, strict=True) if not np.isnan(source).any()}
    largest = {
        name: {label: source[i].max(axis=(1, 2)).tolist() for label, i in SHOWN.items()}
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
    """

    band: FloatArray
    curve_error: FloatArray
    by_source: Json
    held_out: Json

    def to_json(self) -> Json:
        """Return what the receipt says of the errors."""
        sources = {"error_by_source": self.by_source, "held_out": self.held_out}
        return sources | _summary(self.curve_error)


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
    nodes : PositionNodes
    checked : Checked
    plan : Plan
    """
    made, solutions = plan.discretization, [solution for _, solution in solved]
    axes = plan.load, table.misalignment, table.center_distance_change
    sample = TableSample.of(nodes.position, fine.period, axes)
    own = sample.taken(solutions)
    plane = sample.solved(fine.in_plane_strain, fine) if made.corrected else own
    sliced = sample.solved(fine.in_slices(made.coarse_slices), fine) if made.slices > 1 else own
    nested = Nested(sample, own, plane, sample.solved(coarse, fine), sliced)
    positions = position_errors(nodes, fine, solutions, plan)
    measured = fine, solutions, nested, positions, plan
    sources, errors = estimate_errors(*measured), curve_errors(*measured)
    between = held_out_axes(table, fine, checked.request.scene, checked.decided, solved)
    held_out = {name: error.to_json() for name, error in between.items()}
    return AssessedTable(sources.total, with_axes(errors, between), sources.to_json(), held_out)


def unassessed_table(table: SteDatabase, points: OperatingPoints, plan: Plan) -> AssessedTable:
    """Return the errors of a table of which none was estimated, but for what is known in closed form."""
    left = {"plane_for_finite_width_relative": left_out(points.places[0].contact.pair, plan.discretization)}
    unknown = np.full(table.error_estimate.shape, np.nan)
    return AssessedTable(unknown, _unestimated(points, plan), left, {})
