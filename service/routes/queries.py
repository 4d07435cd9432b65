"""Batches of mesh forces of a stored database."""

from __future__ import annotations

import re
from typing import Annotated

from fastapi import APIRouter, Header, Path, Query
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from lineofaction.gearbox.convert.force_query import force_answer
from lineofaction.gearbox.problems import BadInput, DamagedFile, NotAcceptable, NotFound, UnsupportedMediaType
from lineofaction.gearbox.schemas.query import LIMITS, QueryInput, QueryOutput
from lineofaction.gearbox.schemas.result_kinds import HASH
from service.access import Scope
from service.routes.context import context_of
from service.routes.direct import DirectRoute, answered_by
from service.routes.media_types import CBOR, JSON, RAW, media_type, negotiated
from service.routes.query_encodings import READ, WRITE
from service.routes.refusals import documented
from service.routes.scopes import needs

_KEY = re.compile(HASH[:-1] + r"\Z")
_COLUMNS = "position,deflection_um"
_LONGEST_COLUMNS = 100
_INLINE_BYTES = (
    32_768  # beyond it a body is read and answered in a thread, so that others are not kept waiting
)

router = APIRouter(tags=["results"], route_class=DirectRoute)


_BINARY = {"type": "string", "format": "binary"}
_QUERY, _ANSWER = ({"$ref": f"#/components/schemas/{model.__name__}"} for model in (QueryInput, QueryOutput))
_ANSWERS = {
    CBOR: {"schema": _ANSWER},
    RAW: {"schema": _BINARY | {"description": "Columns force_n, stiffness_n_per_um, validity: float64"}},
}
_BODIES = {
    JSON: {"schema": _QUERY},
    CBOR: {"schema": _QUERY | {"description": "Lists may be typed arrays (RFC 8746, tag 86)"}},
    RAW: {"schema": _BINARY | {"description": "Columns of little-endian float64, one after the other"}},
}


async def _answer(request: Request) -> Response:
    """Answer a query: small ones at once, others in a thread."""
    key = request.path_params["key"]
    if _KEY.match(key) is None:
        raise BadInput.of("key", key, f"a text of the form {HASH}", "Content hash of the input.")
    sent = media_type(request.headers.get("content-type", ""))
    if sent not in READ:
        raise UnsupportedMediaType.of(sent, *READ)
    offered = (sent, *(kind for kind in READ if kind != sent))
    accepted = negotiated(request.headers.get("accept", "*/*"), offered)
    if accepted is None:
        raise NotAcceptable(f"An answer can be {', '.join(READ)}. Accept one of them.")
    named = request.query_params.get("columns", _COLUMNS) if request.scope["query_string"] else _COLUMNS
    if len(named) > _LONGEST_COLUMNS:  # also of bodies that do not need it
        raise BadInput.of("columns", named, f"a text of at most {_LONGEST_COLUMNS} characters")
    columns = named.split(",")
    body, context = await request.body(), context_of(request)
    opened = context.databases.at_hand(context.store, key)

    def work() -> bytes:
        """Read, evaluate, write."""
        table = opened or context.databases.get(context.store, key)
        return WRITE[accepted](force_answer(table.law, READ[sent](body, columns)))

    small = len(body) <= _INLINE_BYTES and opened is not None and opened.compiled
    return Response(work() if small else await run_in_threadpool(work), media_type=accepted)


@router.post(
    "/databases/{key}/query",
    summary="Mesh forces",
    response_model=QueryOutput,
    responses=documented(NotFound, NotAcceptable, DamagedFile) | {200: {"content": _ANSWERS}},
    openapi_extra={"requestBody": {"required": True, "content": _BODIES}},
)
@answered_by(_answer)
@needs(Scope.READ)
def query_forces(
    key: Annotated[str, Path(pattern=HASH, description="Content hash of the input")],
    columns: Annotated[
        str, Query(description=f"Columns of a raw body, of {', '.join(LIMITS)}", max_length=_LONGEST_COLUMNS)
    ] = _COLUMNS,
    accept: Annotated[str, Header(description=f"{JSON}, {CBOR} or {RAW}; default: that of the body")] = "*/*",
) -> None:
    """Force, tangent stiffness and validity at positions and deflections."""
