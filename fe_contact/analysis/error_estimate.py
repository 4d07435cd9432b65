"""How wrong a table is, by source.

The finite-element error comes from a second, coarser discretisation solved at the same points; with
quadratic elements and Galerkin patches the error falls at least with the square of the element size, which
bounds what is left of the difference (`Discretisation.remaining`). The table's error is measured at the
middles between its nodes. What the plane model leaves out against a gear of finite width is reported beside
these and not added in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.analysis.position_nodes import PositionNodes
from fe_contact.analysis.table_places import Places
from fe_contact.contact import ContactSolution
from fe_contact.geometry.finite_width import finite_width_excess
from fe_contact.planning import Plan
from fe_contact.types import FloatArray, Json, Status


@dataclass(frozen=True)
class ErrorSources:
    """Error of STE in m by source; arrays (P, F, M, D).

    Attributes
    ----------
    discretisation, interpolation, contact : ndarray
        Finite elements, table beside the node, contact solver.
    model : float
        Relative excess of the mean STE that the plane model leaves out; 0 in three dimensions.
    """

    discretisation: FloatArray
    interpolation: FloatArray
    contact: FloatArray
    model: float

    @property
    def total(self) -> FloatArray:
        """Sum of the numerical sources at each point, m."""
        return self.discretisation + self.interpolation + self.contact

    def to_json(self) -> Json:
        """Return the largest of each source by load, m, and the model's own uncertainty."""
        sources = {
            "discretisation_m": self.discretisation,
            "table_interpolation_m": self.interpolation,
            "contact_solver_m": self.contact,
        }
        worst = {name: values.max(axis=(0, 2, 3)).tolist() for name, values in sources.items()}
        return worst | {"plane_for_finite_width_relative": self.model}


def estimate_errors(
    places: Places,
    fine: list[ContactSolution],
    coarse: list[ContactSolution],
    nodes: PositionNodes,
    plan: Plan,
) -> ErrorSources:
    """Combine the measured differences.

    Parameters
    ----------
    places : Places
    fine, coarse : list of ContactSolution
        Of every place, on both meshes.
    nodes : PositionNodes
        With the interpolation error of the judged places; the largest of them stands for every place.
    plan : Plan
    """
    made = plan.discretisation
    differences = [
        np.nan_to_num(np.abs(one.deflection - other.deflection)) * made.remaining
        for one, other in zip(fine, coarse, strict=True)
    ]
    judged = nodes.error.reshape(len(nodes.error), -1, plan.load.size).max(axis=1)
    return ErrorSources(
        places.gathered(differences),
        places.gathered([judged] * len(fine)),
        places.gathered([contact_error(solution) for solution in fine]),
        0.0 if made.slices > 1 else finite_width_excess(places.places[0].contact.pair),
    )


def contact_error(solution: ContactSolution) -> FloatArray:
    """Return the contact solver's error (P, F): its largest relative residual times the STE, m."""
    worst = np.nan_to_num(solution.residuals.max(axis=2), posinf=0.0)
    return np.asarray(np.nan_to_num(np.abs(solution.deflection)) * worst)


def worst_residual(solution: ContactSolution) -> float:
    """Return the largest of the four residuals over all converged points."""
    good = solution.status == Status.CONVERGED
    return float(solution.residuals[good].max()) if good.any() else 0.0
