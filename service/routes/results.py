"""Stored results as metadata or netCDF."""

from __future__ import annotations

import base64
from typing import Annotated, Any

from fastapi import APIRouter, Header, Path, Request
from starlette.responses import FileResponse, JSONResponse, Response

from dynamics.linearize import ForcedResponse, ModalAnalysis
from dynamics.periodic import SteadyStates
from fe_contact.analysis import LoadDistribution
from service.convert.answers import metadata_json
from service.convert.flanks import flank_json
from service.convert.modal import modes_json
from service.convert.response import response_json
from service.convert.runs import run_json
from service.convert.sensitivity import studies_json
from service.convert.sensitivity_file import read_studies
from service.convert.steady import steady_json
from service.routes.context import Ctx
from service.routes.errors import documented
from service.schemas.result_kinds import NETCDF, RESULT_KINDS
from service.store import StoredResult

_IMMUTABLE = "public, max-age=31536000, immutable"
_BINARY = {NETCDF: {"schema": {"type": "string", "format": "binary"}}, "application/json": {}}

Key = Annotated[str, Path(pattern="^[0-9a-f]{64}$", description="Content hash of the input")]
Accept = Annotated[str, Header(description=f"{NETCDF} for the file, application/json for its metadata")]

router = APIRouter(tags=["results"])


def _answers() -> dict[int | str, dict[str, Any]]:
    """Return the OpenAPI entries of a stored result."""
    found: dict[int | str, dict[str, Any]] = {
        200: {"description": "The result", "content": _BINARY},
        304: {"description": "Not modified"},
    }
    return found | documented(404, 422, 500)


@router.get("/databases/{key}", summary="An STE database", response_class=Response, responses=_answers())
def database(key: Key, request: Request, context: Ctx, accept: Accept = "application/json") -> Response:
    """Metadata or the file, by Accept."""
    stored = context.store.verified(key, "database")
    if _wants_file(accept):
        return _file(stored, request)
    return _metadata(stored, request, metadata_json(context.databases.get(context.store, key).database))


@router.get("/runs/{key}", summary="A run", response_class=Response, responses=_answers())
def run(key: Key, request: Request, context: Ctx, accept: Accept = "application/json") -> Response:
    """Metadata or the file, by Accept."""
    stored = context.store.verified(key, "run")
    return (
        _file(stored, request) if _wants_file(accept) else _metadata(stored, request, run_json(stored.path))
    )


@router.get("/flanks/{key}", summary="Flank results", response_class=Response, responses=_answers())
def flanks(key: Key, request: Request, context: Ctx, accept: Accept = "application/json") -> Response:
    """Figures or the file, by Accept."""
    stored = context.store.verified(key, "flanks")
    if _wants_file(accept):
        return _file(stored, request)
    return _metadata(stored, request, flank_json(LoadDistribution.from_netcdf(stored.path)))


@router.get(
    "/sensitivities/{key}", summary="A sensitivity study", response_class=Response, responses=_answers()
)
def sensitivity(key: Key, request: Request, context: Ctx, accept: Accept = "application/json") -> Response:
    """All curves or the file, by Accept."""
    stored = context.store.verified(key, "sensitivity")
    if _wants_file(accept):
        return _file(stored, request)
    return _metadata(stored, request, studies_json(read_studies(stored.path)))


@router.get("/ablations/{key}", summary="An ablation", response_class=Response, responses=_answers())
def ablation(key: Key, request: Request, context: Ctx) -> Response:
    """Return the file, which is JSON, whatever is accepted."""
    return _file(context.store.verified(key, "ablation"), request)


@router.get("/frontiers/{key}", summary="An accuracy ladder", response_class=Response, responses=_answers())
def frontier(key: Key, request: Request, context: Ctx) -> Response:
    """Return the file, which is JSON, whatever is accepted."""
    return _file(context.store.verified(key, "frontier"), request)


@router.get("/modes/{key}", summary="A modal analysis", response_class=Response, responses=_answers())
def modes(key: Key, request: Request, context: Ctx, accept: Accept = "application/json") -> Response:
    """Figures or the file, by Accept."""
    stored = context.store.verified(key, "modes")
    if _wants_file(accept):
        return _file(stored, request)
    return _metadata(stored, request, modes_json(ModalAnalysis.from_netcdf(stored.path)))


@router.get("/responses/{key}", summary="A forced response", response_class=Response, responses=_answers())
def forced_response(
    key: Key, request: Request, context: Ctx, accept: Accept = "application/json"
) -> Response:
    """Figures or the file, by Accept."""
    stored = context.store.verified(key, "response")
    if _wants_file(accept):
        return _file(stored, request)
    return _metadata(stored, request, response_json(ForcedResponse.from_netcdf(stored.path)))


@router.get("/steadies/{key}", summary="Steady states", response_class=Response, responses=_answers())
def steady(key: Key, request: Request, context: Ctx, accept: Accept = "application/json") -> Response:
    """Figures or the file, by Accept."""
    stored = context.store.verified(key, "steady")
    if _wants_file(accept):
        return _file(stored, request)
    return _metadata(stored, request, steady_json(SteadyStates.from_netcdf(stored.path)))


def _wants_file(accept: str) -> bool:
    """Whether the caller prefers the file: the first of both types that the header names decides."""
    order = [part.partition(";")[0].strip().lower() for part in accept.split(",")]
    return next((part == NETCDF for part in order if part in (NETCDF, "application/json")), False)


def _file(stored: StoredResult, request: Request) -> Response:
    """Return the file with its digest (RFC 9530), or 304."""
    headers, kind = _headers(f'"{stored.sha256}"'), RESULT_KINDS[stored.kind]
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
