"""One position under all torques: one mesh and one factorisation of each gear."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fe_contact.errors import MeshError, SolveError
from fe_contact.full_contact.condensation.active_set import ActiveSetSolution, solve_active_set
from fe_contact.full_contact.condensation.condensed_body import condensed_body
from fe_contact.full_contact.condensation.contact_geometry import (
    Configuration,
    LinearizedContact,
    PairGeometry,
)
from fe_contact.full_contact.condensation.equilibrium import bore_checks
from fe_contact.full_contact.condensation.placed_mesh import placed_bodies
from fe_contact.full_contact.condensation.resolution import Resolution
from fe_contact.full_contact.condensation.sites import Range, contact_sites, least_gap_left_out
from fe_contact.full_contact.point import FullContactPoint
from fe_contact.geometry import ParallelAxes
from fe_contact.types import Status

MESH_STIFFNESS = 20e9 / 210e9
"""Of steel teeth, about 20 N/(mm um), over the modulus of elasticity: a first guess of the deflection."""
MOST_EVALUATIONS, SETTLED, ENOUGH = 6, 1e-6, 2e-4
"""Geometries of the deformed bodies; changes of the lag that end them, and that are the most allowed."""
LARGEST_RESIDUAL = 1e-8
ATTEMPTS = 4
WIDER = 1.6


@dataclass(frozen=True)
class SolvedPosition:
    """Points under all torques, and the displacements of all nodes of both meshes."""

    points: tuple[FullContactPoint, ...]
    unknowns: int


def solve_position(
    pair: ParallelAxes, torques: Sequence[float], position: float, resolution: Resolution
) -> SolvedPosition:
    """Solve one position.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Without `refusal`.
    torques : sequence of float
        On gear 1, N m, > 0.
    position : float
        By the driving gear, base pitches; any.
    resolution : Resolution

    Returns
    -------
    SolvedPosition
        Points without a mesh or a solution say why.
    """
    try:
        return _solved(pair, torques, position, resolution)
    except (MeshError, SolveError) as error:
        lost = (FullContactPoint.failed(Status.NOT_COMPUTED, str(error), 0, torque) for torque in torques)
        return SolvedPosition(tuple(lost), 0)


def _solved(
    pair: ParallelAxes, torques: Sequence[float], position: float, resolution: Resolution
) -> SolvedPosition:
    """Mesh and solve; again with more pairs or longer strips where those do not hold the contact."""
    phase = position - round(position)
    forces = pair.normal_force(np.array([min(torques), max(torques)])) / pair.face_width
    loads = float(forces[0]), float(forces[1])
    softness = sum(0.5 / gear.material.youngs_modulus for gear in (pair.pinion, pair.wheel))
    held = Range(loads, 1.5 * loads[1] * softness / MESH_STIFFNESS)
    for _ in range(ATTEMPTS):
        sites = contact_sites(pair, phase, held, resolution)
        bodies = placed_bodies(pair, phase, sites, resolution)
        materials = (pair.pinion.material, pair.wheel.material)
        first, second = (condensed_body(b, m) for b, m in zip(bodies, materials, strict=True))
        geometry = PairGeometry(pair, sites, (first, second))
        solved = _all_loads(geometry, torques, position)
        lag = max((p.transmission_error for p in solved if p.status.usable), default=0.0)
        cut_off = any(point.status is Status.OUT_OF_MODEL for point in solved)
        if lag < least_gap_left_out(pair, phase, sites) and not cut_off:
            break
        held = Range(loads, max(held.lag, 1.3 * lag), held.longer * (WIDER if cut_off else 1.0))
    return SolvedPosition(solved, 2 * sum(len(body.points) for body in bodies))


def _all_loads(
    geometry: PairGeometry, torques: Sequence[float], position: float
) -> tuple[FullContactPoint, ...]:
    """Solve all torques from the same compliance, then check them together."""
    undeformed = geometry.linearized(geometry.undeformed)
    states = [_settled(geometry, undeformed, torque) for torque in torques]
    width = geometry.pair.face_width
    solutions = [(s.contact, s.solution.pressure, t / width) for s, t in zip(states, torques, strict=True)]
    checks = bore_checks(geometry, solutions)
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


def _settled(geometry: PairGeometry, undeformed: LinearizedContact, torque: float) -> _Settled:
    """Solve on the undeformed geometry, then on that which the solution before it makes."""
    line_torque = torque / geometry.pair.face_width
    contact, solution = undeformed, solve_active_set(undeformed.system, line_torque)
    iterations, change = solution.iterations, np.inf
    for _ in range(MOST_EVALUATIONS):
        moved = contact.moved[0] @ solution.pressure, contact.moved[1] @ solution.pressure
        contact = geometry.linearized(Configuration(solution.lag, moved))
        following = solve_active_set(contact.system, line_torque)
        iterations += following.iterations
        change = abs(following.lag / solution.lag - 1.0)
        solution = following
        if change < SETTLED:
            break
    return _Settled(contact, solution, iterations, change)


def _point(
    geometry: PairGeometry, state: _Settled, position: float, torque: float, check: tuple[float, float]
) -> FullContactPoint:
    """Gather a point, with its status."""
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
    )


def _largest_pressure(contact: LinearizedContact, solution: ActiveSetSolution) -> float:
    """Return the largest mean pressure over the length of an element, Pa: two hats stand on each."""
    largest = 0.0
    for number in np.unique(contact.site):
        pressure = solution.pressure[contact.site == number]
        means = np.convolve(pressure, [0.25, 0.5, 0.25], mode="same")
        largest = max(largest, float(means.max()))
    return largest


def _status(state: _Settled, residual: float) -> tuple[Status, str]:
    """Say whether a solution holds, and else why not."""
    if not state.solution.status.usable or not residual < LARGEST_RESIDUAL:
        return Status.ITERATION_LIMIT, f"the active set did not settle: residual {residual:.1e}"
    if not state.change < ENOUGH:
        return Status.ITERATION_LIMIT, f"the deformed geometry did not settle: change {state.change:.1e}"
    if np.any(state.solution.pressure[state.contact.at_end] > 0.0):
        return Status.OUT_OF_MODEL, "the contact reaches the end of the strip that is meshed for it"
    return Status.CONVERGED, ""
