"""Errors of mean, peak-to-peak and harmonics, by source.

Each quantity is computed on two discretizations, that of the run and a rougher one. The known order of
convergence carries their change on to the error that is left, as for the bands of points (`error_estimate`).
Errors common to all positions count in the mean alone, errors that bend the curve in peak-to-peak and
harmonics.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fe_contact.analysis.estimates.error_sources import contact_error
from fe_contact.analysis.estimates.half_position_errors import errors_by_halves
from fe_contact.analysis.estimates.position_errors import PositionErrors
from fe_contact.analysis.estimates.relieved_helical import has_signed_errors, with_signed_errors
from fe_contact.analysis.estimates.rough_flank_errors import quantity_errors, rough_flank_errors
from fe_contact.analysis.estimates.table_sample import Nested, TableSample
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.request.solved_run import Solved
from fe_contact.contact import ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.geometry.finite_width import correction_error
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.model_error import helical_share, model_errors
from fe_contact.planning.plan import Plan
from fe_contact.ste import SteDatabase
from fe_contact.ste.curve_errors import AT_NODES, METHOD, OF_LOAD_ARM, PLANE
from fe_contact.ste.curve_quantities import (
    FIRST_HARMONIC,
    MEAN,
    OFF_MESH,
    PEAK_TO_PEAK,
    QUANTITIES,
    error_bound,
    mean_of_curves,
    quantity_changes,
)
from fe_contact.types import FloatArray

LEFT_BY_MESH = {
    "plane": {"draft": (0.20, 0.20, 0.22), "standard": (0.35, 0.45, 0.45)},
    "spur": {"draft": (0.8, 0.8, 2.9), "standard": (0.8, 0.8, 2.2)},
    "thin": {"draft": (1.4, 3.6, 2.9), "standard": (1.4, 1.4, 2.2)},
    "helical": {"draft": (1.1, 2.0, 2.0), "standard": (0.7, 1.3, 1.8)},
}
"""Errors left in mean, peak-to-peak and harmonics over the change to the coarse mesh, by model and level.

"plane": the coarse mesh has elements twice as large. "spur": a spur pair of solid gears over the face, over
the error that second order leaves of elements one and a half times as large (`FaceDiscretization.remaining`).
"thin": the same with a thin rim. "helical": the same for a helical pair. On coarse meshes errors do not fall
with a power of the size yet: a draft in the plane leaves less of its change than a finer mesh, one over the
face more. The values were set on the pairs of docs/lab/index.md ("Constants"). The level fine has the values
of standard.
"""

COARSER_THAN_STANDARD = ("draft", "medium")

HARMONIC_SHARE = 0.3
"""Least change of harmonic k of a helical pair over that of peak-to-peak, times the root of k. Half the
slices and coarse meshes have errors in other harmonics than the table, whose harmonics may hardly change.
"""

LEFT_OF_ARM = (1.75, 1.0, 1.25)
"""Errors that meshes leave in mean, peak-to-peak and harmonics of the load arm, over the same errors of the
transmission error. They differ because the load arm follows from differences of compliance along the face.
"""

BALANCE = 0.5
"""Least change of the mean arm over the mean size of the change about it. An arm balances one end of the face
against the other, so that the change of its mean may cross zero by accident. `LEFT_OF_ARM` and `BALANCE` were
set on the pairs over the face of docs/lab/index.md, three loads on two meshes, against 31 slices on the mesh
fine.
"""


def curve_errors(
    points: OperatingPoints, solved: Solved, nested: Nested, positions: PositionErrors, plan: Plan
) -> FloatArray:
    """Return the errors at the nodes of the table, (6, 23, F, M, D) in m: sources `AT_NODES`.

    Parameters are those of `estimate_errors`. Errors of the discretization are those at the loads and
    alignments that were solved again, and interpolated between them.
    """
    discretization, sample, pair = plan.discretization, nested.sample, points.nominal.pair
    solutions = [solution for _, solution in solved]
    over_face = isinstance(discretization, FaceDiscretization)
    signed = has_signed_errors(pair, discretization)
    left = np.full(QUANTITIES, discretization.remaining) if signed else _left_by_mesh(pair, plan)
    deflection, by_mesh, by_patches, by_slices, free_ends = _measured(points, nested, plan, left)
    if signed:
        added, changes = _added_by_load(solutions, sample), np.stack([by_mesh, by_patches])
        by_mesh, by_patches = with_signed_errors(changes, nested, added, plan)
    if points.period > 1:
        deflection[OFF_MESH] = _off_mesh_by_load(points, solutions, sample)
    between = positions.curves[:, :, None, None]
    rough_flanks = points.gathered([quantity_errors(rough_flank_errors(*contact)) for contact in solved])
    by_source = {
        "discretisation": np.hypot(by_mesh, by_patches),
        "slices": by_slices,
        "contact_solver": _by_solver(points, solutions, sample),
        PLANE: free_ends,
        "position": np.broadcast_to(between, (*positions.curves.shape, *points.shape)),
        METHOD: model_errors(pair, plan.load, deflection, over_face=over_face) + rough_flanks,
    }
    return np.stack([by_source[name] for name in AT_NODES])


def load_arm_errors(points: OperatingPoints, table: SteDatabase, nested: Nested, plan: Plan) -> FloatArray:
    """Return the errors of the arm of the load at the nodes, (3, 23, F, M, D) in m: sources `OF_LOAD_ARM`.

    They are found as those of the transmission error (`curve_errors`), except that meshes leave more of the
    change (`LEFT_OF_ARM`), and that half of the positions are compared with all. `nested` are load arms.
    """
    left = _left_by_mesh(points.nominal.pair, plan)
    _, by_mesh, by_patches, by_slices, _ = _measured(points, nested, plan, left, BALANCE)
    by_mesh = _by_quantity(*LEFT_OF_ARM)[:, None, None, None] * by_mesh
    arms = table.load_arm.reshape(table.position.size, -1)
    by_positions = errors_by_halves(table.position, arms, table.period).curves
    by_source = {
        "discretisation": np.hypot(by_mesh, by_patches),
        "slices": by_slices,
        "position": by_positions.reshape(by_slices.shape),
    }
    return np.stack([by_source[name] for name in OF_LOAD_ARM])


def _measured(
    points: OperatingPoints, nested: Nested, plan: Plan, left_by_mesh: FloatArray, balance: float = 0.0
) -> FloatArray:
    """Return quantities, and errors left by meshes, patches, slices and free ends, (5, 23, F, M, D) in m.

    `left_by_mesh` (23,) is the error left over the change to the coarse mesh; `balance` the least change of a
    mean over the mean size of the change about it.
    """
    discretization = plan.discretization
    # Many slices are extrapolated on the curve, not on its quantities: half the slices may multiply a small
    # ripple, and no part of that is what many slices change.
    many_slices = nested.table + discretization.remaining_slices * (nested.table - nested.sliced)
    parts = 1.0, left_by_mesh, plan.remaining_patches, 1.0, correction_error(points.nominal.pair)
    return _changes(
        nested.sample,
        (nested.table, nested.patched, nested.plane, nested.table, nested.table),
        (np.zeros_like(nested.table), nested.coarse, nested.patched, many_slices, nested.plane),
        np.stack(np.broadcast_arrays(*parts)),
        balance,
        _helical(points.nominal.pair, plan),
    )


def _changes(
    sample: TableSample,
    curves: Sequence[FloatArray],
    references: Sequence[FloatArray],
    parts: FloatArray,
    balance: float,
    helical: float,
) -> FloatArray:
    """Return parts (k, 23) of the changes of k sets of curves (T R, f, m, d), (k, 23, F, M, D) in m."""
    first, second = np.stack(curves, axis=1), np.stack(references, axis=1)
    rows = sample.knots.size
    change = quantity_changes(sample.knots, first.reshape(rows, -1), second.reshape(rows, -1), sample.period)
    if balance:
        about = np.nan_to_num(first - second).reshape(rows, -1)
        about = np.abs(about - mean_of_curves(sample.knots, about, sample.period))
        minimum = balance * mean_of_curves(sample.knots, about, sample.period)
        change[MEAN] = np.maximum(change[MEAN], minimum)
    change = parts.T[:, :, None, None, None] * change.reshape(QUANTITIES, *first.shape[1:])
    return sample.spread(np.moveaxis(_shared(change, helical), 1, 0))


def _added_by_load(solutions: Sequence[ContactSolution], sample: TableSample) -> FloatArray:
    """Return what the load adds to the mean at the loads and alignments of a sample, (f, m, d) in m."""
    places = [solutions[k] for k in sample.places]
    added = [place.deflection[:, sample.nodes[0]] - place.no_load[:, None] for place in places]
    return sample.shaped([np.nanmean(deflection, axis=0) for deflection in added])


def _off_mesh_by_load(
    points: OperatingPoints, solutions: list[ContactSolution], sample: TableSample
) -> FloatArray:
    """Return the largest contribution of load to an order that is no mesh order, (F, M, D) in m.

    Motion without load, as by the eccentricity of a gear, is free of the error of a model of bending teeth.
    """
    knots = (np.arange(points.period)[:, None] + sample.position).ravel()

    def added(solution: ContactSolution) -> FloatArray:
        unloaded = np.broadcast_to(solution.no_load[:, None], solution.deflection.shape)
        return quantity_changes(knots, solution.deflection, unloaded, points.period)[[OFF_MESH]]

    return np.asarray(points.gathered([added(solution) for solution in solutions])[0])


def _by_solver(points: OperatingPoints, solutions: list[ContactSolution], sample: TableSample) -> FloatArray:
    """Return the errors (23, F, M, D) that the residuals of the contact can make."""
    knots = (np.arange(points.period)[:, None] + sample.position).ravel()
    bounds = [
        error_bound(knots, contact_error(solution), solution.deflection, points.period)
        for solution in solutions
    ]
    return points.gathered(bounds)


def _helical(pair: ParallelAxes, plan: Plan) -> float:
    """Return the weight of the constants of helical pairs against those of spur pairs; 0 in the plane."""
    return helical_share(pair) if isinstance(plan.discretization, FaceDiscretization) else 0.0


def _left_by_mesh(pair: ParallelAxes, plan: Plan) -> FloatArray:
    """Return the error left over the change to the coarse mesh, (23,)."""
    discretization, helical = plan.discretization, _helical(pair, plan)
    level = "draft" if plan.level in COARSER_THAN_STANDARD else "standard"
    if not isinstance(discretization, FaceDiscretization):
        return _by_quantity(*LEFT_BY_MESH["plane"][level])
    kind = "spur" if all(gear.web is None for gear in plan.bodies(pair)) else "thin"
    spur, wound = np.array(LEFT_BY_MESH[kind][level]), np.array(LEFT_BY_MESH["helical"][level])
    return _by_quantity(*((1.0 - helical) * spur + helical * discretization.remaining * wound))


def _by_quantity(mean: float, ripple: float, harmonics: float) -> FloatArray:
    """Return values of mean, peak-to-peak and harmonics for each quantity, (23,)."""
    return np.array([mean, ripple, *[harmonics] * (QUANTITIES - OFF_MESH)])


def _shared(change: FloatArray, helical: float) -> FloatArray:
    """Return changes (23, ...) of which every harmonic has at least its `HARMONIC_SHARE` of peak-to-peak."""
    number = np.arange(1, QUANTITIES - FIRST_HARMONIC + 1).reshape(-1, *[1] * (change.ndim - 1))
    minimum = helical * HARMONIC_SHARE * change[PEAK_TO_PEAK] / np.sqrt(number)
    return np.concatenate([change[:FIRST_HARMONIC], np.maximum(change[FIRST_HARMONIC:], minimum)])
