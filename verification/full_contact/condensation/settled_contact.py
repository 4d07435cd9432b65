"""One position of one contact geometry under all torques, settled on the deformed gears."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.types import Status
from verification.full_contact.condensation.active_set import ActiveSetSolution, solve_active_set
from verification.full_contact.condensation.linearized_contact import (
    Configuration,
    ContactGeometry,
    LinearizedContact,
    Solution,
)
from verification.full_contact.table import FullContactPoint

MAX_EVALUATIONS, SETTLED, ENOUGH = 6, 1e-6, 2e-4
"""Geometries of the deformed bodies; changes of the lag that end them, and that are the most allowed."""


LARGEST_RESIDUAL = 1e-8


def solve_loads(
    geometry: ContactGeometry, torques: Sequence[float], position: float
) -> tuple[FullContactPoint, ...]:
    """Solve all torques from the same compliance, then check them together."""
    undeformed = geometry.linearized(geometry.undeformed)
    states = [_settled(geometry, undeformed, torque) for torque in torques]
    solutions = [
        Solution(state.contact, state.solution.pressure, torque / geometry.thickness)
        for state, torque in zip(states, torques, strict=True)
    ]
    checks = geometry.checks(solutions)
    return tuple(
        _point(geometry, state, position, torque, check)
        for state, torque, check in zip(states, torques, checks, strict=True)
    )


@dataclass(frozen=True)
class _Settled:
    """Solution on the deformed geometry, iterations of all solves, and the lag's last relative change."""

    contact: LinearizedContact
    solution: ActiveSetSolution
    iterations: int
    change: float


def _settled(geometry: ContactGeometry, undeformed: LinearizedContact, torque: float) -> _Settled:
    """Solve on the undeformed geometry, then on that which the solution before it makes."""
    line_torque = torque / geometry.thickness
    contact, solution = undeformed, solve_active_set(undeformed.system, line_torque)
    iterations, change = solution.iterations, np.inf
    for _ in range(MAX_EVALUATIONS):
        displacements = (
            contact.displacement[0] @ solution.pressure,
            contact.displacement[1] @ solution.pressure,
        )
        contact = geometry.linearized(Configuration(solution.lag, displacements))
        following = solve_active_set(contact.system, line_torque)
        iterations += following.iterations
        change = abs(following.lag / solution.lag - 1.0)
        solution = following
        if change < SETTLED:
            break
    return _Settled(contact, solution, iterations, change)


def _point(
    geometry: ContactGeometry, state: _Settled, position: float, torque: float, check: tuple[float, float]
) -> FullContactPoint:
    contact, solution = state.contact, state.solution
    residual = max(solution.residual, check[0])
    status, reason = _status(state, residual)
    if not status.usable:
        return FullContactPoint.failed(status, reason, state.iterations, torque)
    moments = contact.system.lever * solution.pressure
    share = {
        site.ahead: float(moments[contact.site == number].sum() / moments.sum())
        for number, site in enumerate(geometry.sites)
    }
    return FullContactPoint(
        position=position,
        transmission_error=solution.lag,
        status=status,
        reason="",
        iterations=state.iterations,
        residual=residual,
        torque_ratio=check[1],
        torque=torque,
        load_share=share,
        max_pressure=_largest_pressure(contact, solution),
        line_loads=geometry.line_loads(contact, solution.pressure),
    )


def _largest_pressure(contact: LinearizedContact, solution: ActiveSetSolution) -> float:
    """Return the largest mean pressure over the length of an element, Pa: two hats stand on each."""
    largest = 0.0
    for number in np.unique(contact.line):
        pressure = solution.pressure[contact.line == number]
        means = np.convolve(pressure, [0.25, 0.5, 0.25], mode="same")
        largest = max(largest, float(means.max()))
    return largest


def _status(state: _Settled, residual: float) -> tuple[Status, str]:
    if not state.solution.status.usable or not residual < LARGEST_RESIDUAL:
        return Status.ITERATION_LIMIT, f"the active set did not settle: residual {residual:.1e}"
    if not state.change < ENOUGH:
        return Status.ITERATION_LIMIT, f"the deformed geometry did not settle: change {state.change:.1e}"
    if np.any(state.solution.pressure[state.contact.at_end] > 0.0):
        return Status.OUT_OF_MODEL, "the contact reaches the end of the strip that is meshed for it"
    return Status.CONVERGED, ""
