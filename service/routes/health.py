"""Health, readiness and figures of the service."""

from __future__ import annotations

from typing import Literal

from fastapi import APIRouter, Depends, Request, Response
from pydantic import BaseModel, Field
from starlette.responses import PlainTextResponse

from host import missing_protections
from lineofaction.gearbox.problems import ServiceError
from service.access.holder import Scope
from service.management.server import METRICS_TYPE
from service.management.vitals import Vitals
from service.routes.context import Ctx
from service.routes.media_types import NO_STORE
from service.routes.openapi import documented
from service.routes.scopes import OPEN_TO_ALL, ScopedRoute, needs


async def _of_now(response: Response) -> None:
    """Let no cache answer in place of the service."""
    response.headers["Cache-Control"] = NO_STORE


router = APIRouter(tags=["operations"], dependencies=[Depends(_of_now)], route_class=ScopedRoute)


class _NotReady(ServiceError):
    """The service runs but cannot work."""

    status = 503
    type = "urn:lineofaction:problem:not-ready"
    title = "Not ready"
    retry_after_s = 5


class Health(BaseModel):
    """The process serves requests."""

    status: Literal["ok"] = "ok"


class Readiness(BaseModel):
    """The service can work."""

    status: Literal["ready"] = "ready"
    computations: dict[str, int] | None = Field(
        None, description="Number of computations by state; left out where keys are needed"
    )
    missing_protections: tuple[str, ...] | None = Field(
        None,
        description="Protections for readers of files that the system lacks; left out where none is missing",
    )


@router.get("/health", summary="Liveness")
@needs(OPEN_TO_ALL)
async def health() -> Health:
    """Answer that the process serves requests, however many of them wait for the database in threads."""
    return Health()


@router.get(
    "/ready", response_model_exclude_none=True, summary="Readiness for jobs", responses=documented(_NotReady)
)
@needs(OPEN_TO_ALL)
def ready(request: Request, context: Ctx) -> Readiness:
    """Answer that database and place of results are writable, and that the scheduler runs.

    The numbers of computations are left out where keys are needed: this is answered to everybody. Readers of
    files that the system cannot confine do not make it unready: what is missing is stated.
    """
    outcome = context.writes.outcome()
    if outcome.fault:
        raise _NotReady(outcome.fault)
    counts = None if request.state.closed else context.submissions.counts()
    if fault := Vitals(context.scheduler, context.writes).fault_of_health():
        raise _NotReady(fault)
    return Readiness(computations=counts, missing_protections=missing_protections() or None)


@router.get("/metrics", summary="Metrics for Prometheus", response_class=PlainTextResponse)
@needs(Scope.OPERATE)
def metrics(request: Request) -> Response:
    """Return the figures in the text exposition format."""
    return Response(request.app.state.metrics.text(), media_type=METRICS_TYPE)
