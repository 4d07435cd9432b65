"""Stored runs and recordings to listen to, as `loa listen` writes them."""

from __future__ import annotations

import base64
import hashlib
import json
from typing import Annotated

from fastapi import APIRouter, Query, Request
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response

from lineofaction.gearbox.problems import BadInput, DamagedFile, LiveUnavailable, NotFound, QueueFull
from lineofaction.gearbox.schemas.result_kinds import HASH
from service.access import Scope
from service.live.order import LiveOrder
from service.routes.context import Ctx
from service.routes.kept_answers import VERSION, kept_answer
from service.routes.media_types import WAV, described_headers
from service.routes.refusals import documented
from service.routes.results import FILE, Key, known_result
from service.routes.scopes import ScopedRoute, needs
from service.version import program_tag

SOUND = "lineofaction.report.runs.sound:stored_sound"
HEARD = ("run", "recording")
"""Kinds of results that have a sound."""
_NAME = 200  # characters

router = APIRouter(tags=["results"], route_class=ScopedRoute)


def _named(description: str) -> object:
    """Return a parameter that names a part of the run; empty: it is chosen as `loa listen` does."""
    return Query(max_length=_NAME, description=description)


@router.get(
    "/results/{key}/sound",
    summary="The sound of a run or a recording",
    response_class=Response,
    responses={
        200: {
            "description": "The WAV file: 32-bit floats, 48 kHz; its comment states quantity and full scale",
            "content": {WAV: {"schema": FILE}},
            "headers": described_headers(*VERSION),
        },
        304: {"description": "Not modified", "headers": described_headers(*VERSION)},
        **documented(NotFound, BadInput, QueueFull, LiveUnavailable, DamagedFile),
    },
)
@needs(Scope.READ)
async def result_sound(
    key: Key,
    request: Request,
    context: Ctx,
    quantity: Annotated[str, _named("force, moment, acceleration, mesh_force, transmission_error")] = "",
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
    return await kept_answer(request, context, tag, order, WAV, _wav)


def _wav(answer: bytes) -> bytes:
    return base64.b64decode(json.loads(answer)["wav"])
