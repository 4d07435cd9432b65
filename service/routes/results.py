"""Stored results as metadata or as their files."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request
from starlette.responses import FileResponse, JSONResponse, Response

from service.loading import LOADING
from service.problems import NotFound
from service.registry import NETCDF
from service.routes.context import Context, Ctx
from service.routes.errors import documented
from service.routes.media_types import JSON, negotiated
from service.schemas.result_kinds import RESULT_KINDS
from service.store import StoredResult

_IMMUTABLE = "public, max-age=31536000, immutable"

Key = Annotated[str, Path(pattern="^[0-9a-f]{64}$", description="Content hash of the input")]
Accept = Annotated[str, Header(description=f"{NETCDF} for the file, application/json for its metadata")]
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": "The result; of a kind that is kept as JSON the file in any case",
        "content": {
            JSON: {"schema": {"type": "object"}},
            NETCDF: {"schema": {"type": "string", "format": "binary"}},
        },
    },
    304: {"description": "Not modified"},
}

router = APIRouter(tags=["results"])


@router.get(
    "/results/{key}",
    summary="A result",
    response_class=Response,
    responses=_ANSWERS | documented(404, 422, 500),
)
def result(key: Key, request: Request, context: Ctx, accept: Accept = JSON) -> Response:
    """Figures or the file, by Accept; never changes. Its kind is in the header Result-Kind."""
    stored = known_result(context, key)
    media_type = RESULT_KINDS[stored.kind].media_type
    if media_type == JSON or negotiated(accept, (JSON, media_type)) == media_type:
        return file_response(stored, request)
    return _metadata(stored, request, _figures(context, stored))


def known_result(context: Context, key: str) -> StoredResult:
    """Return a stored result of whichever kind.

    Raises
    ------
    NotFound
        There is none, or another version of this program made it.
    """
    stored = context.store.verified(key)
    if stored.kind not in RESULT_KINDS:
        raise NotFound(f"Result {key!r} is of a kind that this version does not know: {stored.kind}.")
    return stored


def _figures(context: Context, stored: StoredResult) -> dict[str, Any]:
    """Return the figures of a stored file; the libraries that read it are loaded when they are needed."""
    if stored.kind == "database":
        with LOADING:
            from service.convert.answers import metadata_json  # noqa: PLC0415 (start-up time)

        return metadata_json(context.databases.get(context.store, stored.key).database)
    with LOADING:
        from service.convert.result_figures import figures_of  # noqa: PLC0415 (start-up time)

    return figures_of(stored.kind, stored.path)


def file_response(
    stored: StoredResult, request: Request, further: Mapping[str, str] | None = None
) -> Response:
    """Return the file with its digest (RFC 9530), or 304."""
    headers, kind = _headers(stored) | dict(further or {}), RESULT_KINDS[stored.kind]
    digest = base64.b64encode(bytes.fromhex(stored.sha256)).decode()
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return FileResponse(
        stored.path,
        media_type=kind.media_type,
        filename=f"{stored.kind}_{stored.key[:12]}{kind.suffix}",
        headers=headers | {"Content-Digest": f"sha-256=:{digest}:"},
    )


def _metadata(stored: StoredResult, request: Request, facts: dict[str, Any]) -> Response:
    """Return the metadata, or 304."""
    headers = _headers(stored, "-json")
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return JSONResponse(
        {"hash": stored.key, "sha256": stored.sha256, "size": stored.size, **facts}, headers=headers
    )


def _headers(stored: StoredResult, form: str = "") -> dict[str, str]:
    """Headers of something that never changes, in a form that is not its file."""
    tag = f'"{stored.sha256}{form}"'
    return {"ETag": tag, "Cache-Control": _IMMUTABLE, "Vary": "Accept", "Result-Kind": stored.kind}


def _known(request: Request, tag: str) -> bool:
    """Whether the caller has this version already."""
    known = request.headers.get("if-none-match", "")
    return known.strip() == "*" or tag in (part.strip().removeprefix("W/") for part in known.split(","))
