"""Entry point of the contact analysis: gear pair in, STE database out."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from bounds import warn_of
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.database.compute_database import compute_database, solved_findings
from fe_contact.analysis.database.kept_tolerance import OnDraft, kept_tolerance
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, Levels, Run, TableAxes
from fe_contact.plausibility import unexpected
from fe_contact.ste import SteDatabase
from fe_contact.types import Json
from model_studies import Progress, silent
from model_studies.workers import InProcess, Workers


def analyze(
    pair: ParallelAxes,
    *,
    torques: Levels | None = None,
    normal_forces: Levels | None = None,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    pitches: int | None = None,
    misalignments: Levels = (0.0,),
    center_distance_changes: Levels = (0.0,),
    effects: Mapping[str, str] | None = None,
    receipt: str = "full",
    on_violation: str = "repeat",
    case: Json | None = None,
    progress: Progress = silent,
    on_draft: OnDraft | None = None,
    cache: Path | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SteDatabase:
    """Compute the static transmission error of a gear pair.

    `ste_database` in keywords: see it for what is returned and raised.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        On parallel axes, spur or helical; the wheel external or a ring gear.
    torques, normal_forces, misalignments, center_distance_changes, pitches
        See `TableAxes`.
    tolerance : AllowedError or float, optional
        A number is the relative part: 0.01 is 1 % or 20 nm, the larger of both.
    level, time_budget, model, positions, effects, receipt, on_violation
        See `AnalysisOptions`.
    case, on_draft
        See `ste_database`.
    progress, cache, workers
        See `Run`.
    """
    return ste_database(
        pair,
        TableAxes(torques, normal_forces, misalignments, center_distance_changes, pitches),
        AnalysisOptions(
            AllowedError.given(tolerance),
            time_budget,
            level,
            model,
            positions,
            effects or {},
            receipt,
            on_violation,
        ),
        Run(workers, cache, progress),
        case=case,
        on_draft=on_draft,
    )


def ste_database(
    pair: ParallelAxes | Checked,
    axes: TableAxes | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    case: Json | None = None,
    on_draft: OnDraft | None = None,
) -> SteDatabase:
    """Compute the static transmission error of a gear pair over loads and alignments.

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        On parallel axes, spur or helical; the wheel external or a ring gear. A request that is checked
        already stands for pair, axes and options.
    axes : TableAxes, optional
    options : AnalysisOptions
    run : Run
        With a tolerance, progress starts again with every pass.
    case : dict, optional
        The case as the caller phrased it, echoed into the result and hashed; default: the request in SI
        units.
    on_draft : callable, optional
        Called as on_draft(table, refining) with the table of every pass that does not meet the tolerance and
        is refined: first answers with their errors, while the next pass runs.

    Returns
    -------
    SteDatabase
        Failed points hold NaN and their status.

    Raises
    ------
    InputError
        A value that cannot be used, by field name.
    MeshError, SolveError
        No acceptable mesh, a linear system that cannot be solved, or an assumption that does not hold where
        `on_violation` is "fail".
    WorkersLost
        No worker is left for the tasks.

    Warns
    -----
    PlausibilityWarning
        Once for each implausible value, of the request before the run and of its results after it; all are in
        `SteDatabase.warnings`.
    """
    checked = as_checked(pair, axes, options)
    request = checked.request
    phrased = case or request.to_json()
    if request.options.refines:
        database = kept_tolerance(checked, phrased, run, on_draft)
    else:
        database = compute_database(checked, phrased, run)
    warn_of(unexpected(request.findings, solved_findings(request, database)))
    return database
