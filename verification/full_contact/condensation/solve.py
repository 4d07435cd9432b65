"""Full finite-element contact of a pair by condensation: positions x torques."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from fe_contact.errors import InputError, MeshError, SolveError
from fe_contact.geometry import ParallelAxes
from fe_contact.types import Status
from model_studies.progress import Report
from model_studies.stage_clock import StageClock
from verification.full_contact.condensation.contact_model import ContactModel, PlaneStrain, softness
from verification.full_contact.condensation.placed_mesh import placed_bodies
from verification.full_contact.condensation.resolution import Resolution
from verification.full_contact.condensation.settled_contact import solve_loads
from verification.full_contact.condensation.sites import Range, contact_sites, least_omitted_gap
from verification.full_contact.solved_position import SolvedPosition, tables_of
from verification.full_contact.table import FullContactPoint, FullContactTable
from verification.full_contact.validity import check_axes, refusal

ATTEMPTS = 4
WIDER = 1.6
COARSER = 1.5


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
    """Mesh and solve; repeat with more pairs or longer strips where these do not contain the contact."""
    phase = position - round(position)
    minimum, maximum = (float(pair.normal_force(torque)) for torque in (min(torques), max(torques)))
    loads = minimum / pair.face_width, model.largest_line_load(pair, maximum)
    closer = model.closer(pair)
    load_range = Range(loads, 1.5 * loads[1] * softness(pair) + closer)
    for _ in range(ATTEMPTS):
        sites = contact_sites(pair, phase, load_range, resolution)
        meshes = placed_bodies(pair, phase, sites, resolution)
        geometries, unknowns = model.geometries(pair, sites, meshes, resolution.layers)
        solved = tuple(solve_loads(geometry, torques, position) for geometry in geometries)
        points = [point for contact in solved for point in contact]
        lags = [point.transmission_error for point in points if point.status.usable]
        lag = max(lags, default=0.0) + closer
        cut_off = any(point.status is Status.OUT_OF_MODEL for point in points)
        if lag < least_omitted_gap(pair, phase, sites) and not cut_off:
            break
        load_range = Range(
            loads, max(load_range.lag, 1.3 * lag), load_range.longer * (WIDER if cut_off else 1.0)
        )
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
            by_mesh = [_solve_position(model, pair, torques, position, mesh) for mesh in meshes]
        with_error = by_mesh[0].with_error(by_mesh[1]) if len(by_mesh) > 1 else by_mesh[0]
        solved.append(replace(with_error, cpu_seconds=clock.seconds["position"]))
    return tables_of(positions, torques, solved)


def resolutions(resolution: Resolution, *, estimate_error: bool) -> tuple[Resolution, ...]:
    """Return the meshes to solve on: the coarser one too where the error is requested."""
    return (resolution, resolution.coarser(COARSER)) if estimate_error else (resolution,)
