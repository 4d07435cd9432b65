"""The pages at ``/`` and ``/docs``: plain files, nothing from elsewhere, and a policy that says so."""

from __future__ import annotations

from fastapi import APIRouter, Request
from starlette.responses import Response

from lineofaction.gearbox.problems import NotFound
from service.page.files import PageFile, page_file
from service.routes.scopes import OPEN_TO_ALL, ScopedRoute, needs

router = APIRouter(include_in_schema=False, route_class=ScopedRoute)

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


@router.get("/")
@needs(OPEN_TO_ALL)
def page(request: Request) -> Response:
    """Return the page."""
    return served(page_file("index.html"), request)


@router.get("/docs")
@needs(OPEN_TO_ALL)
def docs(request: Request) -> Response:
    """Return the page that shows the description of the API."""
    return served(page_file("docs.html"), request)


@router.get("/page/{name}")
@needs(OPEN_TO_ALL)
def part(name: str, request: Request) -> Response:
    """Return a style sheet, a module or plotly.js."""
    return served(page_file(name), request)


def served(file: PageFile | None, request: Request) -> Response:
    """Return a file, compressed if the caller takes that, or 304."""
    if file is None:
        raise NotFound("The page has no such file.")
    headers = _HEADERS | {"ETag": file.tag}
    if file.tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    if "gzip" in request.headers.get("accept-encoding", ""):
        return Response(file.packed, 200, headers | {"Content-Encoding": "gzip"}, file.media_type)
    return Response(file.content, 200, headers, file.media_type)
