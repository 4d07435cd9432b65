"""Entry point of the contact analysis: gear pair in, STE database out."""

from __future__ import annotations

from typing import Unpack

from bounds import warn_of
from fe_contact.analysis.database.compute_database import compute_database, solved_findings
from fe_contact.analysis.database.refined_table import OnDraft, refined_table
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.geometry import ParallelAxes
from fe_contact.keywords import TableKeywords, with_keywords
from fe_contact.options import AnalysisOptions, Run, TableAxes
from fe_contact.plausibility import unexpected
from fe_contact.ste import SteDatabase
from fe_contact.types import Json


def analyze(
    pair: ParallelAxes | Checked,
    axes: TableAxes | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    case: Json | None = None,
    on_draft: OnDraft | None = None,
    **keywords: Unpack[TableKeywords],
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
        Called as on_draft(table, refining) with the table of every pass that is refined, while the next runs.
    **keywords
        Members of `TableAxes`, `AnalysisOptions` and `Run`, in place of theirs, as ``torques=[60.0, 120.0]``.
        A number as `tolerance` is its relative part: 0.01 is 1 % or 20 nm, the larger of both.

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
        Once for each implausible value of request and results; all are in `SteDatabase.warnings`.
    """
    axes, options, run = with_keywords(axes, options, run, keywords)
    checked = as_checked(pair, axes, options)
    request = checked.request
    phrased = case or request.to_json()
    if request.options.refines:
        database = refined_table(checked, phrased, run, on_draft)
    else:
        database = compute_database(checked, phrased, run)
    warn_of(unexpected(request.findings, solved_findings(request, database)))
    return database
