"""Jobs: list, status, names and dismissal (OGC API - Processes 1.0, clauses 7.11.2, 7.12, 11, 13)."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Depends, Query, Request
from pydantic import Field
from starlette.responses import Response

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import BadInput, NoSuchJob
from service.access.holder import Scope
from service.queue.job import Job, JobFilter, subject_of
from service.routes.context import Context, Ctx, caller_of
from service.routes.headlines import with_headlines
from service.routes.list_pages import Cursor, Limit, mark_of, page_links
from service.routes.lists import LISTED, list_answer
from service.routes.openapi import documented
from service.routes.scopes import ScopedRoute, needs, require
from service.schemas.answers import JobInputs, JobList, JobStatus, Link, StatusInfo
from service.schemas.execute import LabelChange, Tag, Title
from service.store.results import Mark
from service.webhooks.calls import Calls
from service.worker.process import Registry

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
Wording = Annotated[Title, Query(description="Jobs with all of these words in their title, in any case")]
Parent = Annotated[
    str | None,
    Query(pattern="^[0-9a-f-]{36}$", description="Jobs of this batch; without it, batches and jobs of none"),
]

Once = Annotated[
    bool,
    Query(
        description="Whether of jobs with one result only the newest is listed; if all such jobs failed, "
        "one of them"
    ),
]
router = APIRouter(prefix="/jobs", tags=["jobs"], route_class=ScopedRoute)
input_warnings = on_demand("service.worker.expectations:input_warnings")


async def job_filter(
    process_id: Processes = [],  # noqa: B006 (the framework copies it)
    status: States = [],  # noqa: B006
    kind: Types = [],  # noqa: B006
    instant: Created = "../..",
    shortest: AtLeast = 0,
    longest: AtMost = None,
    tag: Tags = [],  # noqa: B006
    title: Wording = "",
    parent: Parent = None,
    once: Once = False,
) -> JobFilter:
    """Return the filter of jobs by the parameters."""
    earliest, latest = _interval(instant)
    return JobFilter(
        processes=tuple(process_id),
        statuses=tuple(status),
        earliest=earliest,
        latest=latest,
        shortest_s=float(shortest) if shortest else None,
        longest_s=longest,
        tags=tuple(tag),
        words=tuple(title.split()),
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
        matches = context.submissions.page(limit + 1, job_filter, after)
        infos = [status_info(job, context.registry) for job in with_headlines(matches[:limit], context)]
        last = Mark(matches[limit - 1].created, matches[limit - 1].id) if len(matches) > limit else None
        return JobList(jobs=infos, links=page_links(request, "/v1/jobs", last))

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
    """Return the inputs as the caller stated them; of a batch's job, and long ones, with all defaults."""
    job = context.submissions.find(job_id)
    return JobInputs(processID=job.process, inputs=json.loads(job.stated))


@router.patch("/{job_id}", summary="Rename a job", responses=documented(NoSuchJob))
@needs(Scope.SUBMIT)
def relabel_job(job_id: str, change: LabelChange, request: Request, context: Ctx) -> StatusInfo:
    """Change title and tags of a job, ended or not; a member that is left out stays.

    Jobs that others of the project submitted need the scope operate.
    """
    _require_owner(job_id, request, context)
    return status_info(context.submissions.relabel(job_id, change.title, change.tags), context.registry)


@router.delete("/{job_id}", summary="Dismiss a job", responses=documented(NoSuchJob))
@needs(Scope.DISMISS)
def dismiss_job(job_id: str, request: Request, context: Ctx) -> StatusInfo:
    """Cancel: the work ends unless other jobs share it. A job that has ended stays as it is.

    Jobs that others of the project submitted need the scope operate.
    """
    _require_owner(job_id, request, context)
    job = context.submissions.dismiss(job_id)
    context.wake()
    return status_info(job, context.registry)


def _require_owner(job_id: str, request: Request, context: Context) -> None:
    """Raise unless the caller submitted the job, or may operate on jobs of others."""
    if context.submissions.find(job_id).caller != caller_of(request).name:
        require(request, Scope.OPERATE)


def status_info(job: Job, registry: Registry) -> StatusInfo:
    """Return a job as the standard's status document, with warnings of implausible inputs."""
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
    common = {name: getattr(job, name) for name in StatusInfo.model_fields.keys() & vars(job)}
    return StatusInfo(
        **common,
        processID=job.process,
        jobID=job.id,
        title=job.label.title,
        tags=list(job.label.tags),
        subject=subject_of(job.inputs),
        progress=min(int(100 * job.fraction), 100 if job.status == "successful" else 99),  # 100: successful
        remaining_s=job.remaining_s(datetime.now(UTC)),
        stage_progress=int(100 * job.stage_fraction),
        parentID=job.parent,
        links=links,
        warnings=list(input_warnings(job.inputs)),
    )
