"""The main flow: from a checked request to the STE database, in one pass."""

from __future__ import annotations

import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path

from bounds import Finding
from fe_contact.allowed_error import AllowedError
from fe_contact.analysis.assessed_table import AssessedTable, assessed_table, unassessed_table
from fe_contact.analysis.assumptions import check_assumptions
from fe_contact.analysis.contact_receipt import contact_receipt
from fe_contact.analysis.decided import Decided
from fe_contact.analysis.effect_ledger import effect_ledger
from fe_contact.analysis.repetition import settled, with_effects
from fe_contact.analysis.request import Checked, Request
from fe_contact.analysis.solved_table import SolvedTable, condensed_bodies, solve_table
from fe_contact.analysis.tolerance_receipt import tolerance_receipt
from fe_contact.planning.cost_model import log_name
from fe_contact.planning.run_log import record
from fe_contact.plausibility import merged, table_findings
from fe_contact.progress import Progress
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.content_hash import content_hash
from fe_contact.ste.facts import SCHEMA_VERSION
from fe_contact.types import Json
from fe_contact.workers import InProcess, Workers

SOLVER_VERSION = "11"
PACKAGES = ("lineofaction", "numpy", "scipy", "numba", "scikit-fem", "gmsh")


@dataclass(frozen=True)
class Computed:
    """A table, and what it was computed with: effects that turned out to be needed included."""

    table: SteDatabase
    decided: Decided


def compute_database(
    checked: Checked,
    case: Json,
    report: Progress,
    cache: Path | None,
    decided: Decided | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
) -> SteDatabase:
    """Compute the table of a checked request; parameters of `compute_pass`."""
    return compute_pass(checked, case, report, cache, decided, workers).table


def compute_pass(
    checked: Checked,
    case: Json,
    report: Progress,
    cache: Path | None,
    decided: Decided | None = None,
    workers: Workers = InProcess(),  # noqa: B008 (frozen)
    clock: StageClock | None = None,
) -> Computed:
    """Compute the table of a checked request once.

    Parameters
    ----------
    checked : Checked
    case : dict
        Echoed into the result and hashed.
    report : callable
        Called as report(stage, fraction).
    cache : Path, optional
        Directory of flank compliances.
    decided : Decided, optional
        Model and discretization; default: those that the accuracy asks for.
    workers : Workers
        Who condenses the gears and solves the contact; the table does not depend on them.
    clock : StageClock, optional
        That of the workers' cost, with what was spent on this pass before it began; default: a new one.

    Raises
    ------
    SolveError
        An assumption of the run does not hold and `on_violation` is "fail".
    """
    clock, before = clock or StageClock(workers.cost), replace(workers.cost)
    full = checked.request.accuracy.receipt == "full"
    planned = solve_table(checked, clock, report, cache, decided=decided, workers=workers)

    def again(run: SolvedTable, needed: Mapping[str, str]) -> SolvedTable:
        return solve_table(with_effects(run.checked, needed), clock, report, cache, run, workers=workers)

    run, found, repeated = settled(planned, check_assumptions, again, clock)
    with clock.stage("contact"):
        contact = contact_receipt(run.solved, run.support, condition=full, known=run.condition)
    assessed = _assessed(run, clock, report, cache, workers, full=full)
    remote = workers.cost.since(before)
    if not repeated and not remote.tasks:
        _log_cost(run, clock, cache)
    with clock.stage("effect ledger"):
        ledger = effect_ledger(
            run.checked, cache, found, plan=run.plan, planned_request=planned.checked, estimates=full
        )
    metadata = _metadata(case, run, clock, assessed.to_json() | contact, ledger)
    metadata.receipt.update(assumptions=[one.to_json() for one in found], repeated=repeated)
    if remote.tasks or remote.lost:
        metadata.receipt["elsewhere"] = asdict(remote)
    table = replace(
        run.table, error_estimate=assessed.band, curve_error=assessed.curve_error, metadata=metadata
    )
    _state_tolerance(table, run.checked.request.accuracy.tolerance)
    return Computed(table, run.decided)


def _assessed(
    run: SolvedTable, clock: StageClock, report: Progress, cache: Path | None, workers: Workers, *, full: bool
) -> AssessedTable:
    """Return the errors of a table: estimated on coarser bodies for a full receipt, else not stated."""
    if not full:
        return unassessed_table(run.table, run.places, run.plan)
    bodies = condensed_bodies(run.checked, run.plan, clock, report, cache, coarse=True, workers=workers)
    with clock.stage("error estimate"):
        coarse = run.places.on_bodies(bodies)
        return assessed_table(run.table, run.places, coarse, run.solved, run.nodes, run.checked, run.plan)


def _log_cost(run: SolvedTable, clock: StageClock, cache: Path | None) -> None:
    """Enter what the stages of a run cost into the log that predictions learn from."""
    cost = {log_name(run.prediction.kind, name): time for name, time in clock.seconds.items()}
    record(cache, run.prediction.logged, cost)


def _state_tolerance(table: SteDatabase, tolerance: AllowedError | None) -> None:
    """Enter into the receipt of a table whether it keeps its tolerance."""
    if tolerance is not None:
        kept = tolerance_receipt(table, tolerance)
        table.metadata.receipt["tolerance"] = kept
        table.metadata.receipt["choice"]["met"] = kept["met"]


def solved_findings(request: Request, table: SteDatabase) -> tuple[Finding, ...]:
    """Return what is implausible about the results."""
    module = request.pair.pinion.normal_module
    return table_findings(table.static_transmission_error, table.max_pressure, module)


def _predicted(run: SolvedTable) -> Json:
    """Return what was expected of the run before it began, to stand beside what happened."""
    return run.prediction.to_json() | {"error": run.decided.mesh.option.error.to_json()}


def _metadata(case: Json, run: SolvedTable, clock: StageClock, found: Json, ledger: list[Json]) -> Metadata:
    """Everything about the making of the table; `found` is what was found of its errors and its contact."""
    receipt = clock.to_json() | found | {"plan": run.plan.to_json(), "prediction": _predicted(run)}
    receipt["choice"] = run.decided.to_json()
    if run.checked.cycle is not None:
        receipt["predicted"] = run.checked.cycle.to_json()
    request = run.checked.request
    findings = merged(request.findings, solved_findings(request, run.table))
    return Metadata(
        case=case,
        effect_ledger=ledger,
        receipt=receipt,
        warnings=[finding.to_json() for finding in findings],
        content_hash=content_hash(case, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions=software_versions(),
    )


def software_versions() -> dict[str, str]:
    """Return what a result was made with."""
    return dict(_software_versions())


@lru_cache(maxsize=1)
def _software_versions() -> tuple[tuple[str, str], ...]:
    """Read them once: the files of the packages are long."""
    return ("python", platform.python_version()), *((name, version(name)) for name in PACKAGES)
