"""Results where version 0.1 had them, ``/v1/COLLECTION/HASH``: redirections, for one version."""

from __future__ import annotations

from fastapi import APIRouter, Request
from starlette.responses import RedirectResponse

from lineofaction.gearbox.problems import NotFound
from lineofaction.gearbox.schemas.result_kinds import RESULT_KINDS, RESULTS, ResultKind
from service.access import Scope
from service.routes.context import Ctx
from service.routes.moved import moved
from service.routes.results import Key
from service.routes.scopes import ScopedRoute, needs

router = APIRouter(include_in_schema=False, route_class=ScopedRoute)


def _redirect(kind: ResultKind, further: str) -> None:
    """Redirect from results of a kind, or their figures; a hash of another kind is not found."""

    @needs(Scope.READ)
    def result(key: Key, request: Request, context: Ctx) -> RedirectResponse:
        if context.store.find(key, kind.name) is None:
            raise NotFound(f"There is no {kind.name} {key!r}. Submit its case again to compute it.")
        return moved(request, f"{RESULTS}/{key}{further}")

    router.add_api_route(f"/{kind.collection}/{{key}}{further}", result)


for _kind in RESULT_KINDS.values():
    if _kind.collection:
        _redirect(_kind, "")
        _redirect(_kind, "/figures")
