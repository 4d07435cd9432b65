"""Around every request: identifier, limits of its body, log line, figures."""

from __future__ import annotations

import asyncio
import re
import time
import uuid
from collections.abc import Callable
from functools import partial
from typing import NoReturn

import structlog
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bind_contextvars, clear_contextvars

from lineofaction.gearbox.problems import ServiceError, TooLarge, TooSlow, Unexpected, UnsupportedMediaType
from service.access.quotas import quota_fields
from service.management.request_figures import Metrics
from service.routes.media_types import CBOR, EVENT_STREAM, RAW, media_type
from service.routes.problem_answers import problem_of
from service.tracing import TRACEPARENT, current_traceparent, trace_fields, valid_traceparent

_MAX = {b"{": (5_000, "tables"), b"[": (50_000, "lists"), b":": (50_000, "fields"), b"=": (50_000, "fields")}
"""Largest number of tables, lists or fields in a body, by the sign that begins each in JSON or in TOML.

A scene of a wind turbine has some hundred tables, two free-form flanks have a thousand lists, a reduced
housing six thousand. Numbers are not counted: a flank may have 250 000.
"""
API_PREFIX = "/v1"
logger = structlog.get_logger(__name__)
PATIENCE_S, MIN_BYTES_PER_S = 30.0, 10_000.0
"""Seconds within which a body must arrive, and bytes per second of the body that extend this time."""
_IDENTIFIER = re.compile(rb"[A-Za-z0-9._-]{1,64}")
_NO_SNIFF = (b"x-content-type-options", b"nosniff")  # browsers take the media type as it is stated


class _StreamFigures:
    """Counts of one answer if it is an event stream; `route` is empty for any other answer."""

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


class _Extent:
    """Counts of the tables, lists and fields in one body, piece by piece; binary bodies are not counted."""

    def __init__(self, content_type: str) -> None:
        self._counts = {} if media_type(content_type) in (CBOR, RAW) else dict.fromkeys(_MAX, 0)

    def add(self, piece: bytes) -> None:
        """Count the parts of a piece; raises `TooLarge`."""
        for sign in self._counts:
            self._counts[sign] += piece.count(sign)
            maximum, parts = _MAX[sign]
            if self._counts[sign] > maximum:
                text = (
                    f"The body has more than {maximum} {parts}, the limit of this service. Send less at once."
                )
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
        bind_contextvars(request_id=exchange.identifier, **trace_fields(exchange.traceparent))
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
        """Count and log; a route is named by its template, so that the number of metrics is bounded."""
        route = _template(scope)
        status = exchange.status or 0
        self._metrics.observe(scope["method"], route, status, None if exchange.stream.route else seconds)
        fields = {"method": scope["method"], "route": route, "status": status, "seconds": round(seconds, 6)}
        problem = scope.get("state", {}).get("problem")
        if problem is not None:
            self._metrics.refused(problem)
            fields["problem"] = problem
        logger.info("request", **fields)


def _template(scope: Scope) -> str:
    """Return the template of the path; the prefix of included routes is added where it lacks."""
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
        self._received, self._is_complete, self._begin = 0, False, time.perf_counter()
        self._headers = dict(scope["headers"])
        self._extent = _Extent(self._headers.get(b"content-type", b"").decode("latin-1"))
        self.refusal: ServiceError | None = None
        self.status: int | None = None
        named = self._headers.get(b"x-request-id", b"")
        # a new identifier where the caller sends none, or one that is unfit for the log
        self.identifier = named.decode() if _IDENTIFIER.fullmatch(named) else uuid.uuid4().hex[:12]
        sent = self._headers.get(b"traceparent", b"").decode("latin-1")
        self.traceparent = current_traceparent(valid_traceparent(sent))

    def refuse_announced(self) -> None:
        """Refuse a body whose headers say that it is too long, or compressed."""
        announced = self._headers.get(b"content-length", b"0")
        if announced.isdigit() and int(announced) > self._body_limit:
            raise self._too_large()
        if self._headers.get(b"content-encoding", b"identity").strip().lower() not in (b"identity", b""):
            raise UnsupportedMediaType("The body is compressed (Content-Encoding). Send it uncompressed.")

    def _too_large(self) -> ServiceError:
        return TooLarge(f"The body has more than {self._body_limit} bytes, the limit of this service.")

    async def receive(self) -> Message:
        """Count and pass on a piece of the body; after the last one, wait without limit for the caller."""
        if self._is_complete:
            return await self._receive()
        left = PATIENCE_S + self._received / MIN_BYTES_PER_S - (time.perf_counter() - self._begin)
        try:
            async with asyncio.timeout(left):
                message = await self._receive()
        except TimeoutError:
            waited = time.perf_counter() - self._begin
            self._refuse(TooSlow(f"The body did not arrive within {waited:.0f} s."))
        piece = message.get("body", b"")
        self._received += len(piece)
        self._is_complete = not message.get("more_body", False)
        if self._received > self._body_limit:
            self._refuse(self._too_large())
        try:
            self._extent.add(piece)
        except TooLarge as error:
            self._refuse(error)
        return message

    def _refuse(self, error: ServiceError) -> NoReturn:
        """Raise the refusal of the body, and keep it for `send`."""
        self.refusal = error
        raise error from None

    async def send(self, message: Message) -> None:
        """Pass on a piece of the answer.

        The framework answers our refusal of a long or slow body as it answers an unreadable body. That answer
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
            headers = [*message.get("headers", []), (b"x-request-id", self.identifier.encode()), _NO_SNIFF]
            if self.traceparent:
                headers.append((b"traceparent", self.traceparent.encode()))
            quotas = self._scope.get("state", {}).get("quotas", tuple)  # empty for a caller without a key
            fields = quota_fields(quotas()).items()
            headers += [(name.lower().encode(), value.encode()) for name, value in fields]
            message = {**message, "headers": headers}
        self.stream.see(message)
        await self._send(message)
