"""The main flow: from a checked request to the STE database, in one pass."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial

from bounds import Finding
from fe_contact.analysis.checks.assumptions import check_assumptions
from fe_contact.analysis.checks.effect_ledger import effect_ledger
from fe_contact.analysis.checks.law import LawCheck
from fe_contact.analysis.checks.repetition import settled, with_effects
from fe_contact.analysis.checks.table_laws import check_laws, require_laws
from fe_contact.analysis.database.contact_receipt import contact_receipt
from fe_contact.analysis.estimates.assessed_table import AssessedTable, assessed_table, unassessed_table
from fe_contact.analysis.estimates.tolerance_shares import tolerance_receipt
from fe_contact.analysis.request.influences import Influences, estimated_influences
from fe_contact.analysis.request.model_choice import Decision
from fe_contact.analysis.request.request import Checked, Request
from fe_contact.analysis.tables import SolvedTable, condensed_bodies, solve_table
from fe_contact.options import Run
from fe_contact.planning.cost_model import log_name
from fe_contact.plausibility import merged, table_findings
from fe_contact.solver_version import SOLVER_VERSION, software_versions
from fe_contact.ste import Metadata, SteDatabase
from fe_contact.ste.metadata import SCHEMA_VERSION, content_hash
from fe_contact.types import Json
from model_studies.progress import by_cost
from model_studies.run_log import record
from model_studies.stage_clock import StageClock
from model_studies.workers import InProcess, RunCost


@dataclass(frozen=True)
class _Computed:
    """A table, and what it was computed with: effects that turned out to be needed included."""

    table: SteDatabase
    decision: Decision


def compute_database(checked: Checked, case: Json, run: Run, choice: Decision | None = None) -> SteDatabase:
    """Compute the table of a checked request; parameters of `compute_pass`."""
    return compute_pass(checked, case, run, choice).table


def compute_pass(
    checked: Checked,
    case: Json,
    run: Run,
    decision: Decision | None = None,
    clock: StageClock | None = None,
) -> _Computed:
    """Compute the table of a checked request once.

    Raises `SolveError`: an assumption of the run does not hold and `on_violation` is "fail", or the table
    breaks a law of mechanics; `partial` is then the table.

    Parameters
    ----------
    case : dict
        Echoed into the result and hashed.
    decision : Decision, optional
        Model and discretization; default: those that the accuracy asks for.
    clock : StageClock, optional
        That of the workers' cost, with what was spent on this pass before it began; default: a new one.
    """
    clock, before = clock or StageClock(run.workers.cost), replace(run.workers.cost)
    planned = solve_table(checked, clock, run, decision=decision)
    made, assumptions, repeated = settled(
        planned,
        check_assumptions,
        lambda made, needed: solve_table(with_effects(made.checked, needed), clock, run, made),
        clock,
    )
    laws = _lawful(made)
    full = _full(made)
    influences = _started_influences(planned, run, before) if full else iter([{}])
    requested = made.table
    assessed, made = _assessed(made, clock, run)
    inserted = made.table is not requested  # which no prediction holds
    if inserted:
        laws = _lawful(made)
    contact = _contact(made, clock)
    if not (repeated or inserted or made.derived or run.workers.cost.since(before).tasks):
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
    receipt["laws"] = [law.to_json() for law in laws]
    if remote.tasks or remote.lost:
        receipt["elsewhere"] = asdict(remote)
    metadata = _metadata(case, made, receipt, ledger)
    table = assessed.with_errors(made.table, metadata)
    tolerance = made.checked.request.options.tolerance
    if tolerance is not None:
        tolerance_use = tolerance_receipt(table, tolerance, made.checked.request)
        metadata.receipt["tolerance"] = tolerance_use
        metadata.receipt["choice"]["met"] = tolerance_use["met"]
    return _Computed(table, made.decision)


def _started_influences(planned: SolvedTable, run: Run, before: RunCost) -> Iterator[Influences]:
    """Start the estimate of the plan's influences.

    Workers do it beside other tasks, where any were handed out for this table and it takes longer than to
    hand it out: springs over the face take half a second, those of a plane hundredths.
    """
    remote = planned.checked.model.across_face and run.workers.cost.since(before).tasks
    workers = run.workers if remote else InProcess()
    return workers.run(_influences_of_request, planned.places.nominal.bodies, [planned.checked])


def _influences_of_request(_bodies: object, checked: Checked) -> Influences:
    return estimated_influences(checked)


def _full(made: SolvedTable) -> bool:
    return made.checked.request.options.receipt == "full"


def _lawful(made: SolvedTable) -> tuple[LawCheck, ...]:
    """Check the laws of a table; raises `SolveError` where one is broken."""
    support = [contact.solution for contact in made.support]
    laws = check_laws(made.table, made.places.places, made.solved, support)
    require_laws(laws, made.table)
    return laws


def _contact(made: SolvedTable, clock: StageClock) -> Json:
    """Return what the receipt of a table says of its contact."""
    with clock.stage("contact"):
        support = [(contact.problem, contact.solution) for contact in made.support]
        return contact_receipt(made.solved, support, condition=_full(made), known=made.condition)


def _assessed(made: SolvedTable, clock: StageClock, run: Run) -> tuple[AssessedTable, SolvedTable]:
    """Return the errors of a table, and the table with the alignments that were inserted for a tolerance."""
    if not _full(made):
        return unassessed_table(made.table, made.places, made.plan), made
    stage = "error estimate"
    progress = by_cost(partial(run.progress, stage), made.prediction.parts[stage])
    report = partial(progress, "bodies")
    divided = replace(run, workers=made.places.workers)
    bodies = condensed_bodies(made.checked, made.plan, clock, divided, coarse=True, report=report)
    with clock.stage(stage):
        assessed, made = assessed_table(made, made.places.on_bodies(bodies))
    run.progress(stage, 1.0)
    return assessed.with_derivatives(made.derived), made


def solved_findings(request: Request, table: SteDatabase) -> tuple[Finding, ...]:
    """Return what is implausible about the results."""
    module = request.pair.pinion.normal_module
    return table_findings(table.static_transmission_error, table.max_pressure, module)


def _planned(made: SolvedTable) -> Json:
    """Return what was chosen and expected of the run before it began, to stand beside what happened."""
    error = made.decision.mesh.option.error.to_json()
    planned = {
        "plan": made.plan.to_json(),
        "prediction": made.prediction.to_json() | {"error": error},
        "choice": made.decision.to_json(),
    }
    if made.derived is not None:
        planned["cycle"] = made.derived.to_json()
    cycle = made.checked.cycle
    return planned if cycle is None else planned | {"predicted": cycle.to_json()}


def _metadata(case: Json, made: SolvedTable, receipt: Json, ledger: list[Json]) -> Metadata:
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
