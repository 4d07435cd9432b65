"""Contact of given compliance under a given torque: complementarity by a primal-dual active set.

A hat is a piecewise linear shape of the pressure along the slave's profile (`weak_gap`). The weak gap of a
hat is the integral of the gap times the hat. The lag is the turn of the driven gear along its base circle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_contact.types import BoolArray, FloatArray, Status

MAX_ITERATIONS = 100


@dataclass(frozen=True)
class ContactSystem:
    """A linear complementarity problem in h hats and the lag."""

    gap: FloatArray
    """Weak gaps without pressure or lag, m^2. Shape (h,)."""
    compliance: FloatArray
    """Compliance, symmetric positive definite, m^2/Pa. Shape (h, h)."""
    closing: FloatArray
    """Closing of the gaps by the lag, -d gap / d lag, m. Shape (h,)."""
    lever: FloatArray
    """Moment about gear 1's center by unit pressures, m^2. Shape (h,)."""
    weight: FloatArray
    """Weights of the hats, m: gap over weight is a length. Shape (h,)."""


@dataclass(frozen=True)
class ActiveSetSolution:
    """Solution of a `ContactSystem`."""

    pressure: FloatArray
    """Pressure of the hats, Pa. Shape (h,)."""
    lag: float
    """Lag of the driven gear, m."""
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
    while iteration < MAX_ITERATIONS:
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
    minimum = reached.min()
    return np.asarray(reached <= minimum + 1e-6 * max(system.weight.max(), abs(minimum)))


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
