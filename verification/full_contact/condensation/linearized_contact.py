"""The contact linearized about a configuration, and its solution by an active set."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from fe_contact.geometry import ParallelAxes
from fe_contact.types import BoolArray, FloatArray, IntArray, Status
from verification.full_contact.condensation.sites import ContactSite
from verification.full_contact.table import LineLoad

# Contact of given compliance under a given torque: complementarity by a primal-dual active set.


MOST_ITERATIONS = 100
LEAST_FACING = 0.01
"""Hats of which less than this part of their length faces the mate carry no pressure."""


@dataclass(frozen=True)
class ContactSystem:
    """A linear complementarity problem in h hats and the lag."""

    gap: FloatArray
    """Weak gaps without pressure or lag, m^2. Shape (h,)."""
    compliance: FloatArray
    """Symmetric positive definite, m^2/Pa. Shape (h, h)."""
    closing: FloatArray
    """-d gap / d lag, m. Shape (h,)."""
    lever: FloatArray
    """Moment about gear 1's center by unit pressures, m^2. Shape (h,)."""
    weight: FloatArray
    """Of the hats, m: gap over weight is a length. Shape (h,)."""


@dataclass(frozen=True)
class ActiveSetSolution:
    """Solution of a `ContactSystem`."""

    pressure: FloatArray
    """Pa. Shape (h,)."""
    lag: float
    """m."""
    gap: FloatArray
    """Weak gaps, m^2. Shape (h,)."""
    status: Status
    iterations: int
    residual: float
    """Largest breach of the laws: pressures below zero over the largest one, gaps below zero over the lag,
    and the torque's relative error.
    """


def solve_active_set(
    system: ContactSystem, torque: float, start: BoolArray | None = None
) -> ActiveSetSolution:
    """Solve the contact under a torque per unit face width, N.

    Parameters
    ----------
    torque : float
        > 0.
    start : (h,) bool array, optional
        Hats that carry pressure to begin with; default: those whose gap is least.
    """
    active = _first(system) if start is None or not start.any() else start
    seen: set[bytes] = set()
    iteration = 0
    while iteration < MOST_ITERATIONS:
        iteration += 1
        pressure, lag = _with_active(system, torque, active)
        gap = system.gap + system.compliance @ pressure - system.closing * lag
        gap[active] = 0.0
        following = np.where(active, pressure > 0.0, gap < 0.0)
        if np.array_equal(following, active):
            break
        if following.tobytes() in seen or not following.any():
            following = _exchange_one(active, pressure, gap, system)
        seen.add(following.tobytes())
        active = following
    return _solution(system, torque, active, pressure, lag, iteration)


def _first(system: ContactSystem) -> BoolArray:
    """Return the hats that touch first."""
    reached = system.gap / system.closing
    least = reached.min()
    return np.asarray(reached <= least + 1e-6 * max(system.weight.max(), abs(least)))


def _with_active(system: ContactSystem, torque: float, active: BoolArray) -> tuple[FloatArray, float]:
    """Return pressures and lag with no gap at the active hats."""
    inside = system.compliance[np.ix_(active, active)]
    solved = np.linalg.solve(inside, np.column_stack([-system.gap[active], system.closing[active]]))
    lever = system.lever[active]
    lag = (torque - lever @ solved[:, 0]) / (lever @ solved[:, 1])
    pressure = np.zeros(len(active))
    pressure[active] = solved[:, 0] + lag * solved[:, 1]
    return pressure, float(lag)


def _exchange_one(
    active: BoolArray, pressure: FloatArray, gap: FloatArray, system: ContactSystem
) -> BoolArray:
    """Move over the one hat that breaks its law most, where moving all of them goes round in circles."""
    scale = np.diag(system.compliance)
    breach = np.where(active, -pressure, -gap / scale)
    following = active.copy()
    worst = int(np.argmax(breach))
    following[worst] = not following[worst]
    return following


def _solution(
    system: ContactSystem,
    torque: float,
    active: BoolArray,
    pressure: FloatArray,
    lag: float,
    iterations: int,
) -> ActiveSetSolution:
    gap = system.gap + system.compliance @ pressure - system.closing * lag
    largest = float(pressure.max())
    breaches = (
        -float(pressure.min()) / largest,
        float(np.max(-gap / system.weight)) / abs(lag),
        float(np.max(np.abs(gap[active]) / system.weight[active])) / abs(lag),
        abs(float(system.lever @ pressure) / torque - 1.0),
    )
    residual = max(0.0, *breaches)
    status = Status.CONVERGED if residual < 1e-8 else Status.ITERATION_LIMIT
    return ActiveSetSolution(pressure, lag, gap, status, iterations, residual)


@dataclass(frozen=True)
class Configuration:
    """Lag of the driven gear in m, and displacements (u_1,), (u_2,) of the strips of both gears, m."""

    lag: float
    displacements: tuple[FloatArray, FloatArray]


@dataclass(frozen=True)
class LinearizedContact:
    """Contact with the geometry and the forces of one configuration; h hats."""

    system: ContactSystem
    forces: tuple[FloatArray, FloatArray]
    moved: tuple[FloatArray, FloatArray]
    """`forces`, `moved`: Forces on the strips of both gears by unit pressures, and what displacements follow.
    ((u_1, h), (u_2, h)) arrays.
    """
    site: IntArray
    """Which site a hat belongs to. Shape (h,)."""
    line: IntArray
    """Hats of one number stand along one profile. Shape (h,)."""
    at_end: BoolArray
    """Hats at an end of their strip that is no tip edge: pressure there is cut off. Shape (h,)."""


class Solution(NamedTuple):
    """A contact, its pressures, and the torque on gear 1 over the thickness that they were to balance."""

    contact: LinearizedContact
    pressure: FloatArray
    torque: float


class ContactGeometry(Protocol):
    """Two condensed bodies that may touch at sites."""

    @property
    def pair(self) -> ParallelAxes:
        """The pair."""

    @property
    def sites(self) -> tuple[ContactSite, ...]:
        """Pairs of teeth that may touch."""

    @property
    def thickness(self) -> float:
        """Face width over which its forces are counted, m; 1 where they are counted over all of it."""

    @property
    def undeformed(self) -> Configuration:
        """Rigid gears in the conjugate position."""

    def linearized(self, at: Configuration) -> LinearizedContact:
        """Return the contact with the geometry and the forces of a configuration."""

    def checks(self, solutions: Sequence[Solution]) -> list[tuple[float, float]]:
        """Return the largest relative breach of the laws, and the torque of gear 2 over that of gear 1."""

    def line_loads(self, contact: LinearizedContact, pressure: FloatArray) -> tuple[LineLoad, ...]:
        """Return the load of every pair along the face; none in the plane."""


def rotation(angle: float) -> FloatArray:
    """Return the matrix that turns vectors counter-clockwise."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def turned_back(forces: FloatArray, turn: FloatArray) -> FloatArray:
    """Turn forces (2 k, h) on gear 2 back into the frame of its mesh."""
    vectors = forces.reshape(-1, 2, forces.shape[1])
    return np.asarray(np.einsum("yx,nyh->nxh", turn, vectors).reshape(forces.shape))
