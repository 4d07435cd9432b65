"""Results of the full contact: one point, and the table over positions and torques."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from bounds.brief import brief
from fe_contact.types import FloatArray, IntArray, Json, Status
from verification.full_contact.line_load import LineLoad

NOTHING = float("nan")


@dataclass(frozen=True)
class FullContactPoint:
    """One solved position under one torque, or the reason why there is no solution."""

    position: float
    """Position of the driving gear, base pitches; NaN without a solution."""
    transmission_error: float
    """Transmission error r_b1 theta_1 - r_b2 theta_2, m, >= 0 under load; NaN without a solution."""
    status: Status
    reason: str
    """Reason why there is no solution; empty if the iteration converged."""
    iterations: int
    residual: float
    """Largest relative breach of the laws that are checked: the moment of the bore's reactions is the torque
    and, for the condensed peer, u f = p C p, pressures and gaps are >= 0, and one of them is 0.
    """
    torque_ratio: float
    """Torque of gear 2 over that of gear 1."""
    torque: float = NOTHING
    """Torque on gear 1, N m; NaN if not known."""
    load_share: Mapping[int, float] = field(default_factory=dict)
    """Share of each pair in the torque on gear 1, by pair index; empty if not known."""
    max_pressure: float = NOTHING
    """Largest pressure as a mean over the length of an element, Pa. Under a tip edge it grows without bound
    as the mesh is refined. NaN if not known.
    """
    error_estimate: float = NOTHING
    """Half-width of the discretization's error band, m; NaN if not requested."""
    line_loads: tuple[LineLoad, ...] = ()
    """Line loads of the pairs over the face; empty for a plane solution."""

    @classmethod
    def failed(
        cls, status: Status, reason: str, iterations: int = 0, torque: float = NOTHING
    ) -> FullContactPoint:
        """Return a point without a solution."""
        return cls(NOTHING, NOTHING, status, reason, iterations, NOTHING, NOTHING, torque)

    def to_json(self) -> Json:
        """Return plain JSON; a point without a solution has its status and reason only."""
        content: Json = {"status": self.status.name.lower(), "iterations": self.iterations}
        if np.isfinite(self.torque):
            content["torque_n_m"] = self.torque
        if not self.status.usable:
            return content | {"reason": self.reason}
        content |= {
            "position": self.position,
            "transmission_error_m": self.transmission_error,
            "equilibrium_residual": self.residual,
            "torque_ratio": self.torque_ratio,
        }
        if np.isfinite(self.error_estimate):
            content["error_estimate_m"] = self.error_estimate
        return content


@brief
@dataclass(frozen=True)
class FullContactTable:
    """Solved positions x torques; each point has a status."""

    position: FloatArray
    """Position of the driving gear, base pitches. Shape (P,)."""
    torque: FloatArray
    """Torque on gear 1, N m. Shape (T,)."""
    points: tuple[tuple[FullContactPoint, ...], ...]
    """Points, P rows of T."""
    unknowns: IntArray
    """Displacements of all nodes of both gears; 0 where there is no mesh. Shape (P,)."""
    cpu_seconds: FloatArray
    """CPU seconds of each position with its mesh. Shape (P,)."""

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
