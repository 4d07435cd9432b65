"""Processes and their executions (OGC API - Processes 1.0, clauses 7.8 to 7.11).

An execution becomes a *job* of a caller. Jobs with the same inputs, by their *key*, share a computation and
its stored result.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from typing import Annotated, Any, cast

import structlog
from fastapi import APIRouter, Header, Query, Response
from pydantic import BaseModel, create_model

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import LiveUnavailable, NoSuchProcess, QueueFull, TooManyHeld
from lineofaction.gearbox.registry import NETCDF
from lineofaction.gearbox.schemas.model import BoundaryModel
from service.access.holder import Holder, Scope
from service.live.order import LiveOrder
from service.live.turns import Asker
from service.queue.differences import differences_between
from service.queue.terms import Label, Terms, check_priority, cost_limit, delivery, refuse_beyond
from service.routes.callbacks import checked_uris, enter_calls
from service.routes.context import Context, Ctx, From
from service.routes.jobs import status_info
from service.routes.list_pages import Limit
from service.routes.media_types import answer
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
    ValueDescription,
)
from service.schemas.execute import execute_model
from service.store.database import now
from service.worker.process import Process, Registry

logger = structlog.get_logger(__name__)
After = Annotated[str, Query(max_length=64, description="Last process of the previous page")]
_SUBJECTS = ("case", "scene")
"""Inputs that are the subject of a process: they are not listed among its fields."""
_MAX_SPECIFIED = 65_536
"""Most characters of a caller's inputs that are stored with each job, in addition to the inputs of its
computation."""
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
predicted_seconds = on_demand("service.worker.expectations:predicted_seconds")


def processes_router(registry: Registry) -> APIRouter:
    """Return the routes, one execution route per process, so that each body has its own schema."""
    router = APIRouter(prefix="/processes", tags=["processes"], route_class=ScopedRoute)

    @router.get("", summary="Processes", responses=documented(NoSuchProcess))
    @needs(Scope.READ)
    def list_processes(limit: Limit = 100, after: After = "") -> ProcessList:
        """All that can be run."""
        start = list(registry).index(registry[after].id) + 1 if after else 0
        remaining = list(registry.values())[start:]
        page = remaining[:limit]
        links = [Link(href="/v1/processes", rel="self", title="Processes")]
        if len(remaining) > limit:
            following = f"/v1/processes?limit={limit}&after={page[-1].id}"
            links.append(Link(href=following, rel="next", title="Next page"))
        return ProcessList(processes=[ProcessSummary(**_summary(p)) for p in page], links=links)

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
        """Refuse a name that no process has."""
        return _description(registry[process_id])

    return router


def _add_execution(router: APIRouter, process: Process) -> None:
    """Add the execution route of a process, whose body has the schema of its inputs."""
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
        uris = checked_uris(context.settings, request.subscriber)
        inputs = process.prepare(cast(BoundaryModel, request.inputs), context.store)
        # what differs from the caller's last job of this process, or from the defaults in the first one
        former = context.submissions.newest(caller, process.id)
        if former is None:
            defaults = request.inputs.model_dump(mode="json", exclude_defaults=True)
            since = differences_between({}, defaults)
        else:
            former_job, former_inputs = former
            since = differences_between(former_inputs, inputs, former_job)
        check_priority(request.priority, caller)
        limit = cost_limit(request.max_cost_s, caller)
        text = json.dumps(request.inputs.model_dump(mode="json", exclude_unset=True))
        retained = text if len(text) <= _MAX_SPECIFIED else ""
        label = Label.of(request.title, request.tags)
        terms = Terms(form, label, since, request.priority, limit, retained, request.reuse)
        status = _submit(context, process, inputs, caller, terms, idempotency_key)
        enter_calls(context, status.jobID, uris)
        response.headers["Location"] = f"/v1/jobs/{status.jobID}"
        if "respond-async" in [item.partition(";")[0].strip().lower() for item in prefer.split(",")]:
            response.headers["Preference-Applied"] = "respond-async"
        return status

    execute.__annotations__["request"] = body  # FastAPI reads the schema of the body from the annotation
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
    """Enter a job, named by the caller's idempotency key `name` if there is one; return its status."""
    key = process.key(inputs)
    looked = now()
    stored = context.store.find(key, process.kind) is not None
    if not stored and terms.max_cost_s is not None:
        refuse_beyond(terms.max_cost_s, _predicted(context, process, inputs, caller))
    job = context.submissions.submit(
        process.id, key, inputs, stored=stored, looked=looked, caller=caller, terms=terms, name=name
    )
    fields = {"job": job.id, "computation": job.computation, "process": process.id, "key": key}
    logger.info("job entered", **fields, stored=stored)
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
    asker = Asker(caller.name, submits=True)
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
    """Return the data from which a page offers a study; empty for a process without an action."""
    if not action:
        return AdditionalParameters(parameters=[])
    subjects: list[Any] = [name for name in _SUBJECTS if name in inputs.model_fields]
    parts = {"action": [action], "subjects": subjects, "fields": [dict(_titled(inputs))]}
    return AdditionalParameters(parameters=[Parameter(name=name, value=parts[name]) for name in parts])


def _titled(inputs: type[BaseModel], within: str = "") -> Iterator[tuple[str, Any]]:
    """Yield names and schemas of the fields with a title, fields of tables by their path."""
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
