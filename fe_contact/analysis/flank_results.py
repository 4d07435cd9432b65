"""Flank results: what happens on the flanks of a gear pair at one load and one alignment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from bounds import Finding, warn_of
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.compute_database import SOLVER_VERSION, software_versions
from fe_contact.analysis.flank_file import SCHEMA_VERSION
from fe_contact.analysis.load_distribution import LoadDistribution, load_distribution
from fe_contact.analysis.request import Checked
from fe_contact.analysis.request_check import check_one_load
from fe_contact.analysis.solved_operating_point import checked_positions, settled_operating_point
from fe_contact.geometry import ParallelAxes
from fe_contact.plausibility import flank_findings, merged, unexpected
from fe_contact.progress import Progress, silent
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata
from fe_contact.ste.content_hash import content_hash
from fe_contact.types import FloatArray, Json

POSITIONS = 64


def flank_results(
    pair: ParallelAxes,
    *,
    torque: float | None = None,
    normal_force: float | None = None,
    misalignment: float = 0.0,
    center_distance_change: float = 0.0,
    at: ArrayLike | None = None,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    model: str = "auto",
    effects: Mapping[str, str] | None = None,
    time_budget: float | None = None,
    on_violation: str = "repeat",
    case: Json | None = None,
    progress: Progress | None = None,
    cache: Path | None = None,
) -> LoadDistribution:
    """Solve the contact of one load and alignment, and keep what happens on the flanks.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
    torque, normal_force : float
        Torque on the driving gear in N m, or normal force in N; exactly one.
    misalignment, center_distance_change : float
        See `analyze`, m.
    at : array_like, optional
        Positions in base pitches; default: 64 over one mesh cycle, as `contact_pattern` needs them. Teeth
        with pitch deviations are those that mesh there: the first ones of the lists in 0 to 1.
    tolerance, level, time_budget, model, effects, on_violation, case, progress, cache
        See `analyze`.

    Returns
    -------
    LoadDistribution

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    MeshError, SolveError
        No acceptable mesh, positions without a solution, or an assumption that does not hold where
        `on_violation` is "fail".
    """
    checked = check_one_load(
        pair,
        torque,
        normal_force,
        misalignment,
        center_distance_change,
        tolerance=tolerance,
        level=level,
        time_budget=time_budget,
        model=model,
        effects=effects,
        on_violation=on_violation,
    )
    position = np.arange(POSITIONS) / POSITIONS if at is None else checked_positions(at)
    checked, found = _solved(checked, position, progress or silent, cache)
    found = replace(found, metadata=_metadata(checked, found, case))
    warn_of(unexpected(checked.request.findings, _findings(found)))
    return found


def _solved(
    checked: Checked, position: FloatArray, report: Progress, cache: Path | None
) -> tuple[Checked, LoadDistribution]:
    """Solve one operating point of the table at one load; the receipt is all that its metadata hold.

    The request is that of the last run, with the effects that the first showed to be needed.
    """
    clock, request = StageClock(), checked.request
    solved, receipt = settled_operating_point(checked, position, clock, report, cache)
    receipt = clock.to_json() | {"plan": solved.plan.to_json()} | receipt
    return solved.checked, load_distribution(
        solved.contact.pair,
        solved.problem,
        solved.solution,
        misalignment=float(request.misalignment[0]),
        center_distance_change=float(request.center_distance_change[0]),
        metadata=Metadata(receipt=receipt),
    )


def _findings(found: LoadDistribution) -> tuple[Finding, ...]:
    """Return what is implausible about the pressures."""
    return flank_findings(float(np.max(found.pressure, initial=0.0)))


def _metadata(checked: Checked, found: LoadDistribution, case: Json | None) -> Metadata:
    """Everything about the making; the hash is of all that decides the result."""
    scene = found.scene
    asked: Json = {
        "case": case or checked.request.to_json(),
        "normal_force": scene.normal_force,
        "misalignment": scene.misalignment,
        "center_distance_change": scene.center_distance_change,
        "position": found.position.tolist(),
    }
    return replace(
        found.metadata,
        case=asked["case"],
        effect_ledger=[entry.to_json() for entry in checked.ledger],
        content_hash=content_hash({"flank_results": asked}, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions=software_versions(),
        warnings=[finding.to_json() for finding in merged(checked.request.findings, _findings(found))],
    )
