"""Figures and tables of stored results, as `loa report` draws them."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from lineofaction.gearbox.problems import DamagedFile, LiveUnavailable, NotFound, QueueFull
from lineofaction.gearbox.schemas.result_kinds import HASH
from service.access import Scope
from service.live.order import LiveOrder
from service.routes.context import Ctx
from service.routes.kept_answers import VERSION, kept_answer
from service.routes.media_types import described_headers
from service.routes.refusals import documented
from service.routes.results import Key, known_result
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import ReportBody
from service.version import program_tag

FIGURES = "lineofaction.report.document.content:stored_figures"
COMPARISON = "lineofaction.report.comparison.compare:stored_comparison"

router = APIRouter(tags=["results"], route_class=ScopedRoute)


@router.get(
    "/results/{key}/figures",
    summary="Figures of a result",
    response_class=Response,
    responses={
        200: {
            "model": ReportBody,
            "description": "The report",
            "headers": described_headers(*VERSION),
        },
        304: {"description": "Not modified", "headers": described_headers(*VERSION)},
        **documented(NotFound, QueueFull, LiveUnavailable, DamagedFile),
    },
)
@needs(Scope.READ)
async def result_figures(
    key: Key,
    request: Request,
    context: Ctx,
    against: Annotated[
        str | None,
        Query(
            pattern=HASH,
            description="Another result of the same kind, table or run: the report then compares both.",
        ),
    ] = None,
) -> Response:
    """Every plot as data and layout for plotly.js, with its words and numbers."""
    stored = await run_in_threadpool(known_result, context, key)
    tag, order = stored.sha256, LiveOrder(FIGURES, {"file": str(stored.path)})
    if against is not None:
        other = await run_in_threadpool(known_result, context, against)
        tag, order = tag + other.sha256, LiveOrder(COMPARISON, {"files": [str(stored.path), str(other.path)]})
    tag = f'"{tag}-figures-{program_tag()}"'
    return await kept_answer(request, context, tag, order, "application/json")
