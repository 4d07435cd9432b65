"""Everything that is known of the errors of a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.estimates.curve_error_estimate import curve_errors, summary, unestimated, with_axes
from fe_contact.analysis.estimates.error_estimate import Nested, estimate_errors
from fe_contact.analysis.estimates.held_out_axes import held_out_axes
from fe_contact.analysis.estimates.position_errors import position_errors
from fe_contact.analysis.estimates.solved_again import TableSample
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.pairs.solved_operating_points import Solved
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.tables.position_nodes import PositionNodes
from fe_contact.planning import Plan, left_out
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json


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
        return sources | summary(self.curve_error)


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
    return AssessedTable(unknown, unestimated(points, plan), left, {})
