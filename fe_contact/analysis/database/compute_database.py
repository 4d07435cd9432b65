"""The main flow: from a checked request to the STE database, in one pass.

A pass solves the contact at all loads and alignments, checks assumptions and laws, estimates the errors, and
writes the receipt. The receipt is a JSON record of cost, plan and checks; the effect ledger in it lists each
effect with its influence. Support loads are further loads, down to lift-off and into overload, which the mesh
force is extracted from.
"""

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
    """A table, and the model and discretization that it was computed with.

    The model includes effects that were switched on because an assumption failed.
    """

    table: SteDatabase
    decision: Decision


def compute_database(checked: Checked, case: Json, run: Run, choice: Decision | None = None) -> SteDatabase:
    """Compute the table of a checked request.

    Parameters are those of `compute_pass`; `choice` is its `decision`.
    """
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
    violates a law of mechanics; the attribute `partial` of the error is then the table.

    Parameters
    ----------
    case : dict
        Case of the request; it is copied into the result and hashed.
    decision : Decision, optional
        Model and discretization; default: those that the requested accuracy needs.
    clock : StageClock, optional
        Clock of the workers' cost, which may already hold time that was spent on this pass; default: a new
        clock.
    """
    clock = clock or StageClock(run.workers.cost)
    initial_cost = replace(run.workers.cost)  # a copy: the workers add to the original
    first = solve_table(checked, clock, run, decision=decision)
    # `settled` solves again with the effects that are needed, until the assumptions hold
    result, assumptions, repeated = settled(
        first,
        check_assumptions,
        lambda last, needed: solve_table(with_effects(last.checked, needed), clock, run, last),
        clock,
    )
    laws = _checked_laws(result)
    has_full_receipt = _has_full_receipt(result)
    # an iterator of one value, so that workers may compute it while the errors are estimated
    influences = _started_influences(first, run, initial_cost) if has_full_receipt else iter([{}])
    requested = result.table
    assessed, result = _assessed(result, clock, run)
    inserted = result.table is not requested  # alignments were inserted to meet the tolerance
    if inserted:
        laws = _checked_laws(result)
    contact = _contact(result, clock)
    # the cost model learns from runs alone that went as predicted, in this process
    if not (repeated or inserted or result.derived or run.workers.cost.since(initial_cost).tasks):
        _log_cost(result, clock, run)
    with clock.stage("effect ledger"):
        ledger = effect_ledger(
            result.checked,
            run.cache,
            assumptions,
            plan=result.plan,
            influences=next(influences),
            estimates=has_full_receipt,
        )
    receipt = clock.to_json() | assessed.to_json() | contact | _planned(result)
    receipt |= {"assumptions": [assumption.to_json() for assumption in assumptions], "repeated": repeated}
    receipt["laws"] = [law.to_json() for law in laws]
    receipt |= _remote_cost(run.workers.cost.since(initial_cost))
    table = assessed.with_errors(result.table, _metadata(case, result, receipt, ledger))
    _enter_tolerance(table, result.checked.request)
    return _Computed(table, result.decision)


def _log_cost(result: SolvedTable, clock: StageClock, run: Run) -> None:
    """Enter the cost of the stages of a run into the log from which predictions learn."""
    cost = {log_name(result.prediction.kind, name): time for name, time in clock.seconds.items()}
    record(run.cache, result.prediction.logged, cost)


def _remote_cost(remote: RunCost) -> Json:
    """Return the entry of the receipt about work of other processes; none without such work."""
    return {"elsewhere": asdict(remote)} if remote.tasks or remote.lost else {}


def _enter_tolerance(table: SteDatabase, request: Request) -> None:
    """Enter into the receipt of a table how its tolerance was used and whether it is met, if it has one."""
    if request.options.tolerance is not None:
        used = tolerance_receipt(table, request.options.tolerance, request)
        table.metadata.receipt["tolerance"] = used
        table.metadata.receipt["choice"]["met"] = used["met"]


def _started_influences(first: SolvedTable, run: Run, initial_cost: RunCost) -> Iterator[Influences]:
    """Start the estimate of the influences of effects; the iterator yields them once.

    The workers compute it if they had tasks of this table and the model extends over the face: the estimate
    then takes half a second. In the plane it takes hundredths, less than to hand it out.
    """
    remote = first.checked.model.across_face and run.workers.cost.since(initial_cost).tasks
    workers = run.workers if remote else InProcess()
    # one task; the bodies are shared with the other tasks of the table
    return workers.run(_influences_of_request, first.places.nominal.bodies, [first.checked])


def _influences_of_request(_bodies: object, checked: Checked) -> Influences:
    return estimated_influences(checked)


def _has_full_receipt(result: SolvedTable) -> bool:
    return result.checked.request.options.receipt == "full"


def _checked_laws(result: SolvedTable) -> tuple[LawCheck, ...]:
    """Check the laws of mechanics on a table; raises `SolveError`: one is violated."""
    support = [contact.solution for contact in result.support]
    laws = check_laws(result.table, result.places.places, result.solved, support)
    require_laws(laws, result.table)
    return laws


def _contact(result: SolvedTable, clock: StageClock) -> Json:
    """Return the entries of the receipt about the contact."""
    with clock.stage("contact"):
        support = [(contact.problem, contact.solution) for contact in result.support]
        return contact_receipt(
            result.solved, support, condition=_has_full_receipt(result), known=result.condition
        )


def _assessed(result: SolvedTable, clock: StageClock, run: Run) -> tuple[AssessedTable, SolvedTable]:
    """Return the errors of a table, and the table, with alignments inserted where the tolerance needs them.

    A receipt that is not full has no errors.
    """
    if not _has_full_receipt(result):
        return unassessed_table(result.table, result.places, result.plan), result
    stage = "error estimate"
    # progress counts the predicted cost of the parts of the stage, of which the bodies are one
    progress = by_cost(partial(run.progress, stage), result.prediction.parts[stage])
    report = partial(progress, "bodies")
    divided = replace(run, workers=result.places.workers)
    bodies = condensed_bodies(result.checked, result.plan, clock, divided, coarse=True, report=report)
    with clock.stage(stage):
        assessed, result = assessed_table(result, result.places.on_bodies(bodies))
    run.progress(stage, 1.0)
    return assessed.with_derivatives(result.derived), result


def solved_findings(request: Request, table: SteDatabase) -> tuple[Finding, ...]:
    """Return the findings about implausible values of the results."""
    module = request.pair.pinion.normal_module
    return table_findings(table.static_transmission_error, table.max_pressure, module)


def _planned(result: SolvedTable) -> Json:
    """Return the plan, the predicted cost and the choice of model, as they were before the run."""
    error = result.decision.mesh.option.error.to_json()
    planned = {
        "plan": result.plan.to_json(),
        "prediction": result.prediction.to_json() | {"error": error},
        "choice": result.decision.to_json(),
    }
    if result.derived is not None:
        planned["cycle"] = result.derived.to_json()
    cycle = result.checked.cycle
    return planned if cycle is None else planned | {"predicted": cycle.to_json()}


def _metadata(case: Json, result: SolvedTable, receipt: Json, ledger: list[Json]) -> Metadata:
    request = result.checked.request
    findings = merged(request.findings, solved_findings(request, result.table))
    return Metadata(
        case=case,
        effect_ledger=ledger,
        receipt=receipt,
        content_hash=content_hash(case, SOLVER_VERSION, SCHEMA_VERSION),
        software_versions=software_versions(),
        warnings=[finding.to_json() for finding in findings],
    )
