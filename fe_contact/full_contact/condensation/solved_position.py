"""One position under all torques: one mesh and one condensation of each gear."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fe_contact.errors import MeshError, SolveError
from fe_contact.full_contact.condensation.contact_model import ContactModel, softness
from fe_contact.full_contact.condensation.loaded_geometry import solve_loads
from fe_contact.full_contact.condensation.placed_mesh import placed_bodies
from fe_contact.full_contact.condensation.resolution import Resolution
from fe_contact.full_contact.condensation.sites import Range, contact_sites, least_gap_left_out
from fe_contact.full_contact.point import FullContactPoint
from fe_contact.geometry import ParallelAxes
from fe_contact.types import Status

ATTEMPTS = 4
WIDER = 1.6
Loads = tuple[FullContactPoint, ...]


@dataclass(frozen=True)
class SolvedPosition:
    """Points of each contact of the model under all torques, and the unknowns of both bodies."""

    contacts: tuple[Loads, ...]
    unknowns: int


def solve_position(
    model: ContactModel,
    pair: ParallelAxes,
    torques: Sequence[float],
    position: float,
    resolution: Resolution,
) -> SolvedPosition:
    """Solve one position.

    Parameters
    ----------
    model : ContactModel
    pair : GearPair or InternalGearPair
        That the model holds.
    torques : sequence of float
        On gear 1, N m, > 0.
    position : float
        By the driving gear, base pitches; any.
    resolution : Resolution

    Returns
    -------
    SolvedPosition
        Without unknowns, and points that say why, where there is no mesh or no body.
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
        solved = tuple(solve_loads(geometry, torques, position) for geometry in geometries)
        points = [point for contact in solved for point in contact]
        lags = [point.transmission_error for point in points if point.status.usable]
        lag = max(lags, default=0.0) + closer
        cut_off = any(point.status is Status.OUT_OF_MODEL for point in points)
        if lag < least_gap_left_out(pair, phase, sites) and not cut_off:
            break
        held = Range(loads, max(held.lag, 1.3 * lag), held.longer * (WIDER if cut_off else 1.0))
    return SolvedPosition(solved, unknowns)
