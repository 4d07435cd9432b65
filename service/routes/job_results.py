"""Results of jobs in the form that was requested (OGC API - Processes 1.0, clause 7.13)."""

from __future__ import annotations

from typing import Annotated, Any, Union

from fastapi import APIRouter, Header, Query, Request
from starlette.responses import JSONResponse, Response

from lineofaction.gearbox.problems import (
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
from service.access.holder import Scope
from service.queue.job import Job
from service.queue.terms import Delivery, Transmission, delivery
from service.queue.terms import Response as Form
from service.routes.context import Context, Ctx
from service.routes.media_types import JSON, OF_VERSIONS, answer, negotiated
from service.routes.openapi import documented
from service.routes.results import FILE, OF_RESULT, file_response, known_result
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import JobStatus, ProblemBody, ResultReference, results_document
from service.schemas.execute import BatchResult, BatchResults
from service.worker.process import Registry

_REFUSED = documented(NoSuchJob, ResultNotReady, NotFound, JobDismissed, JobFailed, DamagedFile)
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


def job_results_router(registry: Registry) -> APIRouter:
    """Return the route; the schema of its documents has the outputs of all processes."""
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


def batch_results(context: Context, batch: Job) -> BatchResults:
    """Return the results of the jobs of a batch, in order."""
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
    """Return the reason why a job has no result; None: it has one."""
    if job.status == "failed":
        return JobFailed(job.message, [Fault(**fault) for fault in job.faults])
    if job.status == "dismissed":
        return JobDismissed(f"Job {job.id} was cancelled.")
    if job.status != "successful":
        return ResultNotReady(f"Job {job.id} is {job.status}: {job.message}")
    return None


def reference_of(job: Job) -> ResultReference:
    """Return the reference to the result of a job."""
    return ResultReference(href=f"{RESULTS}/{job.key}", type=NETCDF, hash=job.key)


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
        form = _accepted_delivery(job.delivery, request.headers.get("accept", "*/*"))
    else:
        form = delivery(response or job.delivery.response, mode, "transmissionMode")
    reference = reference_of(job)
    if form.transmission == "reference" and form.response == "raw":
        link = f'<{reference.href}>; rel="item"; type="{NETCDF}"; title="{process.output}"'
        return Response(status_code=204, headers={"Link": link, "Vary": "Accept"})
    if form.transmission == "reference":
        return JSONResponse({process.output: reference.model_dump()}, headers={"Vary": "Accept"})
    headers = {"Content-Location": reference.href}
    return file_response(known_result(context, job.key, process.kind), request, headers)


def _accepted_delivery(ordered: Delivery, accept: str) -> Delivery:
    """Return the form that the execution requested, or the other one if the caller prefers its media type."""
    offered = (JSON, NETCDF) if ordered.response == "document" else (NETCDF, JSON)
    accepted = negotiated(accept, offered)
    if accepted in (None, offered[0]):
        return ordered
    return delivery("document" if accepted == JSON else "raw", None, "transmissionMode")
