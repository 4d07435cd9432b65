"""The description of the API as a resource."""

from __future__ import annotations

import json
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from service.access import Scope
from service.page.files import PageFile
from service.routes.media_types import JSON, OPENAPI, media_type, negotiated
from service.routes.page import served
from service.routes.scopes import ScopedRoute, needs

router = APIRouter(include_in_schema=False, route_class=ScopedRoute)
_OFFERED = (JSON, media_type(OPENAPI))


@router.get("/openapi.json")
@needs(Scope.READ)
def description(request: Request) -> Response:
    """Return the description, under the type of OpenAPI to those who prefer that."""
    accepted = negotiated(request.headers.get("accept", "*/*"), _OFFERED)
    answer = served(PageFile(_text(request.app.openapi()), JSON if accepted == JSON else OPENAPI), request)
    answer.headers.add_vary_header("Accept")
    return answer


def _text(document: dict[str, Any]) -> bytes:
    return json.dumps(document, ensure_ascii=False, allow_nan=False).encode()
