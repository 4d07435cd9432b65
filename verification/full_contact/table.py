"""Results of the full contact: one point, and the table over positions and torques."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from bounds.brief import brief
from fe_contact.types import FloatArray, IntArray, Json, Status

# The transmission error of a pair at one position under one torque, by full finite-element contact.


NOTHING = float("nan")
_SAMPLES = 4001
"""Places of a load over the face between which its means are searched."""


@dataclass(frozen=True)
class LineLoad:
    """Load of a pair of teeth along the face, linear between stations."""

    ahead: int
    """Pair index."""
    face_position: FloatArray
    """From mid-face, m. Shape (k,)."""
    load: FloatArray
    """Normal force per length of contact line, N/m. Shape (k,)."""

    def largest_mean(self, length: float) -> float:
        """Return the largest mean over a length of the face within the stations, N/m."""
        face = np.linspace(self.face_position[0], self.face_position[-1], _SAMPLES)
        load = np.interp(face, self.face_position, self.load)
        force = np.concatenate([[0.0], np.cumsum(0.5 * (load[1:] + load[:-1]) * np.diff(face))])
        start = np.linspace(face[0], face[-1] - length, _SAMPLES)
        within = np.interp(start + length, face, force) - np.interp(start, face, force)
        return float(within.max() / length)


def line_loads(ahead: IntArray, face: FloatArray, force: FloatArray) -> tuple[LineLoad, ...]:
    """Return the line loads of pairs from forces (h,) in N on hats at face positions (h,), m.

    Forces are those along the face: per unit of the contact line's projection on the axis.
    """
    loads = []
    for pair in np.unique(ahead):
        stations, number = np.unique(face[ahead == pair], return_inverse=True)
        between = np.diff(stations)
        width = 0.5 * (np.append(between, 0.0) + np.insert(between, 0, 0.0))
        loads.append(LineLoad(int(pair), stations, np.bincount(number, force[ahead == pair]) / width))
    return tuple(loads)


@dataclass(frozen=True)
class FullContactPoint:
    """One solved position under one torque, or why there is none."""

    position: float
    """By the driving gear, base pitches; NaN without a solution."""
    transmission_error: float
    """r_b1 theta_1 - r_b2 theta_2 in m, >= 0 under load; NaN without a solution."""
    status: Status
    reason: str
    """Empty if it converged."""
    iterations: int
    residual: float
    """Largest relative breach of the laws that are checked: the moment of the bore's reactions is the torque
    and, for the condensed peer, u f = p C p, pressures and gaps are >= 0, and one of them is 0.
    """
    torque_ratio: float
    """Torque of gear 2 over that of gear 1."""
    torque: float = NOTHING
    """On gear 1, N m; NaN if not known."""
    load_share: Mapping[int, float] = field(default_factory=dict)
    """Share of each pair in the torque on gear 1, by pair index; empty if not known."""
    max_pressure: float = NOTHING
    """Over the length of an element, Pa; under a tip edge it grows without bound as the mesh is refined. NaN
    if not known.
    """
    error_estimate: float = NOTHING
    """Half-width of the discretization's error band, m; NaN if not requested."""
    line_loads: tuple[LineLoad, ...] = ()
    """Of the pairs over the face; none of a plane solution."""

    @classmethod
    def failed(
        cls, status: Status, reason: str, iterations: int = 0, torque: float = NOTHING
    ) -> FullContactPoint:
        """Return a point without a solution."""
        return cls(NOTHING, NOTHING, status, reason, iterations, NOTHING, NOTHING, torque)

    def to_json(self) -> Json:
        """Return plain JSON; a point without a solution has its status and reason only."""
        facts: Json = {"status": self.status.name.lower(), "iterations": self.iterations}
        if np.isfinite(self.torque):
            facts["torque_n_m"] = self.torque
        if not self.status.usable:
            return facts | {"reason": self.reason}
        facts |= {
            "position": self.position,
            "transmission_error_m": self.transmission_error,
            "equilibrium_residual": self.residual,
            "torque_ratio": self.torque_ratio,
        }
        if np.isfinite(self.error_estimate):
            facts["error_estimate_m"] = self.error_estimate
        return facts


@brief
@dataclass(frozen=True)
class FullContactTable:
    """Solved positions x torques; each point has its own status."""

    position: FloatArray
    """By the driving gear, base pitches. Shape (P,)."""
    torque: FloatArray
    """On gear 1, N m. Shape (T,)."""
    points: tuple[tuple[FullContactPoint, ...], ...]
    """P x T."""
    unknowns: IntArray
    """Displacements of all nodes of both gears; 0 where there is no mesh. Shape (P,)."""
    cpu_seconds: FloatArray
    """Of each position with its mesh. Shape (P,)."""

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


# Tables of several contacts, say misalignments, that were solved together position by position.


Loads = tuple[FullContactPoint, ...]
"""One position of one contact under all torques."""


@dataclass(frozen=True)
class SolvedPosition:
    """Points of each contact under all torques, the unknowns of both bodies, and CPU seconds."""

    contacts: tuple[Loads, ...]
    unknowns: int
    cpu_seconds: float = 0.0

    def with_error(self, coarse: SolvedPosition) -> SolvedPosition:
        """Return the same points; their differences from those of a coarser mesh are their errors."""
        both = zip(self.contacts, coarse.contacts, strict=True)
        return replace(self, contacts=tuple(_apart(own, other) for own, other in both))


def _apart(fine: Loads, coarse: Loads) -> Loads:
    return tuple(
        replace(own, error_estimate=abs(own.transmission_error - other.transmission_error))
        if own.status.usable
        else own
        for own, other in zip(fine, coarse, strict=True)
    )


def tables_of(
    positions: Sequence[float], torques: Sequence[float], solved: Sequence[SolvedPosition]
) -> tuple[FullContactTable, ...]:
    """Return a table for each contact; they share CPU seconds evenly."""
    count = len(solved[0].contacts)
    return tuple(
        FullContactTable(
            position=np.array(positions, dtype=float),
            torque=np.array(torques, dtype=float),
            points=tuple(position.contacts[number] for position in solved),
            unknowns=np.array([position.unknowns for position in solved], dtype=np.int64),
            cpu_seconds=np.array([position.cpu_seconds for position in solved]) / count,
        )
        for number in range(count)
    )
