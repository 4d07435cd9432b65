"""Full contact of a pair at several positions under several torques."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.full_contact.point import FullContactPoint
from fe_contact.types import FloatArray, IntArray


@dataclass(frozen=True)
class FullContactTable:
    """Solved positions x torques; each point has its own status.

    Attributes
    ----------
    position : (P,) array
        By the driving gear, base pitches.
    torque : (T,) array
        On gear 1, N m.
    points : tuple of tuples of FullContactPoint
        P x T.
    unknowns : (P,) int array
        Displacements of all nodes of both gears; 0 where there is no mesh.
    cpu_seconds : (P,) array
        Of each position with its mesh.
    """

    position: FloatArray
    torque: FloatArray
    points: tuple[tuple[FullContactPoint, ...], ...]
    unknowns: IntArray
    cpu_seconds: FloatArray

    @property
    def transmission_error(self) -> FloatArray:
        """r_b1 theta_1 - r_b2 theta_2 (P, T) in m; NaN where there is no solution."""
        return np.array([[point.transmission_error for point in row] for row in self.points])

    @property
    def error_estimate(self) -> FloatArray:
        """Error of it by the discretization (P, T), m; NaN where it was not requested."""
        return np.array([[point.error_estimate for point in row] for row in self.points])

    @property
    def failed(self) -> tuple[FullContactPoint, ...]:
        """Points without a solution."""
        return tuple(point for row in self.points for point in row if not point.status.usable)
