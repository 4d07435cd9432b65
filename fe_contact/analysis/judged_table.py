"""Everything that is known of the errors of a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.curve_error_estimate import curve_errors, summary, unestimated, with_axes
from fe_contact.analysis.error_estimate import Nested, estimate_errors, left_out
from fe_contact.analysis.held_out_axes import held_out_axes
from fe_contact.analysis.position_nodes import PositionNodes
from fe_contact.analysis.request import Checked
from fe_contact.analysis.table_places import Place, Places
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.planning import Plan
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json


@dataclass(frozen=True)
class JudgedTable:
    """Errors of a table.

    Attributes
    ----------
    band : ndarray, shape (P, F, M, D)
        Of every point, m; NaN where not estimated.
    curve_error : ndarray, shape (8, 22, F, M, D)
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
        found = {"error_by_source": self.by_source, "held_out": self.held_out}
        return found | summary(self.curve_error)


def judged_table(
    table: SteDatabase,
    fine: Places,
    coarse: Places,
    solved: list[tuple[ContactProblem, ContactSolution]],
    nodes: PositionNodes,
    checked: Checked,
    plan: Plan,
) -> JudgedTable:
    """Solve the table once more on each rougher discretisation, and held-out points of its axes.

    Parameters
    ----------
    table : SteDatabase
        As solved on `fine`.
    fine, coarse : Places
        On the meshes of the run and on the coarse ones.
    solved : list of (ContactProblem, ContactSolution)
        Of every place.
    nodes : PositionNodes
    checked : Checked
    plan : Plan
    """
    made, found = plan.discretisation, [solution for _, solution in solved]
    nested = Nested(
        found,
        _again([place.in_plane_strain for place in fine.places], nodes, plan) if made.corrected else found,
        _again(coarse.places, nodes, plan),
        _again(fine.in_slices(made.coarse_slices).places, nodes, plan) if made.slices > 1 else found,
    )
    sources = estimate_errors(fine, nested, nodes, plan)
    axes = held_out_axes(table, fine, checked.request.scene, checked.decided)
    errors = with_axes(curve_errors(fine, nested, nodes, plan), axes)
    held_out = {name: error.to_json() for name, error in axes.items()}
    return JudgedTable(sources.total, errors, sources.to_json(), held_out)


def unjudged_table(table: SteDatabase, places: Places, plan: Plan) -> JudgedTable:
    """Return the errors of a table of which none was estimated, but for what is known in closed form."""
    left = {"plane_for_finite_width_relative": left_out(plan, places.places[0].contact.pair)}
    unknown = np.full(table.error_estimate.shape, np.nan)
    return JudgedTable(unknown, unestimated(places, plan), left, {})


def _again(
    places: list[Place] | tuple[Place, ...], nodes: PositionNodes, plan: Plan
) -> list[ContactSolution]:
    """Solve every place at the positions and loads of the table."""
    pitches = np.arange(places[0].model.period)
    return [place.solve_pitches(nodes.position, plan.load, pitches)[1] for place in places]
