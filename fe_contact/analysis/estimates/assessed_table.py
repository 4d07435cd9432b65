"""Everything that is known of the errors of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.analysis.cycle.derived_pitches import DerivedCycle
from fe_contact.analysis.estimates.held_out_axes import AxisError, held_out_axes
from fe_contact.analysis.estimates.interval_goal import IntervalGoal
from fe_contact.analysis.estimates.position_errors import (
    PositionErrors,
    errors_by_halves,
    position_errors,
)
from fe_contact.analysis.estimates.rough_flank_errors import of_quantities, rough_flank_errors
from fe_contact.analysis.estimates.table_sample import Nested, TableSample
from fe_contact.analysis.estimates.tolerance_shares import interval_goal
from fe_contact.analysis.pairs.pair_contact import OperatingPoints
from fe_contact.analysis.request.solved_run import Solved
from fe_contact.analysis.tables import SolvedTable
from fe_contact.contact import ContactSolution
from fe_contact.geometry import ParallelAxes
from fe_contact.planning.model_error import helical_share, model_errors, point_error
from fe_contact.planning.plan import FaceDiscretization, Plan
from fe_contact.planning.plane_bias import plane_bias
from fe_contact.sampled import spread
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.curve import (
    AT_NODES,
    BETWEEN_NODES,
    DERIVATIVES,
    METHOD,
    OF_LOAD_ARM,
    PLANE,
    SOURCES,
    source_names,
)
from fe_contact.ste.curve_quantities import (
    BESIDE_MESH,
    BY_SOURCE,
    FIRST_HARMONIC,
    MEAN,
    PEAK_TO_PEAK,
    QUANTITIES,
    error_bound,
    mean_of_curves,
    quantity_changes,
)
from fe_contact.ste.database import SupportLoads, with_support_loads
from fe_contact.ste.fields import CENTER_DISTANCE, MISALIGNMENT
from fe_contact.ste.plane_bias import PlaneBias
from fe_contact.types import FloatArray, Json, Status

# Errors of a table, by source.
#
# The finite-element error comes from a second, coarser discretization solved at the same points; with
# quadratic elements and Galerkin patches the error falls at least with the square of the element size,
# which bounds what is left of the difference (`Discretization.remaining`). The table's error is measured
# at the middles between its nodes. Where the plane stands in for three dimensions, a part of what it was
# corrected by is its error; it is measured against three-dimensional solutions
# (docs/effects.md#finite_width). The errors of a plane that is not corrected are those of its model: what it
# leaves out of the finite width has a sign, and is a correction (`ste.plane_bias`).

CORRECTION_ERROR = 0.03
"""Error of the correction for a finite width in parts of the correction itself. The largest seen of mean,
peak-to-peak and harmonics on its pairs (docs/lab/accuracy.md, "Constants") is 0.033, of peak-to-peak at a
face of 1.2 modules, of which the mesh covers its part."""


@dataclass(frozen=True)
class _ErrorSources:
    """Error of STE in m by source; arrays (P, F, M, D)."""

    discretization: FloatArray
    slices: FloatArray
    interpolation: FloatArray
    contact: FloatArray
    plane: FloatArray
    method: FloatArray
    """`discretization`, `slices`, `interpolation`, `contact`, `plane`, `method`: Finite elements, slices of
    the face, table beside the node, contact, the plane for a finite width, and what the method leaves out.
    """

    @property
    def total(self) -> FloatArray:
        """Sum of the sources at each point, m."""
        parts = self.discretization, self.slices, self.interpolation, self.contact, self.plane
        return np.asarray(sum(parts) + self.method)

    def to_json(self) -> Json:
        """Return the largest of each source by load, m.

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
        return {name: _largest_known(values) for name, values in sources.items()}


def _largest_known(errors: FloatArray) -> list[float | None]:
    """Return the largest number of errors (P, F, M, D) at each load; None if there is none."""
    worst = np.where(np.isnan(errors), -np.inf, errors).max(axis=(0, 2, 3))
    return [float(value) if np.isfinite(value) else None for value in worst]


def estimate_errors(
    points: OperatingPoints,
    solved: Solved,
    nested: Nested,
    positions: PositionErrors,
    plan: Plan,
) -> _ErrorSources:
    """Combine the measured differences.

    Parameters
    ----------
    solved : list of (ContactProblem, ContactSolution)
        The table's.
    positions : PositionErrors
        The largest of the assessed operating points stand for every place.
    """
    made, nominal = plan.discretization, points.nominal.pair
    solutions = [solution for _, solution in solved]

    def left(these: FloatArray, those: FloatArray, part: float) -> FloatArray:
        """Return a part of the differences of STE, at all points."""
        return nested.sample.spread_points(part * np.nan_to_num(np.abs(these - those)))

    face, lags = isinstance(made, FaceDiscretization), [np.nan_to_num(each.deflection) for each in solutions]
    return _ErrorSources(
        left(nested.patched, nested.coarse, made.remaining)
        + left(nested.plane, nested.patched, plan.remaining_patches),
        left(nested.table, nested.sliced, made.remaining_slices),
        np.broadcast_to(positions.band[:, :, None, None], (*positions.band.shape, *points.shape)),
        points.gathered([_contact_error(solution) for solution in solutions]),
        left(nested.table, nested.plane, CORRECTION_ERROR),
        points.gathered([point_error(nominal, plan.load, lag, over_face=face) for lag in lags])
        + points.gathered([rough_flank_errors(*each) for each in solved]),
    )


def _contact_error(solution: ContactSolution) -> FloatArray:
    """Return the contact solver's error (P, F): its largest relative residual times the STE, m."""
    worst = np.nan_to_num(solution.residuals.max(axis=2), posinf=0.0)
    return np.asarray(np.nan_to_num(np.abs(solution.deflection)) * worst)


def worst_residual(solution: ContactSolution) -> float:
    """Return the largest of the four residuals over all converged points."""
    good = (solution.status == Status.CONVERGED) & np.isfinite(solution.residuals[..., 0])
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
    solved: Solved,
    nested: Nested,
    positions: PositionErrors,
    plan: Plan,
) -> FloatArray:
    """Return the errors at the nodes of the table, (6, 23, F, M, D) in m: sources `AT_NODES`.

    Parameters are those of `estimate_errors`. Errors of the discretization are those at the loads and
    alignments that were solved again, and interpolated between them.
    """
    made, sample, pair = plan.discretization, nested.sample, points.nominal.pair
    solutions = [solution for _, solution in solved]
    own, by_mesh, by_patches, by_slices, free_ends = _measured(points, nested, plan)
    if points.period > 1:
        own[BESIDE_MESH] = _beside_by_load(points, solutions, sample)
    by_source = {
        "discretisation": np.hypot(by_mesh, by_patches),
        "slices": by_slices,
        "contact_solver": _by_solver(points, solutions, sample),
        PLANE: free_ends,
        "position": np.broadcast_to(
            positions.curves[:, :, None, None], (*positions.curves.shape, *points.shape)
        ),
        METHOD: model_errors(pair, plan.load, own, over_face=isinstance(made, FaceDiscretization))
        + points.gathered([of_quantities(rough_flank_errors(*each)) for each in solved]),
    }
    return np.stack([by_source[name] for name in AT_NODES])


LEFT_OF_ARM = (1.75, 1.0, 1.25)
"""What meshes leave of mean, peak-to-peak and harmonics of the load arm, over the same parts of the
transmission error: where the load lies follows from differences of compliance along the face."""
BALANCE = 0.5
"""Least change of the mean arm over the mean size of the change about it. An arm balances one end of the
face against the other, so that the change of its mean may cross zero by accident. Both were set on the pairs
over the face of docs/lab/accuracy.md, three loads on two meshes, against 31 slices on the mesh fine."""


def load_arm_errors(points: OperatingPoints, table: SteDatabase, nested: Nested, plan: Plan) -> FloatArray:
    """Return the errors of the arm of the load at the nodes, (3, 23, F, M, D) in m: sources `OF_LOAD_ARM`.

    As those of the transmission error (`curve_errors`), of a mesh with more left of the change
    (`LEFT_OF_ARM`); between the positions half of them are held against all. `nested` are load arms.
    """
    _, by_mesh, by_patches, by_slices, _ = _measured(points, nested, plan, BALANCE)
    mean, ripple, harmonics = LEFT_OF_ARM
    part = np.array([mean, ripple, *[harmonics] * (QUANTITIES - BESIDE_MESH)])
    by_mesh = part[:, None, None, None] * by_mesh
    arms = table.load_arm.reshape(table.position.size, -1)
    by_positions = errors_by_halves(table.position, arms, table.period).curves
    by_source = {
        "discretisation": np.hypot(by_mesh, by_patches),
        "slices": by_slices,
        "position": by_positions.reshape(by_slices.shape),
    }
    return np.stack([by_source[name] for name in OF_LOAD_ARM])


def _measured(points: OperatingPoints, nested: Nested, plan: Plan, balance: float = 0.0) -> FloatArray:
    """Return quantities, and what meshes, patches, slices and free ends leave, (5, 23, F, M, D) in m.

    `balance` is the least change of a mean over the mean size of the change about it.
    """
    made, pair = plan.discretization, points.nominal.pair
    helical = helical_share(pair) if isinstance(made, FaceDiscretization) else 0.0
    # on the curve: half the slices may multiply a small ripple, and no part of that is what many change
    many_slices = nested.table + made.remaining_slices * (nested.table - nested.sliced)
    parts = 1.0, _left_by_mesh(pair, plan, helical), plan.remaining_patches, 1.0, CORRECTION_ERROR
    return _changes(
        nested.sample,
        (nested.table, nested.patched, nested.plane, nested.table, nested.table),
        (np.zeros_like(nested.table), nested.coarse, nested.patched, many_slices, nested.plane),
        np.stack(np.broadcast_arrays(*parts)),
        balance,
        helical,
    )


def _changes(
    sample: TableSample,
    these: Sequence[FloatArray],
    those: Sequence[FloatArray],
    parts: FloatArray,
    balance: float,
    helical: float,
) -> FloatArray:
    """Return parts (k, 23) of the changes of k sets of curves (T R, f, m, d), (k, 23, F, M, D) in m."""
    first, second = np.stack(these, axis=1), np.stack(those, axis=1)
    rows = sample.knots.size
    change = quantity_changes(sample.knots, first.reshape(rows, -1), second.reshape(rows, -1), sample.period)
    if balance:
        about = np.nan_to_num(first - second).reshape(rows, -1)
        about = np.abs(about - mean_of_curves(sample.knots, about, sample.period))
        least = balance * mean_of_curves(sample.knots, about, sample.period)
        change[MEAN] = np.maximum(change[MEAN], least)
    change = parts.T[:, :, None, None, None] * change.reshape(QUANTITIES, *first.shape[1:])
    return sample.spread(np.moveaxis(_shared(change, helical), 1, 0))


def _beside_by_load(
    points: OperatingPoints, solutions: list[ContactSolution], sample: TableSample
) -> FloatArray:
    """Return what load adds to the order beside the mesh to which it adds most, (F, M, D) in m.

    What gears do without load, as the eccentricity of one, no model of teeth that bend has wrong.
    """
    knots = (np.arange(points.period)[:, None] + sample.position).ravel()

    def added(solution: ContactSolution) -> FloatArray:
        unloaded = np.broadcast_to(solution.no_load[:, None], solution.deflection.shape)
        return quantity_changes(knots, solution.deflection, unloaded, points.period)[[BESIDE_MESH]]

    return np.asarray(points.gathered([added(solution) for solution in solutions])[0])


def _by_solver(points: OperatingPoints, solutions: list[ContactSolution], sample: TableSample) -> FloatArray:
    """Errors (23, F, M, D) that the residuals of the contact can make."""
    knots = (np.arange(points.period)[:, None] + sample.position).ravel()
    return points.gathered(
        [
            error_bound(knots, _contact_error(solution), solution.deflection, points.period)
            for solution in solutions
        ]
    )


def _left_by_mesh(pair: ParallelAxes, plan: Plan, helical: float) -> FloatArray:
    """Error left over the change to the coarse mesh, (23,); `helical`: the part of helical constants."""
    made = plan.discretization
    straight = "spur" if all(gear.web is None for gear in plan.bodies(pair)) else "thin"
    level = "draft" if plan.level == "draft" else "standard"
    if isinstance(made, FaceDiscretization):
        spur, wound = (np.array(LEFT_BY_MESH[kind][level]) for kind in (straight, "helical"))
        mean, ripple, harmonics = (1.0 - helical) * spur + helical * made.remaining * wound
    else:
        mean, ripple, harmonics = LEFT_BY_MESH["plane"][level]
    return np.array([mean, ripple, *[harmonics] * (QUANTITIES - BESIDE_MESH)])


def _shared(change: FloatArray, helical: float) -> FloatArray:
    """Let every harmonic of a helical pair change (23, ...) by its share of peak-to-peak at least."""
    number = np.arange(1, QUANTITIES - FIRST_HARMONIC + 1).reshape(-1, *[1] * (change.ndim - 1))
    least = helical * HARMONIC_SHARE * change[PEAK_TO_PEAK] / np.sqrt(number)
    return np.concatenate([change[:FIRST_HARMONIC], np.maximum(change[FIRST_HARMONIC:], least)])


def interval_errors(shape: tuple[int, ...], axes: Mapping[str, AxisError]) -> tuple[FloatArray, FloatArray]:
    """Lay out the interpolation errors of the axes of a table with nodes (F, M, D).

    What was assessed at one alignment stands for all of them. An interval that was not assessed has NaN.

    Returns
    -------
    (ndarray, ndarray), shapes (3, F, M, D) and (3, 23, F, M, D)
        Of points, and of mean, peak-to-peak and harmonics, in m at the lower node of every interval.
    """
    errors = np.zeros((len(BETWEEN_NODES), 1 + QUANTITIES, *shape))
    for i, name in enumerate(BETWEEN_NODES):
        intervals = np.moveaxis(errors[i], 1 + i, 1)[:, : shape[i] - 1]  # a view
        intervals[...] = np.nan
        if name in axes:
            intervals[...] = np.concatenate([axes[name].error[None], axes[name].change])[..., None]
    return errors[:, 0], errors[:, 1:]


def _summary(errors: FloatArray) -> Json:
    """Return the largest over the alignments of each source by load, m, and what was not estimated.

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
    """Of every point, m; NaN where not estimated. Shape (P, F, M, D)."""
    curve_error: FloatArray
    """Of mean, peak-to-peak and harmonics by source, m; NaN where not estimated. Shape (9, 23, F, M, D)."""
    load_arm_error: FloatArray
    """The same of the load arm. Shape (3, 23, F, M, D)."""
    interval_error: FloatArray
    """Of points between the nodes of an axis, at the lower one, m. Shape (3, F, M, D)."""
    inserted: SupportLoads | None
    """Loads with which the table has these errors between its loads."""
    by_source: Json
    held_out: Json
    """`by_source`, `held_out`: The largest by source; what was measured between the nodes of each axis."""
    bias: PlaneBias | None
    """What the plane leaves out of a finite width where it is not corrected; no error holds it."""

    def stated(self, table: SteDatabase, metadata: Metadata) -> SteDatabase:
        """Return the table with them, and with the metadata that state them."""
        stated = replace(
            table,
            error_estimate=self.band,
            metadata=metadata,
            curve_error=self.curve_error,
            load_arm_error=self.load_arm_error,
            interval_error=self.interval_error,
        )
        return stated if self.inserted is None else with_support_loads(stated, self.inserted)

    def with_derivatives(self, derived: DerivedCycle | None) -> AssessedTable:
        """Return them with what derivatives miss, if any base pitch of the table is by them."""
        if derived is None or not derived.tables:
            return self
        errors = [table.errors[:3] for table in derived.tables]
        band, curves, arms = map(derived.places.gathered, map(list, zip(*errors, strict=True)))
        return replace(
            self,
            band=self.band + band,
            curve_error=np.concatenate([self.curve_error, curves[None]]),
            load_arm_error=np.concatenate([self.load_arm_error, arms[None]]),
            by_source=self.by_source | {f"{DERIVATIVES}_m": _largest_known(band)},
        )

    def to_json(self) -> Json:
        """Return what the receipt says of the errors."""
        sources = {"error_by_source": self.by_source, "held_out": self.held_out}
        bias = {"bias": self.bias.to_json()} if self.bias else {}
        return sources | bias | _summary(self.curve_error)


def assessed_table(made: SolvedTable, coarse: OperatingPoints) -> tuple[AssessedTable, SolvedTable]:
    """Solve a table once more on each rougher discretization, and held-out points of its axes.

    Parameters
    ----------
    made : SolvedTable
        On the meshes of the run.
    coarse : OperatingPoints
        Its places on the coarse meshes.

    Returns
    -------
    AssessedTable, SolvedTable
        The errors, and the table with the alignments that were inserted, which they are of.
    """
    table, plan, fine, nodes = made.table, made.plan, made.places, made.nodes
    discretization, solutions = plan.discretization, [solution for _, solution in made.solved]
    axes = plan.load, table.misalignment, table.center_distance_change
    sample = TableSample.of(nodes.position, fine.period, axes)
    own = sample.taken(table)
    plane = sample.solved(fine.in_plane_strain, fine) if discretization.corrected else own
    slices = discretization.slices > 1
    sliced = sample.solved(fine.in_slices(discretization.coarse_slices), fine) if slices else own
    patched = sample.solved(fine.in_plane_strain.in_coarse_patches, fine)
    nested = Nested(sample, own, plane, patched, sample.solved(coarse, fine), sliced)
    positions = position_errors(nodes, fine, solutions, plan)
    ste, arms = nested.parts
    measured = fine, made.solved, ste, positions, plan
    sources, errors = estimate_errors(*measured), curve_errors(*measured)
    request = made.checked.request

    def goal_of(refined: SteDatabase) -> IntervalGoal:
        at_nodes, bias = _at_inserted(errors, refined), table_bias(refined, fine, plan)
        return interval_goal(refined, at_nodes, request, bias)

    refined = request.options.tolerance is not None and not request.nodes_alone
    held_out = held_out_axes(made, goal_of if refined else None)
    made = held_out.made
    of_points, of_curves = interval_errors((plan.load.size, *made.places.shape), held_out.axes)
    assessed = AssessedTable(
        _at_inserted(sources.total, made.table),
        np.concatenate([_at_inserted(errors, made.table), of_curves]),
        _at_inserted(load_arm_errors(fine, table, arms, plan), made.table),
        of_points,
        held_out.loads,
        sources.to_json(),
        {name: error.to_json() for name, error in held_out.axes.items()},
        table_bias(made.table, fine, plan),
    )
    return assessed, made


def _at_inserted(errors: FloatArray, table: SteDatabase) -> FloatArray:
    """Carry errors (..., m, d) at the requested alignments of a table on to all, (..., M, D), linearly."""
    for axis, name in enumerate((MISALIGNMENT, CENTER_DISTANCE), start=-2):
        requested = np.flatnonzero(table.requested_rows(name))
        errors = spread(getattr(table, name), requested, errors, axis)
    return errors


def unassessed_table(table: SteDatabase, points: OperatingPoints, plan: Plan) -> AssessedTable:
    """Return the errors of a table of which none was estimated, but for what is known in closed form."""
    bias = table_bias(table, points, plan)
    unknown = np.full(table.error_estimate.shape, np.nan)
    errors = np.full((len(SOURCES), QUANTITIES, plan.load.size, *points.shape), np.nan)
    of_points = errors[: len(BETWEEN_NODES), 0]
    return AssessedTable(unknown, errors, errors[: len(OF_LOAD_ARM)], of_points, None, {}, {}, bias)


def table_bias(table: SteDatabase, points: OperatingPoints, plan: Plan) -> PlaneBias | None:
    """Return what the plane leaves out of the curves of a table."""
    pair, ste = points.nominal.pair, table.static_transmission_error
    bias = plane_bias(pair, plan.discretization)
    mean = mean_of_curves(table.position, ste, table.period)
    return bias and bias.of_curves(mean, np.ptp(ste, axis=0))
