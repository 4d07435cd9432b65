"""Full finite-element contact of a pair by condensation: positions x torques."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fe_contact.errors import InputError, MeshError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.types import Status
from model_studies.progress import Report
from model_studies.stage_clock import StageClock
from verification.full_contact.condensation.contact_model import ContactModel, PlaneStrain, softness
from verification.full_contact.condensation.linearized_contact import (
    ActiveSetSolution,
    Configuration,
    ContactGeometry,
    LinearizedContact,
    Solution,
    solve_active_set,
)
from verification.full_contact.condensation.placed_mesh import placed_bodies
from verification.full_contact.condensation.sites import Range, Resolution, contact_sites, least_gap_left_out
from verification.full_contact.table import FullContactPoint, FullContactTable, SolvedPosition, tables_of
from verification.full_contact.validity import check_axes, refusal

# One position of one contact geometry under all torques, settled on the deformed gears.


MOST_EVALUATIONS, SETTLED, ENOUGH = 6, 1e-6, 2e-4
"""Geometries of the deformed bodies; changes of the lag that end them, and that are the most allowed."""
LARGEST_RESIDUAL = 1e-8
ATTEMPTS = 4
WIDER = 1.6
COARSER = 1.5


def _solve_loads(
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


# One position under all torques: one mesh and one condensation of each gear.


def _solve_position(
    model: ContactModel,
    pair: ParallelAxes,
    torques: Sequence[float],
    position: float,
    resolution: Resolution,
) -> SolvedPosition:
    """Solve one position, in base pitches of the driving gear, for torques on gear 1 in N m.

    Where there is no mesh or no body it has no unknowns, and points that say why.
    """
    try:
        return _solved(model, pair, torques, position, resolution)
    except (MeshError, SolveError) as error:
        reason = str(error)
        lost = tuple(
            FullContactPoint.failed(Status.NOT_COMPUTED, reason, torque=torque) for torque in torques
        )
        return SolvedPosition((lost,) * model.count, 0)


def _solved(
    model: ContactModel,
    pair: ParallelAxes,
    torques: Sequence[float],
    position: float,
    resolution: Resolution,
) -> SolvedPosition:
    """Mesh and solve; again with more pairs or longer strips where those do not hold the contact."""
    phase = position - round(position)
    least, most = (float(pair.normal_force(torque)) for torque in (min(torques), max(torques)))
    loads = least / pair.face_width, model.largest_line_load(pair, most)
    closer = model.closer(pair)
    held = Range(loads, 1.5 * loads[1] * softness(pair) + closer)
    for _ in range(ATTEMPTS):
        sites = contact_sites(pair, phase, held, resolution)
        meshes = placed_bodies(pair, phase, sites, resolution)
        geometries, unknowns = model.geometries(pair, sites, meshes, resolution.layers)
        solved = tuple(_solve_loads(geometry, torques, position) for geometry in geometries)
        points = [point for contact in solved for point in contact]
        lags = [point.transmission_error for point in points if point.status.usable]
        lag = max(lags, default=0.0) + closer
        cut_off = any(point.status is Status.OUT_OF_MODEL for point in points)
        if lag < least_gap_left_out(pair, phase, sites) and not cut_off:
            break
        held = Range(loads, max(held.lag, 1.3 * lag), held.longer * (WIDER if cut_off else 1.0))
    return SolvedPosition(solved, unknowns)


def solve_full_contact(
    pair: ParallelAxes,
    torques: Sequence[float],
    positions: Sequence[float],
    resolution: Resolution | None = None,
    *,
    estimate_error: bool = False,
    report: Report | None = None,
) -> FullContactTable:
    """Solve the contact of a spur pair in plane strain with all teeth, bodies and the contact strip resolved.

    Each position has its own mesh of both gears and one factorisation of each, from which all torques are
    solved: no penalty, no law of Hertz. The contact is re-evaluated on the deformed bodies. Raises
    `InputError`: a pair that plane strain or the meshes do not hold, or a torque that is not positive.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Spur, clamped, solid; flanks that are modified along the profile alone (`refusal`).
    torques : sequence of float
        On gear 1, N m, > 0.
    positions : sequence of float
        By the driving gear, base pitches.
    estimate_error : bool
        Solve every position on a coarser mesh too and state the difference as error, at about half the cost
        again.
    report : callable, optional
        Called with the fraction done before each position.

    Returns
    -------
    FullContactTable
        Every point with its status, residual and iterations.
    """
    if (reason := refusal(pair)) is not None:
        raise InputError("pair", "this pair", f"one that full contact in the plane holds; {reason}")
    check_axes(torques, positions)
    meshes = resolutions(resolution or Resolution(), estimate_error=estimate_error)
    (table,) = contact_tables(PlaneStrain(), pair, torques, positions, meshes, report)
    return table


def contact_tables(
    model: ContactModel,
    pair: ParallelAxes,
    torques: Sequence[float],
    positions: Sequence[float],
    meshes: Sequence[Resolution],
    report: Report | None,
) -> tuple[FullContactTable, ...]:
    """Solve all positions on each mesh; return a table for each contact of the model.

    The first mesh is that of the result; its difference from a second one is stated as error.
    """
    solved: list[SolvedPosition] = []
    for count, position in enumerate(positions):
        if report is not None:
            report(count / len(positions))
        clock = StageClock()
        with clock.stage("position"):
            found = [_solve_position(model, pair, torques, position, mesh) for mesh in meshes]
        one = found[0].with_error(found[1]) if len(found) > 1 else found[0]
        solved.append(replace(one, cpu_seconds=clock.seconds["position"]))
    return tables_of(positions, torques, solved)


def resolutions(resolution: Resolution, *, estimate_error: bool) -> tuple[Resolution, ...]:
    """Return the meshes to solve on: the coarser one too where the error is requested."""
    return (resolution, resolution.coarser(COARSER)) if estimate_error else (resolution,)
