"""Figures, motions and sounds made from stored results, as `loa report` and `loa listen` make them."""

from __future__ import annotations

import asyncio
import base64
import hashlib
import json
from collections.abc import Callable
from typing import Annotated

from fastapi import APIRouter, Header, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from lineofaction.gearbox.problems import (
    BadInput,
    DamagedFile,
    LiveUnavailable,
    NotFound,
    QueueFull,
    TooManyHeld,
)
from lineofaction.gearbox.schemas.model import HASH
from service.access.holder import Scope
from service.live.order import LiveOrder
from service.routes.context import Context, Ctx, asker_of
from service.routes.media_types import HTML, JSON, WAV, answer, negotiated
from service.routes.openapi import documented
from service.routes.results import FILE, UNMODIFIED_ANSWER, VERSION, Key, known_result
from service.routes.scopes import ScopedRoute, needs
from service.schemas.answers import MotionBody, ReportBody
from service.version import program_tag

router = APIRouter(tags=["results"], route_class=ScopedRoute)
FIGURES = "lineofaction.report.document:stored_figures"
COMPARISON = "lineofaction.report.comparison.compare:stored_comparison"
_INERT = {"Content-Security-Policy": "sandbox; default-src 'none'; style-src 'unsafe-inline'; img-src data:"}
"""Headers of a page that a browser opens at its address: nothing in the page runs."""
MOTION = "lineofaction.report.unit_motion:stored_motion"
_MAX_MOTIONS = 1_000_000
SOUND = "lineofaction.report.run.sound:stored_sound"
SOUND_KINDS = ("run", "recording")
"""Kinds of results that have a sound."""
_NAME = 200  # most characters of a name in a query


async def _cached_answer(
    request: Request,
    context: Context,
    tag: str,
    order: LiveOrder,
    media_type: str,
    body_of: Callable[[bytes], bytes] = lambda answer: answer,
) -> Response:
    """Return the answer to an order, cached under its tag (in quotes), or 304 to a caller that has it."""
    headers = {"ETag": tag, "Cache-Control": "no-cache"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    body = await run_in_threadpool(context.cached_answers.find, tag)
    if body is None:
        body = body_of(await asyncio.wrap_future(context.live.ask(order, asker_of(request))))
        await run_in_threadpool(context.cached_answers.keep, tag, body)
    return Response(body, media_type=media_type, headers=headers)


@router.get(
    "/results/{key}/figures",
    summary="Figures of a result",
    response_class=Response,
    responses={
        200: answer(
            "The report",
            *(*VERSION, "Vary"),
            model=ReportBody,
            content={JSON: {}, HTML: {"schema": {"type": "string"}, "example": "<!DOCTYPE html>..."}},
        ),
        304: UNMODIFIED_ANSWER,
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
    if against is None:
        version, order = stored.sha256, LiveOrder(FIGURES, {"file": str(stored.path), "printed": printed})
    else:
        other = await run_in_threadpool(known_result, context, against)
        version = stored.sha256 + other.sha256
        order = LiveOrder(COMPARISON, {"files": [str(stored.path), str(other.path)], "printed": printed})
    tag = f'"{version}-{"page" if printed else "figures"}-{program_tag()}"'
    if not printed:
        response = await _cached_answer(request, context, tag, order, JSON)
    else:
        response = await _cached_answer(request, context, tag, order, HTML, _page)
        response.headers.update(_INERT)
    response.headers["Vary"] = "Accept"
    return response


def _page(answer: bytes) -> bytes:
    text: str = json.loads(answer)["page"]
    return text.encode("utf-8")


@router.get(
    "/results/{key}/motion",
    summary="A motion of the unit",
    response_class=Response,
    responses={
        200: answer("Motions to choose from, and the one of a number", *VERSION, model=MotionBody),
        304: UNMODIFIED_ANSWER,
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
        Query(
            ge=0,
            lt=_MAX_MOTIONS,
            description="Number of the motion in the list, from 0; left out: the list alone",
        ),
    ] = None,
) -> Response:
    """Return the motion of shafts in a mode or under a load case, and of the surface of a housing."""
    stored = await run_in_threadpool(known_result, context, key)
    order = LiveOrder(MOTION, {"kind": stored.kind, "file": str(stored.path), "number": number})
    tag = f'"{stored.sha256}-motion-{number}-{program_tag()}"'
    return await _cached_answer(request, context, tag, order, JSON)


def _named(description: str) -> object:
    """Return a parameter that names a part of the run; if it is empty, `loa listen`'s choice is taken."""
    return Query(max_length=_NAME, description=description)


@router.get(
    "/results/{key}/sound",
    summary="The sound of a run or a recording",
    response_class=Response,
    responses={
        200: answer(
            "The WAV file: 32-bit floats, 48 kHz; its comment states quantity and full scale",
            *VERSION,
            content={WAV: {"schema": FILE}},
        ),
        304: UNMODIFIED_ANSWER,
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
    if kind not in SOUND_KINDS:
        raise NotFound(f"Result {key!r} is no run and no recording, but of the kind {kind}.")
    keys = [result for result in (key, against) if result]
    stored = [await run_in_threadpool(known_result, context, result, kind) for result in keys]
    view = {"quantity": quantity, "bearing": bearing, "mesh": mesh, "direction": direction}
    version = json.dumps([*(result.sha256 for result in stored), view, program_tag()])
    tag = f'"{hashlib.sha256(version.encode()).hexdigest()}-sound"'
    order = LiveOrder(SOUND, {"kind": kind, "files": [str(result.path) for result in stored], "view": view})
    return await _cached_answer(
        request, context, tag, order, WAV, lambda made: base64.b64decode(json.loads(made)["wav"])
    )
