"""Errors of a table, by source.

The finite-element error comes from a second, coarser discretization solved at the same points; with
quadratic elements and Galerkin patches the error falls at least with the square of the element size, which
bounds what is left of the difference (`Discretization.remaining`). The table's error is measured at the
middles between its nodes. Where the plane stands in for three dimensions, a part of what it was corrected by
is its error; it is measured against three-dimensional solutions (docs/effects/finite_width.md). A plane that
is not corrected, requested by name or not, errs by what it leaves out of the finite width.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.estimates.position_errors import PositionErrors
from fe_contact.analysis.estimates.solved_again import TableSample
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.contact import ContactSolution
from fe_contact.planning import LEFT_OUT, Plan, left_out
from fe_contact.planning.model_error import point_error
from fe_contact.types import FloatArray, Json, Status

CORRECTION_ERROR = 0.03
"""Error of the correction for a finite width in parts of the correction itself. The largest seen of mean,
peak-to-peak and harmonics on its pairs (docs/accuracy.md, "Constants") is 0.033, of peak-to-peak at a face of
1.2 modules, of which the mesh covers its part."""


@dataclass(frozen=True)
class ErrorSources:
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
) -> ErrorSources:
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
    return ErrorSources(
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
