"""The main flow: from a checked request to the STE database, in one pass."""

from __future__ import annotations

import platform
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import lru_cache, partial
from importlib.metadata import version

from bounds import Finding
from fe_contact.analysis.checks.assumptions import check_assumptions
from fe_contact.analysis.checks.effect_ledger import effect_ledger
from fe_contact.analysis.checks.repetition import settled, with_effects
from fe_contact.analysis.database.contact_receipt import contact_receipt
from fe_contact.analysis.database.tolerance_receipt import tolerance_receipt
from fe_contact.analysis.estimates.assessed_table import AssessedTable, assessed_table, unassessed_table
from fe_contact.analysis.request.decided import Decided
from fe_contact.analysis.request.influences import Influences, started_influences
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.tables.solved_table import SolvedTable, condensed_bodies, solve_table
from fe_contact.options import Run
from fe_contact.planning.cost_model import log_name
from fe_contact.plausibility import merged, table_findings
from fe_contact.solver_version import SOLVER_VERSION
from fe_contact.stage_clock import StageClock
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.content_hash import content_hash
from fe_contact.ste.facts import SCHEMA_VERSION
from fe_contact.types import Json
from fe_contact.workers import InProcess, RunCost
from model_studies.progress import by_cost
from model_studies.run_log import record

PACKAGES = ("lineofaction", "numpy", "scipy", "numba", "scikit-fem", "gmsh")


@dataclass(frozen=True)
class Computed:
    """A table, and what it was computed with: effects that turned out to be needed included."""

    table: SteDatabase
    decided: Decided


def compute_database(checked: Checked, case: Json, run: Run, decided: Decided | None = None) -> SteDatabase:
    """Compute the table of a checked request; parameters of `compute_pass`."""
    return compute_pass(checked, case, run, decided).table


def compute_pass(
    checked: Checked,
    case: Json,
    run: Run,
    decided: Decided | None = None,
    clock: StageClock | None = None,
) -> Computed:
    """Compute the table of a checked request once.

    Parameters
    ----------
    checked : Checked
    case : dict
        Echoed into the result and hashed.
    run : Run
    decided : Decided, optional
        Model and discretization; default: those that the accuracy asks for.
    clock : StageClock, optional
        That of the workers' cost, with what was spent on this pass before it began; default: a new one.

    Raises
    ------
    SolveError
        An assumption of the run does not hold and `on_violation` is "fail".
    """
    clock, before = clock or StageClock(run.workers.cost), replace(run.workers.cost)
    planned = solve_table(checked, clock, run, decided=decided)
    made, assumptions, repeated = settled(
        planned,
        check_assumptions,
        lambda made, needed: solve_table(with_effects(made.checked, needed), clock, run, made),
        clock,
    )
    full = _full(made)
    influences = _started_influences(planned, run, before) if full else iter([{}])
    assessed, contact = _assessed(made, clock, run)
    if not repeated and not run.workers.cost.since(before).tasks:
        cost = {log_name(made.prediction.kind, name): time for name, time in clock.seconds.items()}
        record(run.cache, made.prediction.logged, cost)
    with clock.stage("effect ledger"):
        known = next(influences)
        ledger = effect_ledger(
            made.checked, run.cache, assumptions, plan=made.plan, influences=known, estimates=full
        )
    remote = run.workers.cost.since(before)
    receipt = clock.to_json() | assessed.to_json() | contact | _planned(made)
    receipt |= {"assumptions": [assumption.to_json() for assumption in assumptions], "repeated": repeated}
    if remote.tasks or remote.lost:
        receipt["elsewhere"] = asdict(remote)
    metadata = _metadata(case, made, receipt, ledger)
    table = replace(
        made.table, error_estimate=assessed.band, curve_error=assessed.curve_error, metadata=metadata
    )
    tolerance = made.checked.request.options.tolerance
    if tolerance is not None:
        kept = tolerance_receipt(table, tolerance)
        metadata.receipt["tolerance"] = kept
        metadata.receipt["choice"]["met"] = kept["met"]
    return Computed(table, made.decided)


def _started_influences(planned: SolvedTable, run: Run, before: RunCost) -> Iterator[Influences]:
    """Start the estimate of influences: beside what is assessed, where tasks were handed out for this table.

    They are those of the plan, whatever the run found.
    """
    workers = run.workers if run.workers.cost.since(before).tasks else InProcess()
    return started_influences(planned.checked, workers, planned.places.nominal.bodies)


def _full(made: SolvedTable) -> bool:
    return made.checked.request.options.receipt == "full"


def _assessed(made: SolvedTable, clock: StageClock, run: Run) -> tuple[AssessedTable, Json]:
    """Return the table's errors, and what its receipt says of the contact."""
    full = _full(made)
    with clock.stage("contact"):
        contact = contact_receipt(made.solved, made.support, condition=full, known=made.condition)
    if not full:
        return unassessed_table(made.table, made.places, made.plan), contact
    stage = "error estimate"
    progress = by_cost(partial(run.progress, stage), made.prediction.parts[stage])
    report = partial(progress, "bodies")
    bodies = condensed_bodies(made.checked, made.plan, clock, run, coarse=True, report=report)
    with clock.stage(stage):
        coarse = made.places.on_bodies(bodies)
        assessed = assessed_table(
            made.table, made.places, coarse, made.solved, made.nodes, made.checked, made.plan
        )
    run.progress(stage, 1.0)
    return assessed, contact


def solved_findings(request: Request, table: SteDatabase) -> tuple[Finding, ...]:
    """Return what is implausible about the results."""
    module = request.pair.pinion.normal_module
    return table_findings(table.static_transmission_error, table.max_pressure, module)


def _planned(made: SolvedTable) -> Json:
    """Return what was chosen and expected of the run before it began, to stand beside what happened."""
    error = made.decided.mesh.option.error.to_json()
    planned = {
        "plan": made.plan.to_json(),
        "prediction": made.prediction.to_json() | {"error": error},
        "choice": made.decided.to_json(),
    }
    cycle = made.checked.cycle
    return planned if cycle is None else planned | {"predicted": cycle.to_json()}


def _metadata(case: Json, made: SolvedTable, receipt: Json, ledger: list[Json]) -> Metadata:
    """Everything about the making of the table."""
    request = made.checked.request
    findings = merged(request.findings, solved_findings(request, made.table))
    return Metadata(
        case=case,
        effect_ledger=ledger,
        receipt=receipt,
        content_hash=content_hash(case, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions=software_versions(),
        warnings=[finding.to_json() for finding in findings],
    )


def software_versions() -> dict[str, str]:
    """Return what a result was made with."""
    return dict(_software_versions())


@lru_cache(maxsize=1)
def _software_versions() -> tuple[tuple[str, str], ...]:
    """Read them once: the files of the packages are long."""
    return ("python", platform.python_version()), *((name, version(name)) for name in PACKAGES)
