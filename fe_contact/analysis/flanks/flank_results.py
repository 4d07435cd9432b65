"""Flank results of a gear pair at one load and one alignment: line load, pressure, gap."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from bounds import Finding, warn_of
from fe_contact.analysis.checks.table_laws import require_laws
from fe_contact.analysis.flanks.flank_errors import with_errors
from fe_contact.analysis.flanks.flank_file import SCHEMA_VERSION
from fe_contact.analysis.flanks.flank_laws import check_flank_laws
from fe_contact.analysis.flanks.load_distribution import LoadDistribution, load_distribution
from fe_contact.analysis.flanks.solved_operating_point import solved_point
from fe_contact.analysis.request.request import Checked
from fe_contact.analysis.request.request_check import as_checked
from fe_contact.geometry import ParallelAxes
from fe_contact.options import AnalysisOptions, OperatingPoint, Run
from fe_contact.plausibility import flank_findings, merged, unexpected
from fe_contact.solver_version import SOLVER_VERSION, software_versions
from fe_contact.ste import Metadata
from fe_contact.ste.metadata import content_hash
from fe_contact.types import Json
from model_studies.stage_clock import StageClock

if TYPE_CHECKING:
    from fe_contact.analysis.flanks.load_distribution import LoadDistribution


def flank_results(
    pair: ParallelAxes | Checked,
    point: OperatingPoint | None = None,
    options: AnalysisOptions = AnalysisOptions(),  # noqa: B008 (frozen)
    run: Run = Run(),  # noqa: B008 (frozen)
    *,
    at: ArrayLike | None = None,
    case: Json | None = None,
) -> LoadDistribution:
    """Solve the contact of one load and alignment, and return load, pressure and gap on the flanks.

    Raises `InputError`: a value that cannot be used, by field name; `MeshError`, `SolveError`: no acceptable
    mesh, positions without a solution, results that break a law of mechanics (`partial` has them), or a
    violated assumption if `on_violation` is "fail".

    Parameters
    ----------
    pair : GearPair, InternalGearPair or Checked
        A `Checked` request takes the place of pair, point and options.
    point : OperatingPoint, optional
    options : AnalysisOptions
        `positions` and `receipt` are ignored.
    run : Run
        Workers are not used.
    at : array_like, optional
        Positions in base pitches; default: 64 over one mesh cycle, as `contact_pattern` needs them. Where
        teeth differ, the position decides which of them mesh: from 0 to 1 the first ones of the lists.
    case : dict, optional
        The case as the caller phrased it, echoed and hashed; default: the request in SI units.
    """
    clock = StageClock(run.workers.cost)
    solved, receipt = solved_point(as_checked(pair, point, options), at, clock, run)
    checked, request = solved.checked, solved.checked.request
    results = load_distribution(
        solved.contact.pair,
        solved.problem,
        solved.solution,
        misalignment=float(request.misalignment[0]),
        center_distance_change=float(request.center_distance_change[0]),
    )
    laws = check_flank_laws(results, solved.problem)
    require_laws(laws, results, "load distribution")
    run.progress("errors", 0.0)
    with clock.stage("error estimate"):
        results = with_errors(results, solved, run.cache)
    run.progress("errors", 1.0)
    receipt = receipt | clock.to_json() | {"laws": [law.to_json() for law in laws]}
    results = replace(results, metadata=Metadata(receipt=receipt))
    warn_of(unexpected(request.findings, _findings(results)))
    return replace(results, metadata=_metadata(checked, results, case))


def _findings(results: LoadDistribution) -> tuple[Finding, ...]:
    return flank_findings(float(np.max(results.clear_pressure, initial=0.0)))


def _metadata(checked: Checked, results: LoadDistribution, case: Json | None) -> Metadata:
    """Return the metadata of the results; the content hash covers everything that determines them."""
    scene = results.scene
    request: Json = {
        "case": case or checked.request.to_json(),
        "normal_force": scene.normal_force,
        "misalignment": scene.misalignment,
        "center_distance_change": scene.center_distance_change,
        "position": results.position.tolist(),
    }
    return replace(
        results.metadata,
        case=request["case"],
        effect_ledger=[entry.to_json() for entry in checked.ledger],
        content_hash=content_hash({"flank_results": request}, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions=software_versions(),
        warnings=[finding.to_json() for finding in merged(checked.request.findings, _findings(results))],
    )
