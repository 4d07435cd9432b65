"""Stored results as metadata or as their files."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request
from starlette.responses import FileResponse, JSONResponse, Response

from lineofaction.gearbox.loading import LOADING
from lineofaction.gearbox.problems import DamagedFile, NotFound
from lineofaction.gearbox.registry import NETCDF
from lineofaction.gearbox.schemas.result_kinds import HASH, RESULT_KINDS, SUFFIX
from service.access import Scope
from service.routes.context import Context, Ctx
from service.routes.media_types import JSON, OF_VERSIONS, described_headers, negotiated
from service.routes.refusals import documented
from service.routes.scopes import ScopedRoute, needs
from service.schemas.ogc import ResultFigures
from service.store import StoredResult

_IMMUTABLE = "public, max-age=31536000, immutable"

Key = Annotated[str, Path(pattern=HASH, description="Content hash of the input")]
Accept = Annotated[str, Header(description=f"{NETCDF} for the file, application/json for its figures")]
FILE = {"type": "string", "format": "binary"}
OF_RESULT = (*OF_VERSIONS, "Result-Kind")
_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {
        "model": ResultFigures,
        "description": "The figures of the result, or its file",
        "content": {JSON: {}, NETCDF: {"schema": FILE}},
        "headers": described_headers(*OF_RESULT, "Content-Digest"),
    },
    304: {"description": "Not modified", "headers": described_headers(*OF_RESULT)},
}

router = APIRouter(tags=["results"], route_class=ScopedRoute)


@router.get(
    "/results/{key}",
    summary="A result",
    response_class=Response,
    responses=_ANSWERS | documented(NotFound, DamagedFile),
)
@needs(Scope.READ)
def get_result(key: Key, request: Request, context: Ctx, accept: Accept = JSON) -> Response:
    """Figures or the file, by Accept; never changes. Its kind is in the header Result-Kind."""
    stored = known_result(context, key)
    if negotiated(accept, (JSON, NETCDF)) == NETCDF:
        return file_response(stored, request)
    return _metadata(stored, request, _figures(context, stored))


@router.get(
    "/results/{key}/file",
    summary="The file of a result",
    response_class=Response,
    responses={
        200: {
            "description": "The netCDF file",
            "content": {NETCDF: {"schema": FILE}},
            "headers": described_headers(*OF_RESULT, "Content-Digest"),
        },
        304: _ANSWERS[304],
        **documented(NotFound, DamagedFile),
    },
)
@needs(Scope.READ)
def result_file(key: Key, request: Request, context: Ctx) -> Response:
    """Return the file whatever the request accepts, for browsers and generated clients; never changes."""
    return file_response(known_result(context, key), request)


def known_result(context: Context, key: str, kind: str | None = None) -> StoredResult:
    """Return a stored result of a kind, or of whichever it is.

    Raises
    ------
    NotFound
        There is none, or another version of this program made it.
    """
    stored = context.store.verified(key, kind)
    if stored.kind not in RESULT_KINDS:
        raise NotFound(f"Result {key!r} is of a kind that this version does not know: {stored.kind}.")
    if stored.path.suffix != SUFFIX:
        reason = "Version 0.1 stored it as JSON; results are netCDF"
        raise NotFound(f"Result {key!r} cannot be read. {reason}. Submit its case again to compute it.")
    return stored


def _figures(context: Context, stored: StoredResult) -> dict[str, Any]:
    """Return the figures of a stored file; the libraries that read it are loaded when they are needed."""
    if stored.kind == "database":
        with LOADING:
            from lineofaction.gearbox.convert.answers import metadata_json  # noqa: PLC0415 (start-up time)

        return metadata_json(context.databases.get(context.store, stored.key).database)
    with LOADING:
        from lineofaction.gearbox.convert.runs import figures_of  # noqa: PLC0415 (start-up time)

    return figures_of(stored.kind, stored.path)


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
    """Return the figures with their digest, or 304."""
    headers = _headers(stored, "-json")
    if _known(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    answer = JSONResponse(
        {"hash": stored.key, "sha256": stored.sha256, "size": stored.size, **facts}, headers=headers
    )
    answer.headers.update(_digest(hashlib.sha256(answer.body).digest()))
    return answer


def _digest(sha256: bytes) -> dict[str, str]:
    return {"Content-Digest": f"sha-256=:{base64.b64encode(sha256).decode()}:"}


def _headers(stored: StoredResult, form: str = "") -> dict[str, str]:
    """Headers of something that never changes, in a form that is not its file."""
    tag = f'"{stored.sha256}{form}"'
    return {"ETag": tag, "Cache-Control": _IMMUTABLE, "Vary": "Accept", "Result-Kind": stored.kind}


def _known(request: Request, tag: str) -> bool:
    """Whether the caller has this version already."""
    known = request.headers.get("if-none-match", "")
    return known.strip() == "*" or tag in (part.strip().removeprefix("W/") for part in known.split(","))
