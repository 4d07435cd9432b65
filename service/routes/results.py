"""Stored results: metadata and files, and the list of STE databases."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request
from starlette.responses import FileResponse, JSONResponse, Response

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import DamagedFile, NotFound
from lineofaction.gearbox.registry import NETCDF, RESULT_KINDS, RESULTS, SUFFIX
from lineofaction.gearbox.schemas.model import HASH
from service.access.holder import Scope
from service.routes.context import Context, Ctx
from service.routes.list_pages import Cursor, Limit, mark_of, page_links
from service.routes.lists import LISTED, list_answer
from service.routes.media_types import JSON, OF_VERSIONS, answer, negotiated
from service.routes.openapi import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import DatabaseEntry, DatabaseList, ResultFigures
from service.store.files import WrongContent
from service.store.results import IndexLine, Mark, ResultStore, StoredResult

VERSION = ("ETag", "Cache-Control")
"""Headers that state the version of an answer."""

_FIGURES = "-json-2"
"""End of the tag of figures. It changes when the keys of figures change, as the `version` of a study does."""
_IMMUTABLE = "public, max-age=31536000, immutable"
Key = Annotated[str, Path(pattern=HASH, description="Content hash of the input")]
Accept = Annotated[str, Header(description=f"{NETCDF} for the file, application/json for its figures")]
FILE = {"type": "string", "format": "binary"}
OF_RESULT = (*OF_VERSIONS, "Result-Kind")
_FIGURES_OR_FILE = answer(
    "The figures of the result, or its file",
    *(*OF_RESULT, "Content-Digest"),
    model=ResultFigures,
    content={JSON: {}, NETCDF: {"schema": FILE}},
)
_NETCDF_FILE = answer("The netCDF file", *OF_RESULT, "Content-Digest", content={NETCDF: {"schema": FILE}})
_UNMODIFIED = answer("Not modified", *OF_RESULT)
UNMODIFIED_ANSWER = answer("Not modified", *VERSION)
case_of_file = on_demand("lineofaction.gearbox.result_files:case_of_file")
figures_of = on_demand("lineofaction.gearbox.result_figures:figures_of")
metadata_json = on_demand("lineofaction.gearbox.convert.answers:metadata_json")
router = APIRouter(tags=["results"], route_class=ScopedRoute)
_PATH = "/v1/databases"


@router.get("/databases", summary="STE databases", response_model=DatabaseList, responses=LISTED)
@needs(Scope.READ)
async def list_databases(
    request: Request, context: Ctx, limit: Limit = 20, cursor: Cursor = None
) -> Response:
    """List stored databases with their cases, the newest first."""
    after = mark_of(cursor)

    def page() -> DatabaseList:
        lines = context.store.page("database", limit + 1, after)
        page_lines = lines[:limit]
        last = page_lines[-1][0] if len(lines) > limit else None
        entries = [_entry(context.store, mark, line) for mark, line in page_lines]
        return DatabaseList(databases=entries, links=page_links(request, _PATH, last))

    return await list_answer(request, page)


def _entry(store: ResultStore, mark: Mark, line: IndexLine) -> DatabaseEntry:
    """Return the list's entry of a database, without its case where the file is damaged.

    The look into the file does not count as a use.
    """
    try:
        case = case_of_file(store.files.local(line.file, line.sha256))
    except (FileNotFoundError, WrongContent):
        case = None
    return DatabaseEntry(
        hash=line.key, href=f"{RESULTS}/{line.key}", created=mark.created, size=line.size, case=case
    )


@router.get(
    "/results/{key}",
    summary="A result",
    response_class=Response,
    responses={200: _FIGURES_OR_FILE, 304: _UNMODIFIED, **documented(NotFound, DamagedFile)},
)
@needs(Scope.READ)
def get_result(key: Key, request: Request, context: Ctx, accept: Accept = JSON) -> Response:
    """Figures or the file, by Accept; never changes. Its kind is in the header Result-Kind."""
    stored = known_result(context, key)
    if negotiated(accept, (JSON, NETCDF)) == NETCDF:
        return file_response(stored, request)
    if stored.kind == "database":
        return _metadata(stored, request, metadata_json(context.databases.get(context.store, key).database))
    return _metadata(stored, request, figures_of(stored.kind, stored.path))


@router.get(
    "/results/{key}/file",
    summary="The file of a result",
    response_class=Response,
    responses={200: _NETCDF_FILE, 304: _UNMODIFIED, **documented(NotFound, DamagedFile)},
)
@needs(Scope.READ)
def result_file(key: Key, request: Request, context: Ctx) -> Response:
    """Return the file for any accepted type, for browsers and generated clients; it never changes."""
    return file_response(known_result(context, key), request)


def known_result(context: Context, key: str, kind: str | None = None) -> StoredResult:
    """Return a stored result of a kind; None: of any kind.

    Raises `NotFound`: there is none, or another version of this program made it.
    """
    stored = context.store.verified(key, kind)
    if stored.kind not in RESULT_KINDS:
        raise NotFound(f"Result {key!r} is of a kind that this version does not know: {stored.kind}.")
    return stored


def file_response(
    result: StoredResult, request: Request, further: Mapping[str, str] | None = None
) -> Response:
    """Return the file with its digest (RFC 9530), or 304."""
    headers = _headers(result) | dict(further or {})
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return FileResponse(
        result.path,
        media_type=NETCDF,
        filename=f"{result.kind}_{result.key[:12]}{SUFFIX}",
        headers=headers | _digest(bytes.fromhex(result.sha256)),
    )


def _metadata(result: StoredResult, request: Request, fields: dict[str, Any]) -> Response:
    headers = _headers(result, _FIGURES)
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    stored_fields = {"hash": result.key, "sha256": result.sha256, "size": result.size}
    response = JSONResponse(stored_fields | fields, headers=headers)
    response.headers.update(_digest(hashlib.sha256(response.body).digest()))
    return response


def _digest(sha256: bytes) -> dict[str, str]:
    return {"Content-Digest": f"sha-256=:{base64.b64encode(sha256).decode()}:"}


def _headers(result: StoredResult, form: str = "") -> dict[str, str]:
    """Return the headers of an answer that never changes; `form` tells it from the file itself."""
    tag = f'"{result.sha256}{form}"'
    return {"ETag": tag, "Cache-Control": _IMMUTABLE, "Vary": "Accept", "Result-Kind": result.kind}


def _known(request: Request, tag: str) -> bool:
    known = request.headers.get("if-none-match", "")
    return known.strip() == "*" or tag in (part.strip().removeprefix("W/") for part in known.split(","))
