"""Full finite-element contact of a pair by condensation: positions x torques."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from fe_contact.checks import finite, positive
from fe_contact.errors import InputError
from fe_contact.full_contact.condensation.contact_model import ContactModel, PlaneStrain
from fe_contact.full_contact.condensation.resolution import Resolution
from fe_contact.full_contact.condensation.solved_position import Loads, SolvedPosition, solve_position
from fe_contact.full_contact.condensation.table import FullContactTable
from fe_contact.full_contact.validity import refusal
from fe_contact.geometry import ParallelAxes
from fe_contact.stage_clock import StageClock

COARSER = 1.5
Report = Callable[[float], None]


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
    solved: no penalty, no law of Hertz. The contact is re-evaluated on the deformed bodies.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        Spur, clamped, solid; flanks that are modified along the profile alone (`refusal`).
    torques : sequence of float
        On gear 1, N m, > 0.
    positions : sequence of float
        By the driving gear, base pitches.
    resolution : Resolution, optional
    estimate_error : bool
        Solve every position on a coarser mesh too and state the difference as error, at about half the cost
        again.
    report : callable, optional
        Called with the fraction done before each position.

    Returns
    -------
    FullContactTable
        Every point with its status, residual and iterations.

    Raises
    ------
    InputError
        A pair that plane strain or the meshes do not hold, or a torque that is not positive.
    """
    if (reason := refusal(pair)) is not None:
        raise InputError("pair", "this pair", f"one that full contact in the plane holds; {reason}")
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
    _check(torques, positions)
    solved: list[SolvedPosition] = []
    seconds = []
    for count, position in enumerate(positions):
        if report is not None:
            report(count / len(positions))
        clock = StageClock()
        with clock.stage("position"):
            solutions = [solve_position(model, pair, torques, position, mesh) for mesh in meshes]
        solved.append(_with_error(solutions[0], solutions[1]) if len(solutions) > 1 else solutions[0])
        seconds.append(clock.seconds["position"])
    return tuple(
        FullContactTable(
            position=np.array(positions, dtype=float),
            torque=np.array(torques, dtype=float),
            points=tuple(position.contacts[number] for position in solved),
            unknowns=np.array([position.unknowns for position in solved], dtype=np.int64),
            cpu_seconds=np.array(seconds) / model.count,
        )
        for number in range(model.count)
    )


def resolutions(resolution: Resolution, *, estimate_error: bool) -> tuple[Resolution, ...]:
    """Return the meshes to solve on: the coarser one too where the error is requested."""
    return (resolution, resolution.coarser(COARSER)) if estimate_error else (resolution,)


def _check(torques: Sequence[float], positions: Sequence[float]) -> None:
    """Refuse torques and positions that cannot be solved."""
    for name, values in (("torques", torques), ("positions", positions)):
        if len(values) == 0:
            raise InputError(name, "none", "at least one number")
    for torque in torques:
        positive("torques", torque, "On gear 1, in N m.")
    for position in positions:
        finite("positions", position, "By the driving gear, in base pitches.")


def _with_error(fine: SolvedPosition, coarse: SolvedPosition) -> SolvedPosition:
    """State the difference of two meshes of the same position as the error of the finer one."""
    contacts = zip(fine.contacts, coarse.contacts, strict=True)
    return replace(fine, contacts=tuple(_apart(own, other) for own, other in contacts))


def _apart(fine: Loads, coarse: Loads) -> Loads:
    """State the differences of one contact."""
    return tuple(
        replace(own, error_estimate=abs(own.transmission_error - other.transmission_error))
        if own.status.usable
        else own
        for own, other in zip(fine, coarse, strict=True)
    )
