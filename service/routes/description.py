"""The description of the API as a resource."""

from __future__ import annotations

import json
from typing import Any

from fastapi import APIRouter, Request
from starlette.responses import Response

from service.access import Scope
from service.page.files import PageFile
from service.routes.media_types import JSON, OPENAPI, OPENAPI_30, media_type, negotiated
from service.routes.openapi30 import in_version_30
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


@router.get("/openapi-3.0.json")
@needs(Scope.READ)
def description_30(request: Request) -> Response:
    """Return the description in OpenAPI 3.0."""
    return served(PageFile(_text(in_version_30(request.app.openapi())), OPENAPI_30), request)


def _text(document: dict[str, Any]) -> bytes:
    """Return a description as it is sent."""
    return json.dumps(document, ensure_ascii=False, allow_nan=False).encode()
