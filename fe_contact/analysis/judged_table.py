"""Everything that is known of the errors of a table."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.curve_error_estimate import curve_errors, summary, unestimated, with_axes
from fe_contact.analysis.error_estimate import Nested, estimate_errors, left_out
from fe_contact.analysis.held_out_axes import held_out_axes
from fe_contact.analysis.model_choice import plane_strain_error
from fe_contact.analysis.position_nodes import PositionNodes
from fe_contact.analysis.request import Checked
from fe_contact.analysis.sampled import ALIGNMENTS, LOADS, sample_of, spread
from fe_contact.analysis.table_places import Places
from fe_contact.contact import ContactProblem, ContactSolution
from fe_contact.planning import Plan
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json

Knots = tuple[FloatArray, FloatArray, FloatArray]
"""Loads, misalignments and changes of the centre distance of a table."""
MOST = (LOADS, ALIGNMENTS, ALIGNMENTS)


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
    curves = [solution.deflection for solution in found]
    knots = plan.load, table.misalignment, table.center_distance_change
    plane = _again(fine.in_plane_strain, nodes, knots, curves) if made.corrected else curves
    sliced = _again(fine.in_slices(made.coarse_slices), nodes, knots, curves) if made.slices > 1 else curves
    nested = Nested(found, plane, _again(coarse, nodes, knots, curves), sliced)
    stands_in = plane_strain_error(checked)
    sources = estimate_errors(fine, nested, nodes, plan, stands_in)
    axes = held_out_axes(table, fine, checked.request.scene, checked.decided)
    errors = with_axes(_not_less_between(curve_errors(fine, nested, nodes, plan, stands_in), knots), axes)
    held_out = {name: error.to_json() for name, error in axes.items()}
    return JudgedTable(sources.total, errors, sources.to_json(), held_out)


def unjudged_table(table: SteDatabase, places: Places, plan: Plan) -> JudgedTable:
    """Return the errors of a table of which none was estimated, but for what is known in closed form."""
    left = {"plane_for_finite_width_relative": left_out(plan, places.places[0].contact.pair)}
    unknown = np.full(table.error_estimate.shape, np.nan)
    return JudgedTable(unknown, unestimated(places, plan), left, {})


def _again(
    places: Places,
    nodes: PositionNodes,
    axes: Knots,
    finer: list[FloatArray],
) -> list[FloatArray]:
    """Return STE (P, F) in m of every place on a rougher discretisation, at the positions of the table.

    It is solved at some loads and alignments of the axes (loads, misalignments, centre distances); between
    them its difference to the table's own, `finer`, is interpolated. Positions are all needed: between those
    of a handover nothing can be interpolated.
    """
    loads, skews, changes = samples = [sample_of(axis.size, n) for axis, n in zip(axes, MOST, strict=True)]
    pitches = np.arange(places.period)
    found = []
    for k in (int(m) * places.shape[1] + int(d) for m in skews for d in changes):
        _, rougher = places.places[k].solve_pitches(nodes.position, axes[0][loads], pitches)
        found.append(rougher.deflection - finer[k][:, loads])
    change = np.stack(found, axis=2).reshape(-1, *(sample.size for sample in samples))
    for axis, (knots, sample) in enumerate(zip(axes, samples, strict=True), start=1):
        change = spread(knots, sample, change, axis)
    by_place = change.reshape(*change.shape[:2], -1)
    return [one + by_place[:, :, k] for k, one in enumerate(finer)]


def _not_less_between(errors: FloatArray, knots: Knots) -> FloatArray:
    """Let errors (5, 22, F, M, D) between what was solved be no less than interpolated from there.

    A difference of curves that is interpolated has a peak-to-peak that may be smaller by accident.
    """
    for axis, (nodes, most) in enumerate(zip(knots, MOST, strict=True), start=2):
        sample = sample_of(nodes.size, most)
        errors = np.maximum(errors, spread(nodes, sample, np.take(errors, sample, axis=axis), axis))
    return errors
