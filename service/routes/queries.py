"""Answers from a stored database while the caller waits: mesh forces, curves of other flanks; and plans."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Header, Path, Query
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from lineofaction.gearbox.problems import (
    DamagedFile,
    LiveUnavailable,
    NotAcceptable,
    NotAnalyzed,
    NotFound,
    QueueFull,
    Superseded,
    TooManyHeld,
)
from lineofaction.gearbox.schemas.live import LiveInput, PlanRequest
from lineofaction.gearbox.schemas.live_answer import LiveOutput
from lineofaction.gearbox.schemas.model import HASH
from lineofaction.gearbox.schemas.plan import PlanBody
from lineofaction.gearbox.schemas.query import LIMITS, QueryInput, QueryOutput
from service.access.holder import Scope
from service.live.order import LiveOrder
from service.project import address_of
from service.routes.context import Context, Ctx, asker_of
from service.routes.direct_routes import DirectRoute, answered_by
from service.routes.force_bodies import COLUMNS, LONGEST_COLUMNS, force_answer
from service.routes.media_types import CBOR, JSON, RAW
from service.routes.openapi import documented
from service.routes.results import Key
from service.routes.scopes import ScopedRoute, needs

router = APIRouter(tags=["results"], route_class=DirectRoute)
_BINARY = {"type": "string", "format": "binary"}
_QUERY, _ANSWER = ({"$ref": f"#/components/schemas/{model.__name__}"} for model in (QueryInput, QueryOutput))
_ANSWERS = {
    CBOR: {"schema": _ANSWER},
    RAW: {"schema": _BINARY | {"description": "Columns force_n, stiffness_n_per_um, validity: float64"}},
}
_BODIES = {
    JSON: {"schema": _QUERY},
    CBOR: {"schema": _QUERY | {"description": "Lists may be typed arrays (RFC 8746, tag 86)"}},
    RAW: {"schema": _BINARY | {"description": "Columns of little-endian float64, one after the other"}},
}
live_router = APIRouter(tags=["live"], route_class=ScopedRoute)
STE, PLAN = "service.live.work:live_ste", "service.live.work:live_plan"
"""Functions that answer in a worker process."""


# the function has the signature for the description; `force_answer` answers, without the framework's cost
@router.post(
    "/databases/{key}/query",
    summary="Mesh forces",
    response_model=QueryOutput,
    responses=documented(NotFound, NotAcceptable, DamagedFile) | {200: {"content": _ANSWERS}},
    openapi_extra={"requestBody": {"required": True, "content": _BODIES}},
)
@answered_by(force_answer)
@needs(Scope.READ)
def query_forces(
    key: Annotated[str, Path(pattern=HASH, description="Content hash of the input")],
    columns: Annotated[
        str, Query(description=f"Columns of a raw body, of {', '.join(LIMITS)}", max_length=LONGEST_COLUMNS)
    ] = COLUMNS,
    accept: Annotated[str, Header(description=f"{JSON}, {CBOR} or {RAW}; default: that of the body")] = "*/*",
) -> None:
    """Force, tangent stiffness and validity at positions and deflections."""


@live_router.post(
    "/databases/{key}/ste",
    summary="Transmission error with other flanks",
    response_model=LiveOutput,
    responses=documented(
        QueueFull, TooManyHeld, Superseded, NotAnalyzed, LiveUnavailable, NotFound, DamagedFile
    ),
)
@needs(Scope.READ, body=LiveInput)
async def live_ste(key: Key, body: LiveInput, context: Ctx, request: Request) -> Response:
    """Curves of the gears of a database with other flanks, torques, misalignment and center distance.

    They come from the compliance in the cache, without finite elements, and say what they may be wrong by.
    """
    stored = await run_in_threadpool(context.store.verified, key, "database")
    question = body.model_dump(mode="json", exclude_none=True)
    address = address_of(context.project, key)
    inputs = {"key": address, "file": str(stored.path), "cache": _cache(context), "question": question}
    # a caller that names itself has one question at a time: a newer one replaces it
    asker = asker_of(request, body.caller and f"curves {context.project} {body.caller}")
    answer = context.live.ask(LiveOrder(STE, inputs), asker, subject=address, lasting=body.condense)
    return Response(await asyncio.wrap_future(answer), media_type=JSON)


@live_router.post(
    "/plans",
    summary="Plan and cost of a run",
    response_model=PlanBody,
    responses=documented(QueueFull, TooManyHeld, Superseded, LiveUnavailable),
)
@needs(Scope.READ, body=PlanRequest)
async def plan(body: PlanRequest, context: Ctx, request: Request) -> Response:
    """Predicted time by stage, memory and error of every mesh, and the effect ledger; nothing is computed."""
    inputs = body.inputs.model_dump(mode="json")
    order = LiveOrder(PLAN, {**inputs, "cache": _cache(context)})
    answer = context.live.ask(order, asker_of(request, body.caller and f"plan {body.caller}"))
    return Response(await asyncio.wrap_future(answer), media_type=JSON)


def _cache(context: Context) -> str:
    return str(context.settings.data_directory / "compliance")
