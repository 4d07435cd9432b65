"""Results of jobs in the form that was requested (OGC API - Processes 1.0, clauses 7.11.2 and 7.13)."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from starlette.responses import JSONResponse, Response

from service.problems import Fault, JobDismissed, JobFailed, ResultNotReady
from service.queue.delivery import Delivery, Transmission, delivery
from service.queue.delivery import Response as Form
from service.queue.job import Job
from service.registry import NETCDF
from service.routes.context import Ctx
from service.routes.errors import documented
from service.routes.media_types import JSON
from service.routes.results import file_response, known_result
from service.schemas.ogc import ResultReference
from service.schemas.result_kinds import RESULTS

router = APIRouter(prefix="/jobs", tags=["jobs"])

AskedForm = Annotated[Form | None, Query(description="Form of the result; overrides that of the execution")]
AskedMode = Annotated[
    Transmission | None,
    Query(alias="transmissionMode", description="Transmission mode; overrides that of the execution"),
]
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The result, or a document of where it is by the name of its output",
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
    form = _form(job.delivery, response, mode)
    href = f"{RESULTS}/{job.key}"
    if form.transmission == "reference":
        return _referenced(form, process.output, href, job.key)
    return file_response(known_result(context, job.key, process.kind), request, {"Content-Location": href})


def _form(ordered: Delivery, response: Form | None, mode: Transmission | None) -> Delivery:
    """Return the form of the execution, or the one that this request asks for instead."""
    if response is None and mode is None:
        return ordered
    return delivery(response or ordered.response, mode, "transmissionMode")


def _referenced(form: Delivery, output: str, href: str, key: str) -> Response:
    """Say where the result is."""
    if form.response == "raw":
        link = f'<{href}>; rel="item"; type="{NETCDF}"; title="{output}"'
        return Response(status_code=204, headers={"Link": link})
    return JSONResponse({output: ResultReference(href=href, type=NETCDF, hash=key).model_dump()})


def _refuse_without_result(job: Job) -> None:
    """Raise what says why a job has no result."""
    if job.status == "failed":
        raise JobFailed(job.message, [Fault(**fault) for fault in job.faults])
    if job.status == "dismissed":
        raise JobDismissed(f"Job {job.id} was cancelled.")
    if job.status != "successful":
        raise ResultNotReady(f"Job {job.id} is {job.status}: {job.message}")
