"""Results of jobs in the form that was requested (OGC API - Processes 1.0, clauses 7.11.2 and 7.13)."""

from __future__ import annotations

from typing import Annotated, Any, Union

from fastapi import APIRouter, Header, Query, Request
from starlette.responses import JSONResponse, Response

from service.access import Scope
from service.problems import DamagedFile, Fault, JobDismissed, JobFailed, NoSuchJob, NotFound, ResultNotReady
from service.queue.delivery import Delivery, Transmission, delivery
from service.queue.delivery import Response as Form
from service.queue.job import Job
from service.registry import NETCDF
from service.routes.context import Ctx
from service.routes.media_types import JSON, negotiated
from service.routes.refusals import documented
from service.routes.response_headers import OF_VERSIONS, described_headers
from service.routes.results import FILE, OF_RESULT, file_response, known_result
from service.routes.scopes import ScopedRoute, needs
from service.schemas.ogc import ResultReference, results_document
from service.schemas.result_kinds import RESULTS
from service.worker.process import Registry

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


def job_results_router(registry: Registry) -> APIRouter:
    """Return the route, whose documents are typed by the processes that make them."""
    router = APIRouter(prefix="/jobs", tags=["jobs"], route_class=ScopedRoute)
    answers: dict[int | str, dict[str, Any]] = {
        200: {
            "model": Union[tuple(results_document(p.id, p.output) for p in registry.values())],  # noqa: UP007
            "description": "A document of where the result is by the name of its output, or its file",
            "content": {JSON: {}, NETCDF: {"schema": FILE}},
            "headers": described_headers(*OF_RESULT, "Content-Digest", "Content-Location"),
        },
        204: {
            "description": "The result is where the header Link says",
            "headers": described_headers("Link", "Vary"),
        },
        304: {
            "description": "Not modified",
            "headers": described_headers(*OF_VERSIONS, "Result-Kind", "Content-Location"),
        },
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
    _refuse_without_result(job)
    process = context.registry[job.process]
    if response is None and mode is None:
        form = _accepted(job.delivery, request.headers.get("accept", "*/*"))
    else:
        form = delivery(response or job.delivery.response, mode, "transmissionMode")
    href = f"{RESULTS}/{job.key}"
    if form.transmission == "reference":
        return _referenced(form, process.output, href, job.key)
    return file_response(known_result(context, job.key, process.kind), request, {"Content-Location": href})


def _accepted(ordered: Delivery, accept: str) -> Delivery:
    """Return the form of the execution, or the other one if the caller prefers its type."""
    offered = (JSON, NETCDF) if ordered.response == "document" else (NETCDF, JSON)
    accepted = negotiated(accept, offered)
    if accepted in (None, offered[0]):
        return ordered
    return delivery("document" if accepted == JSON else "raw", None, "transmissionMode")


def _referenced(form: Delivery, output: str, href: str, key: str) -> Response:
    """Say where the result is."""
    if form.response == "raw":
        link = f'<{href}>; rel="item"; type="{NETCDF}"; title="{output}"'
        return Response(status_code=204, headers={"Link": link, "Vary": "Accept"})
    reference = ResultReference(href=href, type=NETCDF, hash=key)
    return JSONResponse({output: reference.model_dump()}, headers={"Vary": "Accept"})


def _refuse_without_result(job: Job) -> None:
    """Raise what says why a job has no result."""
    if job.status == "failed":
        raise JobFailed(job.message, [Fault(**fault) for fault in job.faults])
    if job.status == "dismissed":
        raise JobDismissed(f"Job {job.id} was cancelled.")
    if job.status != "successful":
        raise ResultNotReady(f"Job {job.id} is {job.status}: {job.message}")
