"""Errors of a table, by source.

The finite-element error comes from a second, coarser discretization solved at the same points. With quadratic
elements and Galerkin patches the error falls at least with the square of the element size; so the error is at
most a known part of the difference (`Discretization.remaining`). The table's error is measured at the middles
between its nodes. Where a plane model is corrected for the finite width, a part of the correction is its
error; that part is measured against three-dimensional solutions (docs/effects.md#finite_width). A plane that
is not corrected has the errors of its model, and a bias of known sign by the finite width (`ste.plane_bias`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.estimates.position_errors import PositionErrors
from fe_contact.analysis.estimates.rough_flank_errors import rough_flank_errors
from fe_contact.analysis.estimates.table_sample import Nested
from fe_contact.analysis.pairs.operating_points import OperatingPoints
from fe_contact.analysis.request.solved_run import Solved
from fe_contact.contact import ContactSolution
from fe_contact.geometry.finite_width import correction_error
from fe_contact.planning.discretization import FaceDiscretization
from fe_contact.planning.model_error import point_error
from fe_contact.planning.plan import Plan
from fe_contact.ste.curve_errors import METHOD, PLANE
from fe_contact.types import FloatArray, Json, Status


@dataclass(frozen=True)
class _ErrorSources:
    """Error of STE in m by source; arrays (P, F, M, D)."""

    discretization: FloatArray
    """Error by finite elements and load patches."""
    slices: FloatArray
    interpolation: FloatArray
    """Error between positions."""
    contact: FloatArray
    """Error of the contact solution."""
    plane: FloatArray
    """Error of a plane model for a finite width."""
    method: FloatArray
    """Error of the method against full contact."""

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
        return {name: largest_known(values) for name, values in sources.items()}


def largest_known(errors: FloatArray) -> list[float | None]:
    """Return the largest number of errors (P, F, M, D) at each load; None if there is none."""
    worst = np.where(np.isnan(errors), -np.inf, errors).max(axis=(0, 2, 3))
    return [float(value) if np.isfinite(value) else None for value in worst]


def estimate_errors(
    points: OperatingPoints, solved: Solved, nested: Nested, positions: PositionErrors, plan: Plan
) -> _ErrorSources:
    """Combine the measured differences to the errors of a table.

    Parameters
    ----------
    solved : list of (ContactProblem, ContactSolution)
        Problems and solutions of the table.
    positions : PositionErrors
        Errors between positions: the largest of the assessed operating points, for all of them.
    """
    discretization, nominal = plan.discretization, points.nominal.pair
    solutions = [solution for _, solution in solved]

    def left(finer: FloatArray, coarser: FloatArray, part: float) -> FloatArray:
        """Return a part of the differences of STE, the error that is left, at all points."""
        return nested.sample.spread_points(part * np.nan_to_num(np.abs(finer - coarser)))

    face = isinstance(discretization, FaceDiscretization)
    lags = [np.nan_to_num(solution.deflection) for solution in solutions]
    by_mesh = left(nested.patched, nested.coarse, discretization.remaining)
    by_patches = left(nested.plane, nested.patched, plan.remaining_patches)
    band = positions.band[:, :, None, None]
    smooth = points.gathered([point_error(nominal, plan.load, lag, over_face=face) for lag in lags])
    rough = points.gathered([rough_flank_errors(*contact) for contact in solved])
    return _ErrorSources(
        discretization=by_mesh + by_patches,
        slices=left(nested.table, nested.sliced, discretization.remaining_slices),
        interpolation=np.broadcast_to(band, (*positions.band.shape, *points.shape)),
        contact=points.gathered([contact_error(solution) for solution in solutions]),
        plane=left(nested.table, nested.plane, correction_error(nominal)),
        method=smooth + rough,
    )


def contact_error(solution: ContactSolution) -> FloatArray:
    """Return the contact solver's error (P, F): its largest relative residual times the STE, m."""
    worst = np.nan_to_num(solution.residuals.max(axis=2), posinf=0.0)
    return np.asarray(np.nan_to_num(np.abs(solution.deflection)) * worst)


def worst_residual(solution: ContactSolution) -> float:
    """Return the largest of the four residuals over all converged points."""
    good = (solution.status == Status.CONVERGED) & np.isfinite(solution.residuals[..., 0])
    return float(solution.residuals[good].max()) if good.any() else 0.0
