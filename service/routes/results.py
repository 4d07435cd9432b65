"""Stored results as metadata or netCDF."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request
from starlette.responses import FileResponse, JSONResponse, Response

from service.loading import LOADING
from service.registry import NETCDF
from service.routes.context import Context, Ctx
from service.routes.errors import documented
from service.routes.media_types import JSON, negotiated
from service.schemas.result_kinds import RESULT_KINDS, ResultKind
from service.store import StoredResult

_IMMUTABLE = "public, max-age=31536000, immutable"

Key = Annotated[str, Path(pattern="^[0-9a-f]{64}$", description="Content hash of the input")]
Accept = Annotated[str, Header(description=f"{NETCDF} for the file, application/json for its metadata")]

router = APIRouter(tags=["results"])


def _answers(kind: ResultKind) -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI entries of a stored result."""
    file = {"schema": {"type": "string", "format": "binary"}}
    content = {JSON: {"schema": {"type": "object"}}} | ({} if kind.media_type == JSON else {NETCDF: file})
    answers: dict[int | str, dict[str, Any]] = {
        200: {"description": "The result", "content": content},
        304: {"description": "Not modified"},
    }
    return answers | documented(404, 422, 500)


def _add_result(kind: ResultKind) -> None:
    """Add the route of the results of one kind."""

    def result(key: Key, request: Request, context: Ctx, accept: Accept = JSON) -> Response:
        """Figures or the file, by Accept; never changes."""
        stored = context.store.verified(key, kind.name)
        if kind.media_type == JSON or negotiated(accept, (JSON, kind.media_type)) == kind.media_type:
            return file_response(stored, request)
        return _metadata(stored, request, _figures(context, stored))

    router.add_api_route(
        f"{kind.path.removeprefix('/v1')}/{{key}}",
        result,
        name=f"result_{kind.name}",
        summary=f"A result: {kind.name}",
        response_class=Response,
        responses=_answers(kind),
    )


def _figures(context: Context, stored: StoredResult) -> dict[str, Any]:
    """Return the figures of a stored file; the libraries that read it are loaded when they are needed."""
    if stored.kind == "database":
        with LOADING:
            from service.convert.answers import metadata_json  # noqa: PLC0415 (start-up time)

        return metadata_json(context.databases.get(context.store, stored.key).database)
    with LOADING:
        from service.convert.result_figures import figures_of  # noqa: PLC0415 (start-up time)

    return figures_of(stored.kind, stored.path)


for _kind in RESULT_KINDS.values():
    _add_result(_kind)


def file_response(
    stored: StoredResult, request: Request, further: Mapping[str, str] | None = None
) -> Response:
    """Return the file with its digest (RFC 9530), or 304."""
    headers, kind = _headers(f'"{stored.sha256}"') | dict(further or {}), RESULT_KINDS[stored.kind]
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
    headers = _headers(f'"{stored.sha256}-json"')
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    return JSONResponse(
        {"hash": stored.key, "sha256": stored.sha256, "size": stored.size, **facts}, headers=headers
    )


def _headers(tag: str) -> dict[str, str]:
    """Headers of something that never changes."""
    return {"ETag": tag, "Cache-Control": _IMMUTABLE, "Vary": "Accept"}


def _known(request: Request, tag: str) -> bool:
    """Whether the caller has this version already."""
    known = request.headers.get("if-none-match", "")
    return known.strip() == "*" or tag in (part.strip().removeprefix("W/") for part in known.split(","))
