"""Results of jobs in the form that was requested (OGC API - Processes 1.0, clauses 7.11.2 and 7.13)."""

from __future__ import annotations

import json
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from starlette.responses import JSONResponse, Response

from service.problems import Fault, JobDismissed, JobFailed, ResultNotReady
from service.queue.delivery import Delivery, Transmission, delivery
from service.queue.delivery import Response as Form
from service.queue.job import Job
from service.registry import NETCDF
from service.routes.context import Context, Ctx
from service.routes.errors import documented
from service.routes.media_types import JSON
from service.routes.results import file_response
from service.schemas.ogc import ResultReference
from service.schemas.result_kinds import RESULT_KINDS, RESULTS, ResultKind

router = APIRouter(prefix="/jobs", tags=["jobs"])

AskedForm = Annotated[Form | None, Query(description="Form, instead of that of the execution")]
AskedMode = Annotated[
    Transmission | None,
    Query(alias="transmissionMode", description="Transmission, instead of that of the execution"),
]
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The result, or a document of it by the name of its output",
        "content": {
            JSON: {"schema": {"type": "object"}},
            NETCDF: {"schema": {"type": "string", "format": "binary"}},
        },
    },
    204: {"description": "The result is where the header Link says"},
    304: {"description": "Not modified"},
}


@router.get(
    "/{job_id}/results",
    summary="Results of a job",
    response_class=Response,
    responses=_ANSWERS | documented(404, 410, 422, 500),
)
def results(
    job_id: str, request: Request, context: Ctx, response: AskedForm = None, mode: AskedMode = None
) -> Response:
    """Return the result as the execution requested it; say why there is none."""
    job = context.submissions.find(job_id)
    _refuse_without_result(job)
    process = context.registry[job.process]
    kind = RESULT_KINDS[process.kind]
    form = _form(job.delivery, response, mode, kind)
    if form.transmission == "reference":
        return _referenced(form, process.output, f"{RESULTS}/{job.key}", job.key, kind)
    return _valued(form, process.output, job.key, kind, request, context)


def _form(ordered: Delivery, response: Form | None, mode: Transmission | None, kind: ResultKind) -> Delivery:
    """Return the form of the execution, or the one that this request asks for instead."""
    if response is None and mode is None:
        return ordered
    return delivery(response or ordered.response, mode, kind.media_type, "transmissionMode")


def _referenced(form: Delivery, output: str, href: str, key: str, kind: ResultKind) -> Response:
    """Say where the result is."""
    if form.response == "raw":
        link = f'<{href}>; rel="item"; type="{kind.media_type}"; title="{output}"'
        return Response(status_code=204, headers={"Link": link})
    return JSONResponse({output: ResultReference(href=href, type=kind.media_type, hash=key).model_dump()})


def _valued(
    form: Delivery, output: str, key: str, kind: ResultKind, request: Request, context: Context
) -> Response:
    """Return the result itself; in a document as a qualified value, as the standard has objects."""
    stored = context.store.verified(key, kind.name)
    if form.response == "raw":
        return file_response(stored, request, {"Content-Location": f"{RESULTS}/{key}"})
    opened = json.dumps({output: {"mediaType": kind.media_type, "value": None}}).removesuffix("null}}")
    return Response(opened.encode() + stored.path.read_bytes() + b"}}", media_type=JSON)


def _refuse_without_result(job: Job) -> None:
    """Raise what says why a job has no result."""
    if job.status == "failed":
        raise JobFailed(job.message, [Fault(**fault) for fault in job.faults])
    if job.status == "dismissed":
        raise JobDismissed(f"Job {job.id} was cancelled.")
    if job.status != "successful":
        raise ResultNotReady(f"Job {job.id} is {job.status}: {job.message}")
