"""Answers to errors: problem+json, in one shape (RFC 9457)."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.routing import compile_path

from lineofaction.gearbox.problems import BadInput, Fault, ServiceError, UnsupportedMediaType
from lineofaction.gearbox.schemas.faults import fault_of, innermost, model_in
from service.routes.media_types import JSON, NO_STORE, PROBLEM, media_type


def _problem_response(problem: Mapping[str, Any], headers: Mapping[str, str] | None = None) -> Response:
    """Return a problem, which no cache keeps, in ASCII, so that nothing a caller sent can break it."""
    body = json.dumps(problem, allow_nan=False, ensure_ascii=True).encode()
    fields = {"Cache-Control": NO_STORE, **(headers or {})}
    return Response(body, int(problem["status"]), fields, media_type=PROBLEM)


def problem_of(error: ServiceError) -> Response:
    """Return the response to an error raised on purpose."""
    headers = {} if error.retry_after_s is None else {"Retry-After": str(error.retry_after_s)}
    if error.challenge is not None:
        headers["WWW-Authenticate"] = error.challenge
    if error.accept_post is not None:
        headers["Accept-Post"] = error.accept_post
    return _problem_response(error.as_json(), headers)


def install_error_handlers(app: FastAPI) -> None:
    """Let `app` answer every error with a problem."""
    app.add_exception_handler(ServiceError, _raised_on_purpose)
    app.add_exception_handler(RequestValidationError, _invalid_request)
    app.add_exception_handler(HTTPException, _refused_by_framework)


def _raised_on_purpose(request: Request, error: Exception) -> Response:
    assert isinstance(error, ServiceError)
    request.state.problem = error.kind
    return problem_of(error)


def _invalid_request(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    return _raised_on_purpose(request, refusal_of(request, error))


def refusal_of(request: Request, error: RequestValidationError) -> ServiceError:
    """Return the refusal of a request that the framework could not read: its faults, or its media type."""
    sent = media_type(request.headers.get("content-type", ""))
    unread = any(item["loc"][0] == "body" and item["type"] != "missing" for item in error.errors())
    as_json = sent == JSON or (sent.startswith("application/") and sent.endswith("+json"))
    if unread and not as_json:
        return UnsupportedMediaType.of(sent, JSON)
    model = getattr(request.scope.get("endpoint"), "body_model", None)
    return BadInput(_request_fault(item, model) for item in innermost(error.errors()))


def _request_fault(item: Mapping[str, Any], model: type[BaseModel] | None) -> Fault:
    """Return a fault; one inside a case or scene is named by its field there, as in a file."""
    part, *loc = item["loc"]
    if part != "body":
        return fault_of(item, None, loc)
    if item["type"] == "json_invalid":
        return Fault("body", None, "valid JSON", f"{item.get('ctx', {}).get('error', '')}.")
    # inside, not about the case or scene as a whole, except for a rule on all of it
    inside = len(loc) > 2 or (len(loc) == 2 and item["type"] == "refused")
    if loc[:1] == ["inputs"] and loc[1:2] in (["case"], ["scene"]) and inside and model is not None:
        inner = model_in(model.model_fields["inputs"].annotation)
        named = None if inner is None else inner.model_fields.get(loc[1])
        if named is not None:
            return fault_of(item, model_in(named.annotation), loc[2:])
    return fault_of(item, model, loc if loc or item["type"] == "refused" else ["body"])


def _refused_by_framework(request: Request, error: Exception) -> Response:
    """Answer refusals of the routing: unknown path, wrong method, unreadable body."""
    assert isinstance(error, HTTPException)
    phrase = HTTPStatus(error.status_code).phrase
    request.state.problem = phrase.lower().replace(" ", "-")
    problem = {
        "type": "about:blank",
        "title": phrase,
        "status": error.status_code,
        "detail": str(error.detail),
        "errors": [],
    }
    headers = dict(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        # methods of all routes at this path: the framework names those of one route only
        paths = request.app.openapi()["paths"]
        matching = [path for path in paths if compile_path(path)[0].match(request.url.path)]
        headers["Allow"] = ", ".join(sorted({name.upper() for path in matching for name in paths[path]}))
    return _problem_response(problem, headers)
