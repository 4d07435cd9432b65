"""Jobs: list, status, dismissal, results (OGC API - Processes 1.0, clauses 7.11.2, 7.12, 7.13, 11, 13)."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Annotated, Any, Literal, Union

from fastapi import APIRouter, Depends, Header, Query, Request
from pydantic import Field
from starlette.responses import JSONResponse, Response

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import (
    BadInput,
    DamagedFile,
    Fault,
    JobDismissed,
    JobFailed,
    NoSuchJob,
    NotFound,
    ResultNotReady,
    ServiceError,
)
from lineofaction.gearbox.registry import NETCDF, RESULTS
from service.access.keyring import Scope
from service.queue.job import Job, JobFilter, subject_of
from service.queue.terms import Delivery, Transmission, delivery
from service.queue.terms import Response as Form
from service.routes.context import Context, Ctx, caller_of
from service.routes.headlines import with_headlines
from service.routes.lists import LISTED, list_answer
from service.routes.media_types import (
    JSON,
    OF_VERSIONS,
    Cursor,
    Limit,
    answer,
    mark_of,
    negotiated,
    page_links,
)
from service.routes.openapi import documented
from service.routes.results import FILE, OF_RESULT, file_response, known_result
from service.routes.scopes import ScopedRoute, needs, require
from service.schemas.answers import (
    JobInputs,
    JobList,
    JobStatus,
    Link,
    ProblemBody,
    ResultReference,
    StatusInfo,
    results_document,
)
from service.schemas.execute import BatchResult, BatchResults, LabelChange, Tag, Title
from service.store.results import Mark
from service.webhooks.calls import Calls
from service.worker.process import Registry

# Parameters by which a list of jobs is filtered (OGC API - Processes 1.0, clause 12.2).


_DURATION: dict[str, Any] = {"ge": 0, "le": 1_000_000_000}


Processes = Annotated[
    list[Annotated[str, Field(pattern="^[A-Za-z0-9_-]{1,64}$")]],
    Query(alias="processID", max_length=32, description="Jobs of these processes"),
]
States = Annotated[list[JobStatus], Query(max_length=16, description="Jobs in these states")]
Types = Annotated[
    list[Literal["process"]],
    Query(alias="type", max_length=4, description="Type of jobs; all jobs are of type process"),
]
Created = Annotated[
    str,
    Query(
        alias="datetime",
        max_length=100,
        description="Jobs created at this instant, or in an interval start/end with .. for an open end",
    ),
]
AtLeast = Annotated[
    int,
    Query(alias="minDuration", description="Jobs that ran for at least this many seconds", **_DURATION),
]
AtMost = Annotated[
    int | None,
    Query(alias="maxDuration", description="Jobs that ran for at most this many seconds", **_DURATION),
]
Tags = Annotated[list[Tag], Query(max_length=16, description="Jobs that have all of these tags")]
Words = Annotated[Title, Query(description="Jobs with all of these words in their title, in any case")]
Parent = Annotated[
    str | None,
    Query(pattern="^[0-9a-f-]{36}$", description="Jobs of this batch; without it, batches and jobs of none"),
]

Once = Annotated[
    bool, Query(description="Of jobs with one result the newest alone; one in vain where all are")
]
router = APIRouter(prefix="/jobs", tags=["jobs"], route_class=ScopedRoute)
input_warnings = on_demand("service.worker.preparations:input_warnings")
AskedForm = Annotated[Form | None, Query(description="Form of the result; overrides that of the execution")]
AskedMode = Annotated[
    Transmission | None,
    Query(alias="transmissionMode", description="Transmission mode; overrides that of the execution"),
]
AskedType = Annotated[
    str,
    Header(
        alias="Accept",
        description=f"{JSON} for the document, which generated clients prefer by default; {NETCDF} for the "
        "file. A request without it, or that takes both, gets the form of the execution.",
    ),
]
_REFUSED = documented(NoSuchJob, ResultNotReady, NotFound, JobDismissed, JobFailed, DamagedFile)


async def job_filter(
    process_id: Processes = [],  # noqa: B006 (the framework copies it)
    status: States = [],  # noqa: B006
    kind: Types = [],  # noqa: B006
    instant: Created = "../..",
    shortest: AtLeast = 0,
    longest: AtMost = None,
    tag: Tags = [],  # noqa: B006
    title: Words = "",
    parent: Parent = None,
    once: Once = False,
) -> JobFilter:
    """Return what the parameters ask for."""
    earliest, latest = _interval(instant)
    return JobFilter(
        tuple(process_id),
        tuple(status),
        earliest,
        latest,
        float(shortest) if shortest else None,
        longest,
        tuple(tag),
        tuple(title.split()),
        parent=parent,
        once=once,
    )


JobQuery = Annotated[JobFilter, Depends(job_filter)]


def _interval(text: str) -> tuple[str | None, str | None]:
    """Return both ends of an interval; of an instant, twice the same."""
    parts = text.split("/")
    try:
        if len(parts) > 2 or parts == [".."]:
            raise ValueError(text)
        ends = [None if part in ("", "..") and len(parts) == 2 else _instant(part) for part in parts]
    except (ValueError, OverflowError):
        bound = "an RFC 3339 instant such as 2026-01-31T12:00:00Z, or start/end with .. for an open end"
        raise BadInput.of("datetime", text, bound, "Give the time zone, Z for UTC.") from None
    return ends[0], ends[-1]


def _instant(text: str) -> str:
    instant = datetime.fromisoformat(text)
    if instant.tzinfo is None:
        raise ValueError(text)
    return instant.astimezone(UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")


@router.get("", summary="Jobs", response_model=JobList, responses=LISTED)
@needs(Scope.READ)
async def list_jobs(
    request: Request, context: Ctx, job_filter: JobQuery, limit: Limit = 100, cursor: Cursor = None
) -> Response:
    """Jobs, the newest first; filters add up."""
    after = mark_of(cursor)

    def page() -> JobList:
        found = context.submissions.page(limit + 1, job_filter, after)
        shown = [status_info(job, context.registry) for job in with_headlines(found[:limit], context)]
        last = Mark(found[limit - 1].created, found[limit - 1].id) if len(found) > limit else None
        return JobList(jobs=shown, links=page_links(request, "/v1/jobs", last))

    return await list_answer(request, page)


@router.get("/{job_id}", summary="Status of a job", responses=documented(NoSuchJob))
@needs(Scope.READ)
def job_status(job_id: str, context: Ctx) -> StatusInfo:
    """Status and progress of the job."""
    (job,) = with_headlines([context.submissions.find(job_id)], context)
    status = status_info(job, context.registry)
    return status.model_copy(update={"webhooks": Calls(context.engine).of(job_id) or None})


@router.get("/{job_id}/inputs", summary="Inputs of a job", responses=documented(NoSuchJob))
@needs(Scope.READ)
def job_inputs(job_id: str, context: Ctx) -> JobInputs:
    """Return the inputs as the caller stated them, those of a batch's job and long ones with all defaults."""
    job = context.submissions.find(job_id)
    return JobInputs(processID=job.process, inputs=json.loads(job.stated))


@router.patch("/{job_id}", summary="Rename a job", responses=documented(NoSuchJob))
@needs(Scope.SUBMIT)
def relabel_job(job_id: str, change: LabelChange, request: Request, context: Ctx) -> StatusInfo:
    """Change title and tags of a job, ended or not; what is left out stays.

    Jobs that others of the project submitted need the scope operate.
    """
    _require_own(job_id, request, context)
    return status_info(context.submissions.relabel(job_id, change.title, change.tags), context.registry)


@router.delete("/{job_id}", summary="Dismiss a job", responses=documented(NoSuchJob))
@needs(Scope.DISMISS)
def dismiss_job(job_id: str, request: Request, context: Ctx) -> StatusInfo:
    """Cancel: the work ends unless other jobs share it. A job that has ended stays as it is.

    Jobs that others of the project submitted need the scope operate.
    """
    _require_own(job_id, request, context)
    job = context.submissions.dismiss(job_id)
    context.wake()
    return status_info(job, context.registry)


def _require_own(job_id: str, request: Request, context: Context) -> None:
    """Raise unless a job is the caller's own, or the caller may do that with others'."""
    if context.submissions.find(job_id).caller != caller_of(request).name:
        require(request, Scope.OPERATE)


def status_info(job: Job, registry: Registry) -> StatusInfo:
    """Return a job as the standard's status document, with what is implausible about its inputs."""
    path = f"/v1/jobs/{job.id}"
    links = [
        Link(href=path, rel="self", title="Status"),
        Link(href=f"{path}/events", rel="monitor", type="text/event-stream", title="Changes of the status"),
    ]
    if job.children:
        links.append(Link(href=f"/v1/jobs?parent={job.id}", rel="item", title="Jobs of the batch"))
    if job.parent is not None:
        links.append(Link(href=f"/v1/jobs/{job.parent}", rel="up", title="Batch"))
    if job.status == "successful" or (job.children and job.ended):
        relation = "http://www.opengis.net/def/rel/ogc/1.0/results"
        links.append(Link(href=f"{path}/results", rel=relation, title="Results"))
    alike = {name: getattr(job, name) for name in StatusInfo.model_fields.keys() & vars(job)}
    return StatusInfo(
        **alike,
        processID=job.process,
        jobID=job.id,
        title=job.label.title,
        tags=list(job.label.tags),
        subject=subject_of(job.inputs),
        progress=min(int(100 * job.fraction), 100 if job.status == "successful" else 99),
        remaining_s=job.remaining_s(datetime.now(UTC)),
        stage_progress=int(100 * job.stage_fraction),
        parentID=job.parent,
        links=links,
        warnings=list(input_warnings(job.inputs)),
    )


# Results in the form that was requested.


def job_results_router(registry: Registry) -> APIRouter:
    """Return the route, whose documents are typed by the processes that make them."""
    router = APIRouter(prefix="/jobs", tags=["jobs"], route_class=ScopedRoute)
    documents = [results_document(process.id, process.output) for process in registry.values()]
    answers: dict[int | str, dict[str, Any]] = {
        200: answer(
            "A document of where the result is by the name of its output, or its file; of a batch what came "
            "of each of its jobs, in order",
            *(*OF_RESULT, "Content-Digest", "Content-Location"),
            model=Union[(*documents, BatchResults)],
            content={JSON: {}, NETCDF: {"schema": FILE}},
        ),
        204: answer("The result is where the header Link says", "Link", "Vary"),
        304: answer("Not modified", *OF_VERSIONS, "Result-Kind", "Content-Location"),
    }
    router.add_api_route(
        "/{job_id}/results",
        job_results,
        summary="Results of a job",
        response_class=Response,
        responses=answers | _REFUSED,
    )
    return router


@needs(Scope.READ)
def job_results(
    job_id: str,
    request: Request,
    context: Ctx,
    response: AskedForm = None,
    mode: AskedMode = None,
    _accept: AskedType = JSON,  # for the description: in a request without it, any type will do
) -> Response:
    """Return the result as the execution requested it, or as this request does; say why there is none."""
    job = context.submissions.find(job_id)
    if job.children:
        return JSONResponse(batch_results(context, job).model_dump())
    problem = problem_of(job)
    if problem is not None:
        raise problem
    process = context.registry[job.process]
    if response is None and mode is None:
        form = _accepted(job.delivery, request.headers.get("accept", "*/*"))
    else:
        form = delivery(response or job.delivery.response, mode, "transmissionMode")
    reference = reference_of(job)
    if form.transmission == "reference" and form.response == "raw":
        link = f'<{reference.href}>; rel="item"; type="{NETCDF}"; title="{process.output}"'
        return Response(status_code=204, headers={"Link": link, "Vary": "Accept"})
    if form.transmission == "reference":
        return JSONResponse({process.output: reference.model_dump()}, headers={"Vary": "Accept"})
    place = {"Content-Location": reference.href}
    return file_response(known_result(context, job.key, process.kind), request, place)


def _accepted(ordered: Delivery, accept: str) -> Delivery:
    """Return the form of the execution, or the other one if the caller prefers its type."""
    offered = (JSON, NETCDF) if ordered.response == "document" else (NETCDF, JSON)
    accepted = negotiated(accept, offered)
    if accepted in (None, offered[0]):
        return ordered
    return delivery("document" if accepted == JSON else "raw", None, "transmissionMode")


def batch_results(context: Context, batch: Job) -> BatchResults:
    """Return what came of the jobs of a batch, in order."""
    if not batch.ended:
        raise ResultNotReady(f"Batch {batch.id} is {batch.status}: {batch.message}")
    output = context.registry[batch.process].output
    return BatchResults(jobs=[_in_batch(job, output) for job in context.submissions.children(batch.id)])


def _in_batch(job: Job, output: str) -> BatchResult:
    problem, results = problem_of(job), {output: reference_of(job)}
    if problem is None:
        return BatchResult(jobID=job.id, status="successful", results=results, problem=None)
    status: JobStatus = job.status  # type: ignore[assignment]  # the table holds no others
    body = ProblemBody.model_validate(problem.as_json())
    return BatchResult(jobID=job.id, status=status, results=None, problem=body)


def problem_of(job: Job) -> ServiceError | None:
    """Return what says why a job has no result, None if it has one."""
    if job.status == "failed":
        return JobFailed(job.message, [Fault(**fault) for fault in job.faults])
    if job.status == "dismissed":
        return JobDismissed(f"Job {job.id} was cancelled.")
    if job.status != "successful":
        return ResultNotReady(f"Job {job.id} is {job.status}: {job.message}")
    return None


def reference_of(job: Job) -> ResultReference:
    """Return where the result of a job is."""
    return ResultReference(href=f"{RESULTS}/{job.key}", type=NETCDF, hash=job.key)
