"""Around every request: identifier, body limit, log line, figures; errors leave as problems (RFC 9457)."""

from __future__ import annotations

import asyncio
import json
import re
import time
import uuid
from collections.abc import Callable, Mapping
from functools import partial
from http import HTTPStatus
from typing import Any, NoReturn

import structlog
from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel
from starlette.exceptions import HTTPException
from starlette.responses import Response
from starlette.routing import compile_path
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bind_contextvars, clear_contextvars

from lineofaction.gearbox.problems import (
    BadInput,
    Fault,
    ServiceError,
    TooLarge,
    TooSlow,
    Unexpected,
    UnsupportedMediaType,
)
from lineofaction.gearbox.schemas.faults import fault_of, innermost, model_in
from service.access.quotas import quota_fields
from service.management.figures import Metrics
from service.routes.media_types import CBOR, EVENT_STREAM, JSON, NO_STORE, PROBLEM, RAW, media_type
from service.tracing import TRACEPARENT, current_traceparent, trace_facts, valid_traceparent

# Every error leaves as problem+json, in one shape.

_MOST = {b"{": (5_000, "tables"), b"[": (50_000, "lists"), b":": (50_000, "fields"), b"=": (50_000, "fields")}
"""Largest number of what each sign begins, in JSON or in the TOML that it carries.

A scene of a wind turbine has some hundred tables, two free-form flanks have a thousand lists, a reduced
housing six thousand. Numbers are not counted: a flank may have 250 000.
"""
API_PREFIX = "/v1"
logger = structlog.get_logger(__name__)
PATIENCE_S, LEAST_BYTES_PER_S = 30.0, 10_000.0
"""A body is to be there after so long, and longer by what has come at this rate."""
_IDENTIFIER = re.compile(rb"[A-Za-z0-9._-]{1,64}")
_AS_SAID = (b"x-content-type-options", b"nosniff")  # a browser takes no answer for what it is not


def _problem_response(facts: Mapping[str, Any], headers: Mapping[str, str] | None = None) -> Response:
    """Return a problem, which no cache keeps, in ASCII, so that nothing a caller sent can break it."""
    body = json.dumps(facts, allow_nan=False, ensure_ascii=True).encode()
    fields = {"Cache-Control": NO_STORE, **(headers or {})}
    return Response(body, int(facts["status"]), fields, media_type=PROBLEM)


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
    """One fault, named as in the case or scene file where it lies inside one."""
    part, *loc = item["loc"]
    if part != "body":
        return fault_of(item, None, loc)
    if item["type"] == "json_invalid":
        return Fault("body", None, "valid JSON", f"{item.get('ctx', {}).get('error', '')}.")
    inside = len(loc) > 2 or (len(loc) == 2 and item["type"] == "refused")
    if loc[:1] == ["inputs"] and loc[1:2] in (["case"], ["scene"]) and inside and model is not None:
        inner = model_in(model.model_fields["inputs"].annotation)
        named = None if inner is None else inner.model_fields.get(loc[1])
        if named is not None:
            return fault_of(item, model_in(named.annotation), loc[2:])
    return fault_of(item, model, loc if loc or item["type"] == "refused" else ["body"])


def _refused_by_framework(request: Request, error: Exception) -> Response:
    """Answer what routing refuses: unknown path, wrong method, unreadable body."""
    assert isinstance(error, HTTPException)
    phrase = HTTPStatus(error.status_code).phrase
    request.state.problem = phrase.lower().replace(" ", "-")
    facts = {
        "type": "about:blank",
        "title": phrase,
        "status": error.status_code,
        "detail": str(error.detail),
        "errors": [],
    }
    headers = dict(error.headers or {})
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        # whichever routes hold them: the framework names those of one route only
        paths = request.app.openapi()["paths"]
        matching = [path for path in paths if compile_path(path)[0].match(request.url.path)]
        headers["Allow"] = ", ".join(sorted({name.upper() for path in matching for name in paths[path]}))
    return _problem_response(facts, headers)


# Event streams as they are sent: how many are open, and how many events went out.


class _StreamFigures:
    """Watches the answer to one request; anything but an event stream leaves no trace and no `route`."""

    def __init__(self, metrics: Metrics, route: Callable[[], str]) -> None:
        self._metrics, self._template = metrics, route
        self.route = ""

    def see(self, message: Message) -> None:
        """Look at a piece of the answer; the pieces of a stream are whole events or comments."""
        if message["type"] == "http.response.start":
            if dict(message.get("headers", ())).get(b"content-type", b"").startswith(EVENT_STREAM.encode()):
                self.route = self._template()
                self._metrics.streams(self.route, 1)
        elif self.route:
            blocks = message.get("body", b"").split(b"\n\n")
            events = sum(bool(block) and not block.startswith(b":") for block in blocks)
            self._metrics.sent(self.route, events)

    def end(self) -> None:
        if self.route:
            self._metrics.streams(self.route, -1)


# Limits of a body before it is read: the cost of reading depends on its parts, not on its bytes.


class _Extent:
    """The parts of one body, counted as its pieces come; of binary bodies nothing is counted."""

    def __init__(self, content_type: str) -> None:
        self._found = {} if media_type(content_type) in (CBOR, RAW) else dict.fromkeys(_MOST, 0)

    def add(self, piece: bytes) -> None:
        """Count the parts of a piece; raises `TooLarge`."""
        for sign in self._found:
            self._found[sign] += piece.count(sign)
            most, parts = _MOST[sign]
            if self._found[sign] > most:
                text = f"The body has more than {most} {parts}, the limit of this service. Send less at once."
                raise TooLarge(text)


class Guard:
    """Outermost layer of the app."""

    def __init__(self, app: ASGIApp, body_limit: int, metrics: Metrics) -> None:
        self._app, self._body_limit, self._metrics = app, body_limit, metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        stream = _StreamFigures(self._metrics, partial(_template, scope))
        exchange = _Exchange(scope, receive, send, self._body_limit, stream)
        clear_contextvars()
        TRACEPARENT.set(exchange.traceparent)
        # both stand in every line that this request logs
        bind_contextvars(request_id=exchange.identifier, **trace_facts(exchange.traceparent))
        begin = time.perf_counter()
        try:
            exchange.refuse_announced()
            await self._app(scope, exchange.receive, exchange.send)
        except ServiceError as error:
            await self._answer(error, exchange, scope)
        except Exception:
            logger.exception("unexpected failure", reference=exchange.identifier, path=scope["path"])
            await self._answer(Unexpected(exchange.identifier), exchange, scope)
        finally:
            stream.end()
            self._note(scope, exchange, time.perf_counter() - begin)

    @staticmethod
    async def _answer(error: ServiceError, exchange: _Exchange, scope: Scope) -> None:
        """Send a problem, unless part of an answer is on its way already."""
        if exchange.status is None:
            scope.setdefault("state", {})["problem"] = error.kind
            await problem_of(error)(scope, exchange.receive, exchange.send)

    def _note(self, scope: Scope, exchange: _Exchange, seconds: float) -> None:
        """Count and log; a route is named by its template, so that figures stay few."""
        route = _template(scope)
        status = exchange.status or 0
        self._metrics.observe(scope["method"], route, status, None if exchange.stream.route else seconds)
        facts = {"method": scope["method"], "route": route, "status": status, "seconds": round(seconds, 6)}
        problem = scope.get("state", {}).get("problem")
        if problem is not None:
            self._metrics.refused(problem)
            facts["problem"] = problem
        logger.info("request", **facts)


def _template(scope: Scope) -> str:
    """Return the template of the path, with the prefix that routes may have been included under."""
    template = getattr(scope.get("route"), "path", None)
    if template is None:
        return "unknown"
    inside = scope["path"].startswith(API_PREFIX) and not template.startswith(API_PREFIX)
    return f"{API_PREFIX}{template}" if inside else str(template)


class _Exchange:
    """One request and its answer, watched."""

    def __init__(
        self, scope: Scope, receive: Receive, send: Send, body_limit: int, stream: _StreamFigures
    ) -> None:
        self.stream = stream
        self._scope, self._receive, self._send, self._body_limit = scope, receive, send, body_limit
        self._received, self._whole, self._begin = 0, False, time.perf_counter()
        self._headers = dict(scope["headers"])
        self._extent = _Extent(self._headers.get(b"content-type", b"").decode("latin-1"))
        self.refusal: ServiceError | None = None
        self.status: int | None = None
        named = self._headers.get(b"x-request-id", b"")  # another for none, or one that a log should not hold
        self.identifier = named.decode() if _IDENTIFIER.fullmatch(named) else uuid.uuid4().hex[:12]
        sent = self._headers.get(b"traceparent", b"").decode("latin-1")
        self.traceparent = current_traceparent(valid_traceparent(sent))

    def refuse_announced(self) -> None:
        """Refuse a body that says itself that it is too long, or packed."""
        announced = self._headers.get(b"content-length", b"0")
        if announced.isdigit() and int(announced) > self._body_limit:
            raise self._too_large()
        if self._headers.get(b"content-encoding", b"identity").strip().lower() not in (b"identity", b""):
            raise UnsupportedMediaType("The body is compressed (Content-Encoding). Send it uncompressed.")

    def _too_large(self) -> ServiceError:
        return TooLarge(f"The body has more than {self._body_limit} bytes, the limit of this service.")

    async def receive(self) -> Message:
        """Pass on a piece of the body, counting; once it is whole wait as long as it takes."""
        if self._whole:
            return await self._receive()
        left = PATIENCE_S + self._received / LEAST_BYTES_PER_S - (time.perf_counter() - self._begin)
        try:
            async with asyncio.timeout(left):
                message = await self._receive()
        except TimeoutError:
            waited = time.perf_counter() - self._begin
            self._refuse(TooSlow(f"The body did not arrive within {waited:.0f} s."))
        piece = message.get("body", b"")
        self._received += len(piece)
        self._whole = not message.get("more_body", False)
        if self._received > self._body_limit:
            self._refuse(self._too_large())
        try:
            self._extent.add(piece)
        except TooLarge as error:
            self._refuse(error)
        return message

    def _refuse(self, error: ServiceError) -> NoReturn:
        """Raise why the body is not read on, and keep it: the framework takes it for an unreadable body."""
        self.refusal = error
        raise error from None

    async def send(self, message: Message) -> None:
        """Pass on a piece of the answer.

        The framework takes our refusal of a long or slow body for an unreadable one: what it answers to that
        is replaced by the refusal.
        """
        if self.refusal is None:
            await self._pass(message)
        elif self.status is None:
            self._scope.setdefault("state", {})["problem"] = self.refusal.kind
            await problem_of(self.refusal)(self._scope, self._receive, self._pass)

    async def _pass(self, message: Message) -> None:
        """Pass on a piece of the answer, with the request's identifier in its headers."""
        if message["type"] == "http.response.start":
            self.status = message["status"]
            headers = [*message.get("headers", []), (b"x-request-id", self.identifier.encode()), _AS_SAID]
            if self.traceparent:
                headers.append((b"traceparent", self.traceparent.encode()))
            quotas = self._scope.get("state", {}).get("quotas", tuple)  # of who has shares
            fields = quota_fields(quotas()).items()
            headers += [(name.lower().encode(), value.encode()) for name, value in fields]
            message = {**message, "headers": headers}
        self.stream.see(message)
        await self._send(message)
