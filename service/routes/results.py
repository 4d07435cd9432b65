"""Stored results: metadata, files, figures, sounds, and the list of STE databases."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import json
from collections.abc import Callable, Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import FileResponse, JSONResponse, Response

from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.problems import (
    BadInput,
    DamagedFile,
    LiveUnavailable,
    NotFound,
    QueueFull,
    TooManyHeld,
)
from lineofaction.gearbox.registry import NETCDF, RESULT_KINDS, RESULTS, SUFFIX
from lineofaction.gearbox.schemas.model import HASH
from service.access.keyring import Scope
from service.live.order import LiveOrder
from service.routes.context import Context, Ctx, asker_of
from service.routes.lists import LISTED, list_answer
from service.routes.media_types import (
    HTML,
    JSON,
    OF_VERSIONS,
    WAV,
    Cursor,
    Limit,
    answer,
    mark_of,
    negotiated,
    page_links,
)
from service.routes.openapi import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import DatabaseEntry, DatabaseList, MotionBody, ReportBody, ResultFigures
from service.store.files import WrongContent
from service.store.results import IndexLine, Mark, ResultStore, StoredResult
from service.version import program_tag

# Answers that a worker makes from stored results, kept in memory while they are asked for.


_VERSION = ("ETag", "Cache-Control")
"""Headers of such an answer."""

_FIGURES = "-json-2"
"""Ends the tag of figures: another one where their keys are others, as `version` of studies."""
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
_UNMODIFIED, _UNMODIFIED_ANSWER = answer("Not modified", *OF_RESULT), answer("Not modified", *_VERSION)
case_of_file = on_demand("lineofaction.gearbox.result_files:case_of_file")
figures_of = on_demand("lineofaction.gearbox.result_figures:figures_of")
metadata_json = on_demand("lineofaction.gearbox.convert.answers:metadata_json")
router = APIRouter(tags=["results"], route_class=ScopedRoute)
_PATH = "/v1/databases"
FIGURES = "lineofaction.report.document:stored_figures"
COMPARISON = "lineofaction.report.comparison.compare:stored_comparison"
_INERT = {"Content-Security-Policy": "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:"}
"""Of a page that a browser opens at its address: nothing in it runs."""
MOTION = "lineofaction.report.unit_motion:stored_motion"
_MOST_MOTIONS = 1_000_000
SOUND = "lineofaction.report.run.sound:stored_sound"
HEARD = ("run", "recording")
"""Kinds of results that have a sound."""
_NAME = 200  # characters


async def _kept_answer(
    request: Request,
    context: Context,
    tag: str,
    order: LiveOrder,
    media_type: str,
    body_of: Callable[[bytes], bytes] = lambda answer: answer,
) -> Response:
    """Return the answer to an order by its tag, in quotes; 304 to a caller that has it."""
    headers = {"ETag": tag, "Cache-Control": "no-cache"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    body = await run_in_threadpool(context.kept.find, tag)
    if body is None:
        body = body_of(await asyncio.wrap_future(context.live.ask(order, asker_of(request))))
        await run_in_threadpool(context.kept.keep, tag, body)
    return Response(body, media_type=media_type, headers=headers)


@router.get("/databases", summary="STE databases", response_model=DatabaseList, responses=LISTED)
@needs(Scope.READ)
async def list_databases(
    request: Request, context: Ctx, limit: Limit = 20, cursor: Cursor = None
) -> Response:
    """List stored databases with their cases, the newest first."""
    after = mark_of(cursor)

    def page() -> DatabaseList:
        found = context.store.page("database", limit + 1, after)
        shown = found[:limit]
        last = shown[-1][0] if len(found) > limit else None
        entries = [_entry(context.store, mark, line) for mark, line in shown]
        return DatabaseList(databases=entries, links=page_links(request, _PATH, last))

    return await list_answer(request, page)


def _entry(store: ResultStore, mark: Mark, line: IndexLine) -> DatabaseEntry:
    """Return what the list tells of a database, which is not thereby used; of a damaged file its name."""
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
    """Return the file whatever the request accepts, for browsers and generated clients; never changes."""
    return file_response(known_result(context, key), request)


def known_result(context: Context, key: str, kind: str | None = None) -> StoredResult:
    """Return a stored result of a kind, or of whichever it is.

    Raises `NotFound`: there is none, or another version of this program made it.
    """
    stored = context.store.verified(key, kind)
    if stored.kind not in RESULT_KINDS:
        raise NotFound(f"Result {key!r} is of a kind that this version does not know: {stored.kind}.")
    if stored.path.suffix != SUFFIX:
        reason = "Version 0.1 stored it as JSON; results are netCDF"
        raise NotFound(f"Result {key!r} cannot be read. {reason}. Submit its case again to compute it.")
    return stored


def file_response(
    stored: StoredResult, request: Request, further: Mapping[str, str] | None = None
) -> Response:
    """Return the file with its digest (RFC 9530), or 304."""
    headers = _headers(stored) | dict(further or {})
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return FileResponse(
        stored.path,
        media_type=NETCDF,
        filename=f"{stored.kind}_{stored.key[:12]}{SUFFIX}",
        headers=headers | _digest(bytes.fromhex(stored.sha256)),
    )


def _metadata(stored: StoredResult, request: Request, facts: dict[str, Any]) -> Response:
    headers = _headers(stored, _FIGURES)
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    own = {"hash": stored.key, "sha256": stored.sha256, "size": stored.size}
    response = JSONResponse(own | facts, headers=headers)
    response.headers.update(_digest(hashlib.sha256(response.body).digest()))
    return response


def _digest(sha256: bytes) -> dict[str, str]:
    return {"Content-Digest": f"sha-256=:{base64.b64encode(sha256).decode()}:"}


def _headers(stored: StoredResult, form: str = "") -> dict[str, str]:
    """Headers of something that never changes, in a form that is not its file."""
    tag = f'"{stored.sha256}{form}"'
    return {"ETag": tag, "Cache-Control": _IMMUTABLE, "Vary": "Accept", "Result-Kind": stored.kind}


def _known(request: Request, tag: str) -> bool:
    known = request.headers.get("if-none-match", "")
    return known.strip() == "*" or tag in (part.strip().removeprefix("W/") for part in known.split(","))


# Figures and tables of stored results, as `loa report` draws them.


@router.get(
    "/results/{key}/figures",
    summary="Figures of a result",
    response_class=Response,
    responses={
        200: answer(
            "The report",
            *(*_VERSION, "Vary"),
            model=ReportBody,
            content={JSON: {}, HTML: {"schema": {"type": "string"}, "example": "<!DOCTYPE html>..."}},
        ),
        304: _UNMODIFIED_ANSWER,
        **documented(NotFound, QueueFull, TooManyHeld, LiveUnavailable, DamagedFile),
    },
)
@needs(Scope.READ)
async def result_figures(
    key: Key,
    request: Request,
    context: Ctx,
    accept: Annotated[str, Header(description=f"{HTML} for a page to print, pictures in it")] = JSON,
    against: Annotated[
        str | None,
        Query(
            pattern=HASH,
            description="Another result of the same kind, table or run: the report then compares both.",
        ),
    ] = None,
) -> Response:
    """Every plot as data and layout for plotly.js, with its words and numbers; or a page to print."""
    printed = negotiated(accept, (JSON, HTML)) == HTML
    stored = await run_in_threadpool(known_result, context, key)
    named: dict[str, Any] = {"file": str(stored.path)}
    tag, work = stored.sha256, FIGURES
    if against is not None:
        other = await run_in_threadpool(known_result, context, against)
        tag, work, named = tag + other.sha256, COMPARISON, {"files": [str(stored.path), str(other.path)]}
    order = LiveOrder(work, {**named, "printed": printed})
    form, kind, body_of = ("page", HTML, _page) if printed else ("figures", JSON, bytes)
    response = await _kept_answer(request, context, f'"{tag}-{form}-{program_tag()}"', order, kind, body_of)
    response.headers.update({"Vary": "Accept"} | (_INERT if printed else {}))
    return response


def _page(made: bytes) -> bytes:
    text: str = json.loads(made)["page"]
    return text.encode("utf-8")


@router.get(
    "/results/{key}/motion",
    summary="A motion of the unit",
    response_class=Response,
    responses={
        200: answer("Motions to choose from, and the one of a number", *_VERSION, model=MotionBody),
        304: _UNMODIFIED_ANSWER,
        **documented(NotFound, BadInput, QueueFull, TooManyHeld, LiveUnavailable, DamagedFile),
    },
)
@needs(Scope.READ)
async def result_motion(
    key: Key,
    request: Request,
    context: Ctx,
    number: Annotated[
        int | None,
        Query(ge=0, lt=_MOST_MOTIONS, description="Of the motion among those listed, from 0; left out: none"),
    ] = None,
) -> Response:
    """Return how shafts move in a mode or under a load case, and how the surface of a housing does."""
    stored = await run_in_threadpool(known_result, context, key)
    order = LiveOrder(MOTION, {"kind": stored.kind, "file": str(stored.path), "number": number})
    tag = f'"{stored.sha256}-motion-{number}-{program_tag()}"'
    return await _kept_answer(request, context, tag, order, JSON)


# Stored runs and recordings to listen to, as `loa listen` writes them.


def _named(description: str) -> object:
    """Return a parameter that names a part of the run; empty: it is chosen as `loa listen` does."""
    return Query(max_length=_NAME, description=description)


@router.get(
    "/results/{key}/sound",
    summary="The sound of a run or a recording",
    response_class=Response,
    responses={
        200: answer(
            "The WAV file: 32-bit floats, 48 kHz; its comment states quantity and full scale",
            *_VERSION,
            content={WAV: {"schema": FILE}},
        ),
        304: _UNMODIFIED_ANSWER,
        **documented(NotFound, BadInput, QueueFull, TooManyHeld, LiveUnavailable, DamagedFile),
    },
)
@needs(Scope.READ)
async def result_sound(
    key: Key,
    request: Request,
    context: Ctx,
    quantity: Annotated[
        str, _named("force, moment, acceleration, mesh_force, elastic_force, transmission_error")
    ] = "",
    bearing: Annotated[str, _named("Bearing; left out: where the quantity varies most")] = "",
    mesh: Annotated[str, _named("Mesh; left out: the first")] = "",
    direction: Annotated[str, _named("x, y, z; left out: in which it varies most")] = "",
    against: Annotated[
        str | None,
        Query(pattern=HASH, description="Another one of its kind; both are then on one full scale"),
    ] = None,
) -> Response:
    """Return a recording of `listen`, or forces or motions of a run made audible: no sound pressure."""
    kind = (await run_in_threadpool(known_result, context, key)).kind
    if kind not in HEARD:
        raise NotFound(f"Result {key!r} is no run and no recording, but of the kind {kind}.")
    stored = [await run_in_threadpool(known_result, context, one, kind) for one in (key, against) if one]
    view = {"quantity": quantity, "bearing": bearing, "mesh": mesh, "direction": direction}
    named = json.dumps([*(one.sha256 for one in stored), view, program_tag()])
    tag = f'"{hashlib.sha256(named.encode()).hexdigest()}-sound"'
    order = LiveOrder(SOUND, {"kind": kind, "files": [str(one.path) for one in stored], "view": view})
    return await _kept_answer(
        request, context, tag, order, WAV, lambda made: base64.b64decode(json.loads(made)["wav"])
    )
