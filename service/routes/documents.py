"""Documents that are the same for every caller: landing page, conformance, effects, pages, description."""

from __future__ import annotations

import json

from fastapi import APIRouter, Request
from starlette.responses import Response

from lineofaction.gearbox.loading import LOADING
from lineofaction.gearbox.problems import NotFound
from service.access.holder import Scope
from service.page.files import PageFile, page_file
from service.routes.media_types import JSON, OPENAPI, media_type, negotiated
from service.routes.scopes import OPEN_TO_ALL, ScopedRoute, needs
from service.schemas.answers import CONFORMANCE, Conformance, EffectBody, Landing, Link
from service.version import solver_version

router = APIRouter(tags=["service"], route_class=ScopedRoute)

_OGC = "http://www.opengis.net/def/rel/ogc/1.0/"
_LINKS = (
    Link(href="/v1/", rel="self", title="This page"),
    Link(href="/openapi.json", rel="service-desc", type=OPENAPI, title="OpenAPI description"),
    Link(href="/docs", rel="service-doc", type="text/html", title="The description, to read and to try"),
    Link(href="/v1/conformance", rel=f"{_OGC}conformance", title="Conformance"),
    Link(href="/v1/processes", rel=f"{_OGC}processes", title="Processes"),
    Link(href="/v1/jobs", rel=f"{_OGC}job-list", title="Jobs"),
    Link(href="/v1/databases", rel="data", title="STE databases"),
)
effects_router = APIRouter(tags=["effects"], route_class=ScopedRoute)
pages_router = APIRouter(include_in_schema=False, route_class=ScopedRoute)
_POLICY = "; ".join(
    (
        "default-src 'none'",
        "script-src 'self'",
        "style-src 'self' 'unsafe-inline'",  # plotly.js writes its styles into what it draws
        "img-src 'self' data: blob:",  # a plot becomes a PNG by way of them
        "media-src blob:",  # sounds come with the caller's key, as all else
        "connect-src 'self'",
        "base-uri 'none'",
        "form-action 'none'",
        "frame-ancestors 'none'",
    )
)
_HEADERS = {
    "Content-Security-Policy": _POLICY,
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-cache",
    "Vary": "Accept-Encoding",
}
_OFFERED = (JSON, media_type(OPENAPI))


@router.get("", summary="Landing page")
@router.get("/", include_in_schema=False)
@needs(Scope.READ)
def landing_page() -> Landing:
    """Return the links of the service."""
    return Landing(
        title="lineofaction",
        description="STE databases of gear pairs by contact analysis, and dynamics excited by them.",
        version=solver_version(),
        links=list(_LINKS),
    )


@router.get("/conformance", summary="Conformance classes of OGC API - Processes")
@needs(Scope.READ)
def conformance() -> Conformance:
    """Say which parts of the standard are met."""
    return Conformance(conformsTo=list(CONFORMANCE))


@effects_router.get("/effects", summary="Optional physics")
@needs(Scope.READ)
def list_effects() -> list[EffectBody]:
    """All effects; a case switches them in its table [effects]."""
    with LOADING:
        from fe_contact.effects import EFFECTS  # noqa: PLC0415 (start-up time)

    return [EffectBody.model_validate(effect, from_attributes=True) for effect in EFFECTS]


@pages_router.get("/")
@needs(OPEN_TO_ALL)
def page(request: Request) -> Response:
    """Return the page."""
    return _document_response(page_file("index.html"), request)


@pages_router.get("/docs")
@needs(OPEN_TO_ALL)
def docs(request: Request) -> Response:
    """Return the page that shows the description of the API."""
    return _document_response(page_file("docs.html"), request)


@pages_router.get("/page/{name}")
@needs(OPEN_TO_ALL)
def part(name: str, request: Request) -> Response:
    """Return a style sheet, a module or plotly.js."""
    return _document_response(page_file(name), request)


def _document_response(file: PageFile | None, request: Request) -> Response:
    """Return a file, compressed if the caller takes that, or 304."""
    if file is None:
        raise NotFound("The page has no such file.")
    headers = _HEADERS | {"ETag": file.tag}
    if file.tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    if "gzip" in request.headers.get("accept-encoding", ""):
        return Response(file.packed, 200, headers | {"Content-Encoding": "gzip"}, file.media_type)
    return Response(file.content, 200, headers, file.media_type)


@pages_router.get("/openapi.json")
@needs(Scope.READ)
def description(request: Request) -> Response:
    """Return the description, as OpenAPI's media type to callers that prefer it."""
    accepted = negotiated(request.headers.get("accept", "*/*"), _OFFERED)
    content = json.dumps(request.app.openapi(), ensure_ascii=False, allow_nan=False).encode()
    answer = _document_response(PageFile(content, JSON if accepted == JSON else OPENAPI), request)
    answer.headers.add_vary_header("Accept")
    return answer
