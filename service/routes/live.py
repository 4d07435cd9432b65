"""Answers while the caller waits: curves of other flanks, and plans. The live worker computes them."""

from __future__ import annotations

import asyncio
from typing import Any

from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from lineofaction.gearbox.problems import (
    DamagedFile,
    LiveUnavailable,
    NotAnalyzed,
    NotFound,
    QueueFull,
    Superseded,
)
from lineofaction.gearbox.schemas.live import LiveInput, PlanRequest
from lineofaction.gearbox.schemas.live_answer import LiveOutput
from lineofaction.gearbox.schemas.plan import PlanBody
from service.access import Scope
from service.live.order import LiveOrder
from service.project import address_of
from service.routes.context import Context, Ctx
from service.routes.refusals import documented
from service.routes.results import Key
from service.routes.scopes import ScopedRoute, needs

router = APIRouter(tags=["live"], route_class=ScopedRoute)

STE, PLAN = "service.live.work:live_ste", "service.live.work:live_plan"


@router.post(
    "/databases/{key}/ste",
    summary="Transmission error with other flanks",
    response_class=Response,
    responses={
        200: {"model": LiveOutput, "description": "The curves"},
        **documented(QueueFull, Superseded, NotAnalyzed, LiveUnavailable, NotFound, DamagedFile),
    },
)
@needs(Scope.READ)
async def live_ste(key: Key, body: LiveInput, context: Ctx) -> Response:
    """Curves of the gears of a database with other flanks, torques, misalignment and center distance.

    They come from the compliance in the cache, without finite elements, and say what they may be wrong by.
    """
    stored = await run_in_threadpool(context.store.verified, key, "database")
    question = body.model_dump(mode="json", exclude_none=True)
    place = address_of(context.project, key)
    inputs = {"key": place, "file": str(stored.path), "cache": _cache(context), "question": question}
    return await _answer(context, LiveOrder(STE, inputs), body.caller)


@router.post(
    "/plans",
    summary="Plan and cost of a run",
    response_class=Response,
    responses={
        200: {"model": PlanBody, "description": "The plan"},
        **documented(QueueFull, Superseded, LiveUnavailable),
    },
)
@needs(Scope.READ)
async def plan(body: PlanRequest, context: Ctx) -> Response:
    """Predicted time by stage, memory and error of every mesh, and the effect ledger; nothing is computed."""
    inputs = body.inputs.model_dump(mode="json")
    order = LiveOrder(PLAN, {**inputs, "cache": _cache(context)})
    return await _answer(context, order, body.caller)


async def _answer(context: Context, order: LiveOrder, caller: str | None) -> Response:
    name = None if caller is None else f"{order.entry} {context.project} {caller}"
    body = await asyncio.wrap_future(context.live.ask(order, name))
    return Response(body, media_type="application/json")


def _cache(context: Context) -> str:
    return str(context.settings.data_directory / "compliance")


def _documented(handler: Any, model: Any) -> None:
    handler.body_model = model


_documented(live_ste, LiveInput)
_documented(plan, PlanRequest)
