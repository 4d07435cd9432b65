"""Gear units of other tools, opened before anything is computed."""

from __future__ import annotations

import asyncio

from fastapi import APIRouter
from starlette.responses import Response

from service.access import Scope
from service.live.order import LiveOrder
from service.problems import LiveUnavailable, QueueFull
from service.routes.cases import explained
from service.routes.context import Ctx
from service.routes.media_types import JSON
from service.routes.refusals import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.unit import UnitBody, UnitFile

router = APIRouter(tags=["units"], route_class=ScopedRoute)

ENTRY = "service.from_rexs.answer:unit_of_rexs"


@router.post(
    "/units/open",
    summary="Open a gear unit (REXS)",
    response_model=UnitBody,
    responses=documented(QueueFull, LiveUnavailable),
)
@needs(Scope.READ)
async def open_unit(body: UnitFile, context: Ctx) -> Response:
    """Open a gear unit of another tool: a case for each cylindrical stage, the scene, and the account.

    A process of its own reads the file; nothing outside of it is opened.
    """
    order = LiveOrder(ENTRY, {"rexs_base64": body.rexs_base64})
    return Response(await asyncio.wrap_future(context.reader.ask(order)), media_type=JSON)


explained(open_unit, UnitFile)
