"""The assessed table: its errors by source, and the loads inserted for its accuracy."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.cycle.derived_pitches import DerivedCycle
from fe_contact.analysis.estimates.curve_errors import curve_errors, load_arm_errors
from fe_contact.analysis.estimates.error_sources import estimate_errors, largest_known
from fe_contact.analysis.estimates.interval_goal import IntervalGoal
from fe_contact.analysis.estimates.position_errors import position_errors
from fe_contact.analysis.estimates.relieved_helical import has_signed_errors, mesh_bias
from fe_contact.analysis.estimates.table_sample import Nested, TableSample
from fe_contact.analysis.estimates.tolerance_shares import interval_goal
from fe_contact.analysis.estimates.validation_axes import AxisError, validation_axes
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.tables import SolvedTable
from fe_contact.planning.plan import Plan
from fe_contact.planning.plane_bias import plane_bias
from fe_contact.sampled import spread
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.curve_errors import BETWEEN_NODES, DERIVATIVES, OF_LOAD_ARM, SOURCES, source_names
from fe_contact.ste.curve_quantities import BY_SOURCE, QUANTITIES, mean_of_curves
from fe_contact.ste.fields import CENTER_DISTANCE, MISALIGNMENT
from fe_contact.ste.plane_bias import PlaneBias
from fe_contact.ste.support_loads import SupportLoads, with_support_loads
from fe_contact.types import FloatArray, Json


def interval_errors(shape: tuple[int, ...], axes: Mapping[str, AxisError]) -> tuple[FloatArray, FloatArray]:
    """Lay out the interpolation errors of the axes of a table with nodes (F, M, D).

    Errors assessed at one alignment stand for all alignments. An interval that was not assessed has NaN.

    Returns
    -------
    (ndarray, ndarray), shapes (3, F, M, D) and (3, 23, F, M, D)
        Errors of points, and of mean, peak-to-peak and harmonics, in m at the lower node of every interval.
    """
    errors = np.zeros((len(BETWEEN_NODES), 1 + QUANTITIES, *shape))
    for i, name in enumerate(BETWEEN_NODES):
        intervals = np.moveaxis(errors[i], 1 + i, 1)[:, : shape[i] - 1]  # a view
        intervals[...] = np.nan
        if name in axes:
            intervals[...] = np.concatenate([axes[name].error[None], axes[name].change])[..., None]
    return errors[:, 0], errors[:, 1:]


def _summary(errors: FloatArray) -> Json:
    """Return the largest error over the alignments by source and load, m, and the sources not estimated.

    A source is not estimated if it is unknown anywhere.
    """
    names = source_names(errors)
    known = {name: source for name, source in zip(names, errors, strict=True) if not np.isnan(source).any()}
    largest = {
        name: {label: source[i].max(axis=(1, 2)).tolist() for label, i in BY_SOURCE.items()}
        for name, source in known.items()
    }
    return {"curve_error": largest, "not_estimated": [name for name in names if name not in known]}


@dataclass(frozen=True)
class AssessedTable:
    """Errors of a table."""

    band: FloatArray
    """Error of the transmission error at every point, m; NaN where not estimated. Shape (P, F, M, D)."""
    curve_error: FloatArray
    """Error of mean, peak-to-peak and harmonics by source, m; NaN: not estimated. Shape (9, 23, F, M, D)."""
    load_arm_error: FloatArray
    """Error of mean, peak-to-peak and harmonics of the load arm by source, m. Shape (3, 23, F, M, D)."""
    interval_error: FloatArray
    """Error of points between the nodes of an axis, stored at the lower node, m. Shape (3, F, M, D)."""
    inserted: SupportLoads | None
    """Solutions at inserted loads. With these nodes the table has the stated errors between its loads."""
    by_source: Json
    """Largest errors by source."""
    validation: Json
    """Errors measured between the nodes of each axis."""
    bias: PlaneBias | None
    """Bias of the plane by the finite width where the width is not corrected. No error contains it."""
    mesh_bias: FloatArray | None = None
    """Correction of the mean to exact meshes, where its sign is known; part of the errors, m. Shape (F,)."""

    def with_errors(self, table: SteDatabase, metadata: Metadata) -> SteDatabase:
        """Return the table with these errors and with the metadata that state them."""
        with_errors = replace(
            table,
            error_estimate=self.band,
            metadata=metadata,
            curve_error=self.curve_error,
            load_arm_error=self.load_arm_error,
            interval_error=self.interval_error,
        )
        return with_errors if self.inserted is None else with_support_loads(with_errors, self.inserted)

    def with_derivatives(self, cycle: DerivedCycle | None) -> AssessedTable:
        """Return the errors with those of derivatives, if any base pitch of the table follows from them."""
        if cycle is None or not cycle.tables:
            return self
        by_kind = zip(*(table.errors[:3] for table in cycle.tables), strict=True)
        band, curves, arms = (cycle.places.gathered(list(errors)) for errors in by_kind)
        return replace(
            self,
            band=self.band + band,
            curve_error=np.concatenate([self.curve_error, curves[None]]),
            load_arm_error=np.concatenate([self.load_arm_error, arms[None]]),
            by_source=self.by_source | {f"{DERIVATIVES}_m": largest_known(band)},
        )

    def to_json(self) -> Json:
        """Return the receipt's fields of the errors as plain JSON."""
        sources = {"error_by_source": self.by_source, "held_out": self.validation}
        bias = {"bias": self.bias.to_json()} if self.bias else {}
        signed = {} if self.mesh_bias is None else {"mesh_bias": {"mean_m": self.mesh_bias.tolist()}}
        return sources | bias | signed | _summary(self.curve_error)


def assessed_table(solved_table: SolvedTable, coarse: OperatingPoints) -> tuple[AssessedTable, SolvedTable]:
    """Solve a table once more on each rougher discretization, and held-out points of its axes.

    Parameters
    ----------
    solved_table : SolvedTable
        Table on the meshes of the run.
    coarse : OperatingPoints
        Operating points of the table on the coarse meshes.

    Returns
    -------
    AssessedTable, SolvedTable
        The errors, and their table: with the alignments that were inserted.
    """
    table, plan, fine, nodes = solved_table.table, solved_table.plan, solved_table.places, solved_table.nodes
    discretization, solutions = plan.discretization, [solution for _, solution in solved_table.solved]
    axes = plan.load, table.misalignment, table.center_distance_change
    sample = TableSample.of(nodes.position, fine.period, axes)
    nominal = sample.taken(table)
    plane = sample.solved(fine.in_plane_strain, fine) if discretization.corrected else nominal
    has_slices = discretization.slices > 1
    sliced = sample.solved(fine.in_slices(discretization.coarse_slices), fine) if has_slices else nominal
    wider = fine.in_plane_strain.in_coarse_patches
    patched = sample.solved(wider, fine)
    # the coarse meshes have the wider patches, too, and so the same candidates
    nested = Nested(sample, nominal, plane, patched, sample.solved(coarse, wider), sliced)
    positions = position_errors(nodes, fine, solutions, plan)
    ste, arms = nested.parts
    measured = fine, solved_table.solved, ste, positions, plan
    sources, errors = estimate_errors(*measured), curve_errors(*measured)
    request = solved_table.checked.request

    def goal(database: SteDatabase) -> IntervalGoal:
        at_nodes, bias = _at_inserted(errors, database), table_bias(database, fine, plan)
        return interval_goal(database, at_nodes, request, bias)

    has_goal = request.options.tolerance is not None and not request.nodes_alone
    validation = validation_axes(solved_table, goal if has_goal else None)
    solved_table = validation.solved_table
    of_points, of_curves = interval_errors((plan.load.size, *solved_table.places.shape), validation.axes)
    assessed = AssessedTable(
        band=_at_inserted(sources.total, solved_table.table),
        curve_error=np.concatenate([_at_inserted(errors, solved_table.table), of_curves]),
        load_arm_error=_at_inserted(load_arm_errors(fine, table, arms, plan), solved_table.table),
        interval_error=of_points,
        inserted=validation.loads,
        by_source=sources.to_json(),
        validation={name: error.to_json() for name, error in validation.axes.items()},
        bias=table_bias(solved_table.table, fine, plan),
        mesh_bias=mesh_bias(ste, plan) if has_signed_errors(fine.nominal.pair, discretization) else None,
    )
    return assessed, solved_table


def _at_inserted(errors: FloatArray, table: SteDatabase) -> FloatArray:
    """Carry errors (..., m, d) at the requested alignments of a table on to all, (..., M, D), linearly."""
    for axis, name in enumerate((MISALIGNMENT, CENTER_DISTANCE), start=-2):
        requested = np.flatnonzero(table.requested_rows(name))
        errors = spread(getattr(table, name), requested, errors, axis)
    return errors


def unassessed_table(table: SteDatabase, points: OperatingPoints, plan: Plan) -> AssessedTable:
    """Return the errors of a table without estimates, with the errors known in closed form."""
    errors = np.full((len(SOURCES), QUANTITIES, plan.load.size, *points.shape), np.nan)
    return AssessedTable(
        band=np.full(table.error_estimate.shape, np.nan),
        curve_error=errors,
        load_arm_error=errors[: len(OF_LOAD_ARM)],
        interval_error=errors[: len(BETWEEN_NODES), 0],
        inserted=None,
        by_source={},
        validation={},
        bias=table_bias(table, points, plan),
    )


def table_bias(table: SteDatabase, points: OperatingPoints, plan: Plan) -> PlaneBias | None:
    """Return the bias of the plane model in the curves of a table."""
    pair, ste = points.nominal.pair, table.static_transmission_error
    bias = plane_bias(pair, plan.discretization)
    mean = mean_of_curves(table.position, ste, table.period)
    return bias and bias.of_curves(mean, np.ptp(ste, axis=0))
