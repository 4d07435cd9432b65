"""How wrong a table is, by source.

The finite-element error comes from a second, coarser discretisation solved at the same points; with
quadratic elements and Galerkin patches the error falls at least with the square of the element size, which
bounds what is left of the difference (`Discretisation.remaining`). The table's error is measured at the
middles between its nodes. Where the plane stands in for three dimensions, a part of what it was corrected by
is its error; it is measured against three-dimensional solutions (docs/effects/finite_width.md). What plane
strain leaves out where it was asked for is reported beside these and not added in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.position_errors import PositionErrors
from fe_contact.analysis.solved_again import TableSample
from fe_contact.analysis.table_places import Places
from fe_contact.compliance import PlaneHypothesis
from fe_contact.contact import ContactSolution
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.geometry.parallel_axes import ParallelAxes
from fe_contact.planning import Plan, PlaneDiscretisation
from fe_contact.planning.flank_tilt import LEFT_BY_TILT, flank_tilt
from fe_contact.types import FloatArray, Json, Status

CORRECTION_ERROR = 0.03
"""Error of the correction for a finite width in parts of the correction itself. The largest seen of mean,
peak-to-peak and harmonics on the cases of docs/accuracy.md that are not held out is 0.033, of peak-to-peak at
a face of 1.2 modules, of which the mesh covers its part."""


@dataclass(frozen=True)
class ErrorSources:
    """Error of STE in m by source; arrays (P, F, M, D).

    Attributes
    ----------
    discretisation, slices, interpolation, contact, finite_width : ndarray
        Finite elements, slices of the face, table beside the node, contact, correction of the plane.
    model : float
        Relative excess of the mean STE that plane strain leaves out; 0 where it is corrected for it, in plane
        stress, and in three dimensions.
    """

    discretisation: FloatArray
    slices: FloatArray
    interpolation: FloatArray
    contact: FloatArray
    finite_width: FloatArray
    model: float

    @property
    def total(self) -> FloatArray:
        """Sum of the sources at each point, m."""
        return self.discretisation + self.slices + self.interpolation + self.contact + self.finite_width

    def to_json(self) -> Json:
        """Return the largest of each source by load, m, and the model's own uncertainty.

        Beside a failed point errors are unknown and left out; None where that leaves none.
        """
        sources = {
            "discretisation_m": self.discretisation,
            "slices_m": self.slices,
            "table_interpolation_m": self.interpolation,
            "contact_solver_m": self.contact,
            "finite_width_m": self.finite_width,
        }
        worst = {name: _largest_known(values) for name, values in sources.items()}
        return worst | {"plane_for_finite_width_relative": self.model}


def _largest_known(errors: FloatArray) -> list[float | None]:
    """Return the largest number of errors (P, F, M, D) at each load; None if there is none."""
    worst = np.where(np.isnan(errors), -np.inf, errors).max(axis=(0, 2, 3))
    return [float(value) if np.isfinite(value) else None for value in worst]


@dataclass(frozen=True)
class Nested:
    """STE at some points of a table, from the run's own and rougher discretisations.

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

    def without_tilt(self, pair: ParallelAxes) -> FloatArray:
        """Return the table's own less what the tilt of the flanks takes off, m."""
        load = self.sample.axes[0][self.sample.nodes[0]]
        return np.asarray(self.table * (1.0 - flank_tilt(pair, load)[:, None, None]))


def estimate_errors(
    places: Places,
    solutions: list[ContactSolution],
    nested: Nested,
    positions: PositionErrors,
    plan: Plan,
    stands_in: float = 0.0,
) -> ErrorSources:
    """Combine the measured differences.

    Parameters
    ----------
    places : Places
    solutions : list of ContactSolution
        The table's.
    nested : Nested
    positions : PositionErrors
        The largest of the judged places stand for every place.
    plan : Plan
    stands_in : float
        Relative error of plane strain where it stands in for a finite width uncorrected.
    """
    made, pair = plan.discretisation, places.places[0].contact.pair

    def left(these: FloatArray, those: FloatArray, part: float) -> FloatArray:
        """Return a part of the differences of STE, at all points."""
        return nested.sample.spread_points(part * np.nan_to_num(np.abs(these - those)))

    free_ends = left(nested.table, nested.plane, CORRECTION_ERROR)
    if stands_in:
        curves = [stands_in * np.nan_to_num(np.abs(solution.deflection)) for solution in solutions]
        free_ends = places.gathered(curves)
    return ErrorSources(
        left(nested.plane, nested.coarse, made.remaining),
        left(nested.table, nested.sliced, made.remaining_slices),
        np.broadcast_to(positions.band[:, :, None, None], (*positions.band.shape, *places.shape)),
        places.gathered([contact_error(solution) for solution in solutions])
        + left(nested.table, nested.without_tilt(pair), LEFT_BY_TILT),
        free_ends,
        left_out(plan, pair),
    )


def left_out(plan: Plan, pair: ParallelAxes) -> float:
    """Return the relative excess of the mean STE that plane strain leaves out where it was asked for."""
    made = plan.discretisation
    asked = isinstance(made, PlaneDiscretisation) and made.hypothesis is PlaneHypothesis.PLANE_STRAIN
    return finite_width_excess(pair) if asked and not made.corrected else 0.0


def contact_error(solution: ContactSolution) -> FloatArray:
    """Return the contact solver's error (P, F): its largest relative residual times the STE, m."""
    worst = np.nan_to_num(solution.residuals.max(axis=2), posinf=0.0)
    return np.asarray(np.nan_to_num(np.abs(solution.deflection)) * worst)


def worst_residual(solution: ContactSolution) -> float:
    """Return the largest of the four residuals over all converged points."""
    good = solution.status == Status.CONVERGED
    return float(solution.residuals[good].max()) if good.any() else 0.0
