"""Gear units of other tools, opened before anything is computed."""

from __future__ import annotations

from fastapi import APIRouter, Request
from starlette.responses import Response

from service.access import Scope
from service.live.order import LiveOrder
from service.routes.cases import READING_FAILURES, explained, read_by
from service.routes.context import Ctx
from service.routes.refusals import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import UnitBody, UnitFile

router = APIRouter(tags=["units"], route_class=ScopedRoute)

ENTRY = "lineofaction.gearbox.from_rexs.opened:unit_of_rexs"


@router.post(
    "/units/open",
    summary="Open a gear unit (REXS)",
    response_model=UnitBody,
    responses=documented(*READING_FAILURES),
)
@needs(Scope.READ)
async def open_unit(body: UnitFile, context: Ctx, request: Request) -> Response:
    """Open a gear unit of another tool: a case for each cylindrical stage, the scene, and the account.

    A process of its own reads the file; nothing outside of it is opened.
    """
    return await read_by(context, LiveOrder(ENTRY, body.model_dump()), request)


explained(open_unit, UnitFile)
