"""Processes, executions, batches and webhooks (OGC API - Processes 1.0, clauses 7.8 to 7.11)."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import cache
from typing import Annotated, Any, cast

import structlog
from fastapi import APIRouter, Header, Query, Response
from pydantic import BaseModel, create_model

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import (
    BadInput,
    Fault,
    LiveUnavailable,
    NoSuchProcess,
    QueueFull,
    TooManyHeld,
)
from lineofaction.gearbox.registry import NETCDF
from lineofaction.gearbox.schemas.model import MOST_FAULTS, BoundaryModel
from lineofaction.gearbox.schemas.reading import validated
from service.access.capacity import NOBODY
from service.access.keyring import Holder, Scope
from service.live.order import LiveOrder
from service.live.turns import Asker
from service.origin import Origin
from service.queue.entry import BatchCase
from service.queue.terms import (
    ANYBODY,
    Label,
    Terms,
    check_priority,
    cost_limit,
    delivery,
    differences_between,
    refuse_beyond,
)
from service.routes.context import Context, Ctx, From
from service.routes.jobs import batch_results, problem_of, reference_of, status_info
from service.routes.media_types import Limit, answer
from service.routes.openapi import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import (
    AdditionalParameters,
    Link,
    Parameter,
    ProcessDescription,
    ProcessList,
    ProcessSummary,
    StatusInfo,
    Subscriber,
    ValueDescription,
)
from service.schemas.execute import BatchRequest, execute_model
from service.settings import Settings
from service.store.database import now
from service.webhooks.calls import Calls
from service.webhooks.deliverer import Deliverer, Outbox
from service.worker.process import Process, Registry

# Whom a request may have called, and what is told.

logger = structlog.get_logger(__name__)
After = Annotated[str, Query(max_length=64, description="Last process of the previous page")]
_SUBJECTS = ("case", "scene")
_LONGEST_STATED = 65_536
"""Characters of a caller's inputs that are kept with each of its jobs, beside those of the computation."""
IdempotencyKey = Annotated[
    str | None,
    Header(
        description="A name of the caller's for this request: sent again, it is the same job",
        min_length=1,
        max_length=255,
    ),
]
Prefer = Annotated[str, Header(description="Jobs are always asynchronous (RFC 7240)", max_length=1000)]
Json = dict[str, Any]
_PREDICTING_S = 1.0
"""CPU time for the predicted costs of one batch: 6 ms a case in the plane, 0.1 s over the face."""
router = APIRouter(prefix="/batches", tags=["jobs"], route_class=ScopedRoute)
predicted_seconds = on_demand("service.worker.preparations:predicted_seconds")


def _checked_uris(settings: Settings, subscriber: Subscriber | None) -> dict[str, str]:
    """Return the addresses to call, by event; raises `BadInput` for any that is not listed."""
    if subscriber is None:
        return {}
    listed = settings.origins
    if not listed:
        bound = "left out: this service sends no requests to addresses that its callers name"
        raise BadInput.of("subscriber", None, bound, "Follow /v1/jobs/{id}/events.")
    for event, uri in subscriber.uris.items():
        with suppress(ValueError):
            if Origin.of(uri) in listed:
                continue
        bound = f"an address at {' or '.join(map(str, sorted(listed, key=str)))}"
        raise BadInput.of(f"subscriber.{event}Uri", uri, bound)
    return subscriber.uris


def _enter_calls(context: Context, job: str, uris: dict[str, str]) -> None:
    if uris:
        Calls(context.engine).enter(job, uris)


def deliverer_of(context: Context) -> Deliverer | None:
    """Return what makes the calls, None where none are allowed."""
    settings = context.settings
    if not settings.origins:
        return None
    calls = Calls(context.engine)
    outbox = Outbox(
        calls,
        settings.origins,
        settings.webhook_key,
        lambda job, event: _message(context.within(calls.project_of(job)), job, event),
    )
    return Deliverer(outbox)


def _message(context: Context, identifier: str, event: str) -> Any:
    """Return what is told: the status, the document of the results, or the problem."""
    job = context.submissions.find(identifier)
    problem = problem_of(job)
    if event == "inProgress":
        return status_info(job, context.registry).model_dump()
    if event == "failed" and problem is not None:
        return problem.as_json()
    if job.children:
        return batch_results(context, job).model_dump()
    return {context.registry[job.process].output: reference_of(job).model_dump()}


def processes_router(registry: Registry) -> APIRouter:
    """Return the routes, one execution route per process, so that each body has its own schema."""
    router = APIRouter(prefix="/processes", tags=["processes"], route_class=ScopedRoute)

    @router.get("", summary="Processes", responses=documented(NoSuchProcess))
    @needs(Scope.READ)
    def list_processes(limit: Limit = 100, after: After = "") -> ProcessList:
        """All that can be run."""
        passed = list(registry).index(registry[after].id) + 1 if after else 0
        behind = list(registry.values())[passed:]
        shown = behind[:limit]
        links = [Link(href="/v1/processes", rel="self", title="Processes")]
        if len(behind) > limit:
            following = f"/v1/processes?limit={limit}&after={shown[-1].id}"
            links.append(Link(href=following, rel="next", title="Next page"))
        return ProcessList(processes=[ProcessSummary(**_summary(p)) for p in shown], links=links)

    @router.get("/{process_id}", summary="One process", responses=documented(NoSuchProcess))
    @needs(Scope.READ)
    def describe_process(process_id: str) -> ProcessDescription:
        """Describe a process with the schemas of its inputs and outputs."""
        return _description(registry[process_id])

    for offered in registry.values():
        _add_execution(router, offered)

    @router.post("/{process_id}/execution", include_in_schema=False)
    @needs(Scope.SUBMIT)
    def execute_other(process_id: str) -> ProcessDescription:
        """Refuse a name without a route: it is that of no process."""
        return _description(registry[process_id])

    return router


def _add_execution(router: APIRouter, process: Process) -> None:
    body = execute_model(process.id, process.inputs, process.output)

    @needs(Scope.SUBMIT, body=body)
    def execute(
        request: Any,
        response: Response,
        context: Ctx,
        caller: From,
        prefer: Prefer = "respond-async",
        idempotency_key: IdempotencyKey = None,
    ) -> StatusInfo:
        """Check the inputs and enter a job; equal work is shared, stored results are used."""
        output = getattr(request.outputs, process.output)
        field = f"outputs.{process.output}.transmissionMode"
        form = delivery(request.response, output and output.transmissionMode, field)
        uris = _checked_uris(context.settings, request.subscriber)
        inputs = process.prepare(cast(BoundaryModel, request.inputs), context.store)
        former = context.submissions.newest(caller, process.id)
        if former is None:
            defaults = request.inputs.model_dump(mode="json", exclude_defaults=True)
            since = differences_between({}, defaults)
        else:
            since = differences_between(former[1], inputs, former[0])
        check_priority(request.priority, caller)
        limit = cost_limit(request.max_cost_s, caller)
        stated = json.dumps(request.inputs.model_dump(mode="json", exclude_unset=True))
        kept = stated if len(stated) <= _LONGEST_STATED else ""
        label = Label.of(request.title, request.tags)
        terms = Terms(form, label, since, request.priority, limit, kept, request.reuse)
        status = _submit(context, process, inputs, caller, terms, idempotency_key)
        _enter_calls(context, status.jobID, uris)
        response.headers["Location"] = f"/v1/jobs/{status.jobID}"
        if "respond-async" in [item.partition(";")[0].strip().lower() for item in prefer.split(",")]:
            response.headers["Preference-Applied"] = "respond-async"
        return status

    execute.__annotations__["request"] = body
    router.add_api_route(
        f"/{process.id}/execution",
        execute,
        methods=["POST"],
        status_code=201,
        name=process.id.replace("-", "_"),
        summary=process.title,
        description=process.description,
        responses=documented(QueueFull, TooManyHeld, LiveUnavailable)
        | {201: answer("The job", "Location", "Preference-Applied")},
    )


def _submit(
    context: Context,
    process: Process,
    inputs: dict[str, Any],
    caller: Holder,
    terms: Terms,
    name: str | None,
) -> StatusInfo:
    key = process.key(inputs)
    looked = now()
    stored = context.store.find(key, process.kind) is not None
    if not stored and terms.max_cost_s is not None:
        refuse_beyond(terms.max_cost_s, _predicted(context, process, inputs, caller))
    job = context.submissions.submit(
        process.id, key, inputs, stored=stored, looked=looked, caller=caller, terms=terms, name=name
    )
    facts = {"job": job.id, "computation": job.computation, "process": process.id, "key": key}
    logger.info("job entered", **facts, stored=stored)
    context.wake()
    return status_info(job, context.registry)


def _predicted(
    context: Context, process: Process, inputs: dict[str, Any], caller: Holder
) -> dict[str, float]:
    """Return the CPU seconds by stage that the plan of a process predicts; none where it has no plan."""
    if not process.plan:
        return {}
    cache = str(context.settings.data_directory / "compliance")
    order = LiveOrder(process.plan, {**inputs, "time_budget_s": None, "cache": cache})
    asker = Asker(NOBODY if caller is ANYBODY else caller.name, submits=True)
    stages: dict[str, float] = json.loads(context.live.ask(order, asker).result())["prediction"]["stages"]
    return stages


def _summary(process: Process) -> dict[str, Any]:
    path = f"/v1/processes/{process.id}"
    return {
        "id": process.id,
        "title": process.title,
        "description": process.description,
        "version": process.version,
        "jobControlOptions": ["async-execute", "dismiss"],
        "outputTransmission": ["value", "reference"],
        "additionalParameters": _card(process.action, process.inputs),
        "links": [
            Link(href=path, rel="self", title="Description"),
            Link(
                href=f"{path}/execution",
                rel="http://www.opengis.net/def/rel/ogc/1.0/execute",
                title="Execution",
            ),
        ],
    }


@cache
def _card(action: str, inputs: type[BoundaryModel]) -> AdditionalParameters:
    """Return what a page needs to offer a study; nothing of what has no action."""
    if not action:
        return AdditionalParameters(parameters=[])
    subjects: list[Any] = [name for name in _SUBJECTS if name in inputs.model_fields]
    parts = {"action": [action], "subjects": subjects, "fields": [dict(_titled(inputs))]}
    return AdditionalParameters(parameters=[Parameter(name=name, value=parts[name]) for name in parts])


def _titled(inputs: type[BaseModel], within: str = "") -> Iterator[tuple[str, Any]]:
    """Yield names and schemas of the fields that have a title, those of tables by their path."""
    fields = inputs.model_fields.items()
    titled: Any = {name: (field.annotation, field) for name, field in fields if field.title}
    schemas = create_model("Titled", **titled).model_json_schema().get("properties", {})
    for name, field in fields:
        kind = field.annotation
        if field.title:
            yield f"{within}{name}", schemas[name]
        elif name not in _SUBJECTS and isinstance(kind, type) and issubclass(kind, BaseModel):
            yield from _titled(kind, f"{within}{name}.")


def _description(process: Process) -> ProcessDescription:
    schema = process.inputs.model_json_schema()
    inputs = {
        name: ValueDescription(
            title=field.title or name,
            description=field.description or name,
            schema={**schema["properties"][name], "$defs": schema.get("$defs", {})},
        )
        for name, field in process.inputs.model_fields.items()
    }
    output = {"type": "string", "contentEncoding": "binary", "contentMediaType": NETCDF}
    outputs = {
        process.output: ValueDescription(title=process.output, description=process.title, schema=output)
    }
    return ProcessDescription(**_summary(process), inputs=inputs, outputs=outputs)


# Batches: one request, many jobs of one process, all entered or none.


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
    uris = _checked_uris(context.settings, request.subscriber)
    looked = now()
    cases = _cases(context, process, _checked_inputs(context, process, request))
    entry = context.submissions.entry(caller, terms)
    identifier = entry.batch(process.id, cases, looked, idempotency_key)
    _enter_calls(context, identifier, uris)
    logger.info("batch entered", job=identifier, process=process.id, jobs=len(cases))
    context.wake()
    response.headers["Location"] = f"/v1/jobs/{identifier}"
    return status_info(context.submissions.find(identifier), context.registry)


def _checked_inputs(context: Context, process: Process, request: BatchRequest) -> list[Json]:
    """Return the normalized inputs of all jobs.

    Raises `BadInput`: with the faults of all, by their index; if they are too many with the first of each
    job.
    """
    inputs, faults = [], []
    for index in range(len(request.jobs)):
        try:
            model = validated(process.inputs, request.inputs_of(index))
            inputs.append(process.prepare(model, context.store))
        except BadInput as error:
            faults.append(_of_job(index, error))
    if sum(map(len, faults)) > MOST_FAULTS:
        faults = [of_job[:1] for of_job in faults]
    if faults:
        raise BadInput(fault for of_job in faults for fault in of_job)
    return inputs


def _of_job(index: int, error: BadInput) -> list[Fault]:
    """Return the faults of one job, named as in its case or scene file."""
    faults = []
    for fault in error.faults:
        name = fault.field.removeprefix("case.").removeprefix("scene.")
        faults.append(Fault(f"jobs[{index}].{name}", fault.value, fault.bound, fault.suggestion))
    return faults


def _cases(context: Context, process: Process, inputs: Sequence[Json]) -> list[BatchCase]:
    """Return the jobs of a batch: which results are there, and what the others cost beside each other."""
    keys = [process.key(one) for one in inputs]
    stored = {key: context.store.find(key, process.kind) is not None for key in set(keys)}
    new = {key: one for key, one in zip(keys, inputs, strict=True) if not stored[key]}
    costs = _costs(new)
    known = [cost for cost in costs.values() if cost is not None]
    usual = sum(known) / len(known) if known else 1.0
    return [
        BatchCase(key, one, stored[key], costs.get(key) or usual)
        for key, one in zip(keys, inputs, strict=True)
    ]


def _costs(inputs: dict[str, Json]) -> dict[str, float | None]:
    """Predict what jobs cost, as many as there is time for: the others cost as much as these do."""
    costs: dict[str, float | None] = {}
    end = time.thread_time() + _PREDICTING_S
    for key, one in inputs.items():
        costs[key] = predicted_seconds(one)
        if time.thread_time() > end:
            break
    return costs
