"""Processes and their execution (OGC API - Processes 1.0, clauses 7.8 to 7.11)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from functools import cache
from typing import Annotated, Any, cast

import structlog
from fastapi import APIRouter, Header, Query, Response
from pydantic import BaseModel, create_model

from lineofaction.gearbox.problems import LiveUnavailable, NoSuchProcess, QueueFull
from lineofaction.gearbox.registry import NETCDF
from lineofaction.gearbox.schemas.model import BoundaryModel
from service.access import Scope
from service.live.order import LiveOrder
from service.queue.cost_limit import cost_limit, refuse_beyond
from service.queue.differences import Differences
from service.queue.former_jobs import FormerJobs
from service.queue.terms import Caller, Label, Terms, check_priority, delivery
from service.routes.context import Context, Ctx, From
from service.routes.cursor import Limit
from service.routes.jobs import status_info
from service.routes.media_types import described_headers
from service.routes.refusals import documented
from service.routes.scopes import ScopedRoute, needs
from service.routes.webhooks import checked_uris, enter_calls
from service.schemas.execute import execute_model
from service.schemas.ogc import (
    AdditionalParameters,
    Link,
    Parameter,
    ProcessDescription,
    ProcessList,
    ProcessSummary,
    StatusInfo,
    ValueDescription,
)
from service.store import now
from service.worker.process import Process, Registry

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


def processes_router(registry: Registry) -> APIRouter:
    """Return the routes, one execution route per process, so that each body has its own schema."""
    router = APIRouter(prefix="/processes", tags=["processes"], route_class=ScopedRoute)

    @router.get("", summary="Processes", responses=documented(NoSuchProcess))
    @needs(Scope.READ)
    def list_processes(limit: Limit = 100, after: After = "") -> ProcessList:
        """All that can be run."""
        behind = list(registry.values())[_place(registry, after) :]
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
    router.add_api_route(
        "/{process_id}/execution",
        _other_name(registry),
        methods=["POST"],
        include_in_schema=False,
    )
    return router


def _place(registry: Registry, after: str) -> int:
    """Return how many processes come before what follows `after`, none without it."""
    return list(registry).index(registry[after].id) + 1 if after else 0


def _other_name(registry: Registry) -> Any:
    """Return the handler of executions by names without a route: those of no process."""

    @needs(Scope.SUBMIT)
    def execute_other(process_id: str) -> Response:
        raise registry.unknown(process_id)

    return execute_other


def _add_execution(router: APIRouter, process: Process) -> None:
    body = execute_model(process.id, process.inputs, process.output)

    @needs(Scope.SUBMIT)
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
        since = _differences(context, process, caller, inputs, request.inputs)
        check_priority(request.priority, caller)
        limit = cost_limit(request.max_cost_s, caller)
        label, stated = Label.of(request.title, request.tags), _stated(request.inputs)
        terms = Terms(form, label, since, request.priority, limit, stated, request.reuse)
        status = _submit(context, process, inputs, caller, terms, idempotency_key)
        enter_calls(context, status.jobID, uris)
        response.headers["Location"] = f"/v1/jobs/{status.jobID}"
        if "respond-async" in [item.partition(";")[0].strip().lower() for item in prefer.split(",")]:
            response.headers["Preference-Applied"] = "respond-async"
        return status

    execute.__annotations__["request"] = body
    execute.body_model = body  # type: ignore[attr-defined]
    router.add_api_route(
        f"/{process.id}/execution",
        execute,
        methods=["POST"],
        status_code=201,
        name=process.id.replace("-", "_"),
        summary=process.title,
        description=process.description,
        responses=documented(QueueFull, LiveUnavailable)
        | {201: {"description": "The job", "headers": described_headers("Location", "Preference-Applied")}},
    )


def _stated(inputs: BoundaryModel) -> str:
    """Return inputs as JSON without what the caller left out; empty if they are long."""
    text = json.dumps(inputs.model_dump(mode="json", exclude_unset=True))
    return text if len(text) <= _LONGEST_STATED else ""


def _differences(
    context: Context, process: Process, caller: Caller, inputs: dict[str, Any], stated: BoundaryModel
) -> Differences:
    """Return what sets normalized inputs apart from the caller's job before, or else from the defaults."""
    former = FormerJobs(context.engine, context.project).newest(caller, process.id)
    if former is None:
        return Differences.between({}, stated.model_dump(mode="json", exclude_defaults=True))
    return Differences.between(former[1], inputs, former[0])


def _submit(
    context: Context,
    process: Process,
    inputs: dict[str, Any],
    caller: Caller,
    terms: Terms,
    name: str | None,
) -> StatusInfo:
    """Enter a job and wake the scheduler."""
    key = process.key(inputs)
    looked = now()
    stored = context.store.find(key, process.kind) is not None
    if not stored and terms.max_cost_s is not None:
        refuse_beyond(terms.max_cost_s, _predicted(context, process, inputs))
    job = context.submissions.submit(
        process.id, key, inputs, stored=stored, looked=looked, caller=caller, terms=terms, name=name
    )
    facts = {"job": job.id, "computation": job.computation, "process": process.id, "key": key}
    logger.info("job entered", **facts, stored=stored)
    context.scheduler.wake()
    return status_info(job, context.registry)


def _predicted(context: Context, process: Process, inputs: dict[str, Any]) -> dict[str, float]:
    """Return the CPU seconds by stage that the plan of a process predicts; none where it has no plan."""
    if not process.plan:
        return {}
    cache = str(context.settings.data_directory / "compliance")
    order = LiveOrder(process.plan, {**inputs, "time_budget_s": None, "cache": cache})
    stages: dict[str, float] = json.loads(context.live.ask(order).result())["prediction"]["stages"]
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
