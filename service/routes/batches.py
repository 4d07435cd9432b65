"""Batches: one request, many jobs of one process, all entered or none."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import structlog
from fastapi import APIRouter, Response

from lineofaction.gearbox.problems import BadInput, Fault, QueueFull
from lineofaction.gearbox.schemas.model import MAX_FAULTS
from lineofaction.gearbox.schemas.reading import validated
from service.access.holder import Scope
from service.queue.entry import BatchCase
from service.queue.terms import Label, Terms, check_priority, cost_limit
from service.routes.callbacks import checked_uris, enter_calls
from service.routes.context import Context, Ctx, From
from service.routes.jobs import status_info
from service.routes.media_types import answer
from service.routes.openapi import documented
from service.routes.processes import IdempotencyKey, predicted_seconds
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import StatusInfo
from service.schemas.execute import BatchRequest
from service.store.database import now
from service.worker.process import Process

Json = dict[str, Any]
logger = structlog.get_logger(__name__)
_PREDICTING_S = 1.0
"""CPU time for the predicted costs of one batch: 6 ms a case in the plane, 0.1 s over the face."""
router = APIRouter(prefix="/batches", tags=["jobs"], route_class=ScopedRoute)


@router.post(
    "",
    summary="Submit a batch",
    status_code=201,
    responses=documented(QueueFull) | {201: answer("The batch, a job like others", "Location")},
)
@needs(Scope.SUBMIT, body=BatchRequest)
def submit_batch(
    request: BatchRequest,
    response: Response,
    context: Ctx,
    caller: From,
    idempotency_key: IdempotencyKey = None,
) -> StatusInfo:
    """Check the inputs of all jobs and enter them with the batch they are in, all or none.

    The batch is a job: its status, events and dismissal are those of all jobs in it.
    """
    if request.process not in context.registry:
        raise BadInput.of("process", request.process, f"one of {', '.join(context.registry)}")
    process = context.registry[request.process]
    check_priority(request.priority, caller)
    terms = Terms(
        label=Label.of(request.title, request.tags),
        priority=request.priority,
        max_cost_s=cost_limit(request.max_cost_s, caller),
    )
    uris = checked_uris(context.settings, request.subscriber)
    looked = now()
    cases = _cases(context, process, _checked_inputs(context, process, request))
    entry = context.submissions.entry(caller, terms)
    identifier = entry.batch(process.id, cases, looked, idempotency_key)
    enter_calls(context, identifier, uris)
    logger.info("batch entered", job=identifier, process=process.id, jobs=len(cases))
    context.wake()
    response.headers["Location"] = f"/v1/jobs/{identifier}"
    return status_info(context.submissions.find(identifier), context.registry)


def _checked_inputs(context: Context, process: Process, request: BatchRequest) -> list[Json]:
    """Return the normalized inputs of all jobs.

    Raises `BadInput` with the faults of all jobs, named by the job's index; if there are more than
    `MAX_FAULTS`, with the first fault of each job.
    """
    inputs, faults = [], []
    for index in range(len(request.jobs)):
        try:
            model = validated(process.inputs, request.inputs_of(index))
            inputs.append(process.prepare(model, context.store))
        except BadInput as error:
            faults.append(_of_job(index, error))
    if sum(map(len, faults)) > MAX_FAULTS:
        faults = [of_job[:1] for of_job in faults]
    if faults:
        raise BadInput(fault for of_job in faults for fault in of_job)
    return inputs


def _of_job(index: int, error: BadInput) -> list[Fault]:
    """Return the faults of one job, with the job's index and the field's name in its case or scene file."""
    faults = []
    for fault in error.faults:
        name = fault.field.removeprefix("case.").removeprefix("scene.")
        faults.append(Fault(f"jobs[{index}].{name}", fault.value, fault.bound, fault.suggestion))
    return faults


def _cases(context: Context, process: Process, inputs: Sequence[Json]) -> list[BatchCase]:
    """Return the jobs of a batch: whether each has a result already, and its predicted cost."""
    keys = [process.key(of_job) for of_job in inputs]
    stored = {key: context.store.find(key, process.kind) is not None for key in set(keys)}
    new = {key: of_job for key, of_job in zip(keys, inputs, strict=True) if not stored[key]}
    costs = _costs(new)
    known = [cost for cost in costs.values() if cost is not None]
    usual = sum(known) / len(known) if known else 1.0
    return [
        BatchCase(key, of_job, stored[key], costs.get(key) or usual)
        for key, of_job in zip(keys, inputs, strict=True)
    ]


def _costs(inputs: dict[str, Json]) -> dict[str, float | None]:
    """Predict the costs of jobs, CPU s, by key, until `_PREDICTING_S` is spent; the others are left out."""
    costs: dict[str, float | None] = {}
    end = time.thread_time() + _PREDICTING_S
    for key, of_job in inputs.items():
        costs[key] = predicted_seconds(of_job)
        if time.thread_time() > end:
            break
    return costs
