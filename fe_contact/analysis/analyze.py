"""Entry point of the contact analysis: gear pair in, STE database out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from bounds import warn_of
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.compute_database import compute_database, solved_findings
from fe_contact.analysis.kept_tolerance import OnDraft, kept_tolerance
from fe_contact.analysis.request_check import check_request
from fe_contact.geometry import ParallelAxes
from fe_contact.plausibility import unexpected
from fe_contact.progress import Progress, silent
from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray, Json
from fe_contact.workers import InProcess, Workers


def analyze(
    pair: ParallelAxes,
    *,
    torques: Sequence[float] | FloatArray | None = None,
    normal_forces: Sequence[float] | FloatArray | None = None,
    tolerance: AllowedError | float | None = None,
    level: str | None = None,
    time_budget: float | None = None,
    model: str = "auto",
    positions: int | None = None,
    pitches: int | None = None,
    misalignments: Sequence[float] = (0.0,),
    center_distance_changes: Sequence[float] = (0.0,),
    effects: Mapping[str, str] | None = None,
    receipt: str = "full",
    on_violation: str = "repeat",
    case: Json | None = None,
    progress: Progress | None = None,
    on_draft: OnDraft | None = None,
    cache: Path | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SteDatabase:
    """Compute the static transmission error of a gear pair.

    Parameters
    ----------
    pair : GearPair or InternalGearPair
        On parallel axes, spur or helical; the wheel external or a ring gear.
    torques : sequence of float
        Torques on the driving gear in N m, increasing, > 0; or `normal_forces` in N.
    tolerance, level, time_budget
        Asked accuracy, at most one: error of mean and peak-to-peak, relative or 20 nm, the larger of both
        (`AllowedError` has another floor); "draft" | "standard" | "fine"; or seconds. Under a tolerance the
        table is refined by its measured errors, in at most four passes: `receipt["passes"]`, and
        `receipt["tolerance"]` says whether it is met, or why not.
    model : str
        "auto" (three dimensions where the scene acts across the face, else plane strain corrected for
        the finite face width), "plane_strain", "plane_stress" or "3d".
    positions : int, optional
        Equally spaced positions in a base pitch; default: nodes placed so that interpolation keeps 0.2 % of
        peak-to-peak.
    pitches : int, optional
        Base pitches that the table covers where gears have pitch deviations; default: until all repeats. A
        smaller number closes the table on itself: teeth that never meet stand side by side at its seam.
    misalignments, center_distance_changes : sequence of float
        Table axes in m, increasing. Misalignment is the growth of the gap over the common face width in the
        plane of action, zero at its middle.
    effects : mapping, optional
        Effect name to "on", "off" or "auto".
    receipt : str
        "full" measures the error of the result by source; "minimal" solves nothing for it: errors are then
        NaN, not estimated, and the receipt says so.
    on_violation : str
        What to do where an assumption turns out wrong on the solution (`receipt["assumptions"]`): "repeat"
        switches the automatic effect on that is needed and solves again, "fail" raises, "report" says so.
    case : dict, optional
        The case as the caller phrased it, echoed into the result and hashed; default: the request in SI
        units.
    progress : callable, optional
        Called as progress(stage, fraction); under a tolerance once more by every pass.
    on_draft : callable, optional
        Called as on_draft(table, refining) with the table of every pass that does not meet the tolerance and
        is refined: first answers with their errors, while the next pass runs.
    cache : Path, optional
        Directory of flank compliances.
    workers : Workers
        Who condenses the gears and solves the contact: this process, an executor or a cluster. The table is
        the same to the last bit; the receipt counts the CPU time of all of them.

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
        Nobody is left to do the tasks.

    Warns
    -----
    PlausibilityWarning
        Once for each thing that is far from practice, of the request before the run and of its results
        after it; all are in `SteDatabase.warnings`.
    """
    checked = check_request(
        pair,
        torques=torques,
        normal_forces=normal_forces,
        tolerance=tolerance,
        level=level,
        time_budget=time_budget,
        model=model,
        positions=positions,
        pitches=pitches,
        misalignments=misalignments,
        center_distance_changes=center_distance_changes,
        effects=effects,
        receipt=receipt,
        on_violation=on_violation,
    )
    phrased = case or checked.request.to_json()
    request, report = checked.request, progress or silent
    if request.accuracy.refines:
        database = kept_tolerance(checked, phrased, report, cache, on_draft or _unread, workers)
    else:
        database = compute_database(checked, phrased, report, cache, workers=workers)
    warn_of(unexpected(request.findings, solved_findings(request, database)))
    return database


def _unread(table: SteDatabase, refining: str) -> None:
    """Pass over a draft."""
