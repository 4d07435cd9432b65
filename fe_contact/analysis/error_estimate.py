"""How wrong a table is, by source.

The finite-element error comes from a second, half as fine discretisation solved at the same points: with
quadratic elements and Galerkin patches the difference shrinks at least fourfold per halving, so a third of it
bounds what is left. The table's error is measured at the middles between its nodes. The contact solver's
error is its force tolerance times the tangent. What the plane model leaves out against a gear of finite width
is reported beside these and not added in.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.contact import ContactSolution
from fe_contact.types import FloatArray, Json

CONVERGENCE_FACTOR = 1.0 / 3.0
"""Remaining error over the difference of two meshes of ratio two, at second order."""

PLANE_FOR_FINITE_WIDTH = 0.03
"""Relative excess of a 3-D gear's STE over plane strain: 1.018 to 1.030 for widths of 6 to 20 modules."""


@dataclass(frozen=True)
class ErrorSources:
    """Error of STE in m by source.

    Attributes
    ----------
    discretisation : ndarray, shape (P, F)
    interpolation : ndarray, shape (P, F)
        Beside the node.
    contact : ndarray, shape (P, F)
    """

    discretisation: FloatArray
    interpolation: FloatArray
    contact: FloatArray

    @property
    def total(self) -> FloatArray:
        """Sum of the sources at each point (P, F), m."""
        return self.discretisation + self.interpolation + self.contact

    def to_json(self) -> Json:
        """Return the largest of each source by load, m, and the model's own uncertainty."""
        return {
            "discretisation_m": self.discretisation.max(axis=0).tolist(),
            "table_interpolation_m": self.interpolation.max(axis=0).tolist(),
            "contact_solver_m": self.contact.max(axis=0).tolist(),
            "plane_for_finite_width_relative": PLANE_FOR_FINITE_WIDTH,
        }


def error_sources(fine: ContactSolution, coarse: FloatArray, interpolation: FloatArray) -> ErrorSources:
    """Combine the measured differences.

    Parameters
    ----------
    fine : ContactSolution
        P positions, F loads.
    coarse : ndarray, shape (P, F)
        STE in m on the coarser meshes.
    interpolation : ndarray, shape (P, F)
        Error beside the nodes, m.
    """
    difference = np.nan_to_num(np.abs(fine.deflection - coarse)) * CONVERGENCE_FACTOR
    contact = np.nan_to_num(np.abs(fine.deflection)) * fine.residuals.max(axis=2)
    return ErrorSources(difference, interpolation, contact)
