"""The HTTP server of a process, its connections bounded."""

from __future__ import annotations

import asyncio
import socket
import uuid
from collections.abc import Callable
from typing import Any

import structlog
import uvicorn
from fastapi import FastAPI
from uvicorn.protocols.http.auto import AutoHTTPProtocol

from lineofaction.gearbox.problems import HeadTooLarge, Malformed, ServiceError, TooManyRequests, TooSlow
from service.management.vitals import EventLoop, Vitals
from service.routes.context import Context
from service.routes.problem_answers import problem_of

MAX_HEAD_BYTES = 65_536
HEAD_WITHIN_S = 20.0
_STOPPING_S = 2
_KEEP_ALIVE_S = 75
"""Seconds for which an idle connection stays open, longer than clients (5 s) and proxies (60 s) keep one. A
server that closed first would answer a request that is on its way at that moment with a reset."""

logger = structlog.get_logger(__name__)


class BoundedHttp(AutoHTTPProtocol):  # type: ignore[misc, valid-type]  # one of two classes, chosen by uvicorn
    """A connection that is closed when a head is too long or late, or when idle while others want in.

    Without it a peer that sends a head byte by byte holds its connection for ever, one that never ends a
    head fills the memory, and some hundred that send nothing shut everybody out. Both classes of uvicorn
    begin a new `cycle` with every head that is complete.
    """

    _timer: asyncio.TimerHandle | None = None  # runs while a head is awaited
    _head = 0  # bytes received since then

    @property
    def _idle(self) -> dict[BoundedHttp, None]:
        """Connections of this server without a request, the longest idle one first."""
        idle: dict[BoundedHttp, None] = self.server_state.__dict__.setdefault("idle", {})
        return idle

    def connection_made(self, transport: Any) -> None:
        """Make room if there are too many, and wait for the first head."""
        super().connection_made(transport)
        self.config.app.state.metrics.connected(1)
        capacity = self.config.app.state.capacity
        if len(self.connections) > capacity.comfortable_connections and self._idle:
            self._close_longest_idle()
        elif len(self.connections) > capacity.connections:
            self._refuse(TooManyRequests("All connections are busy. Try again soon."))
            return
        self._idle[self] = None
        self._await_head()

    def data_received(self, data: bytes) -> None:
        """Read on; close the connection when its head is too long."""
        before = self.cycle
        if self._timer is None and (before is None or before.response_complete):
            self._await_head()
        self._head += len(data)
        super().data_received(data)
        if self.cycle is not before:
            self._head_is_there()
        elif self._timer is not None and self._head > MAX_HEAD_BYTES:
            self._refuse(HeadTooLarge(f"The head has more than {MAX_HEAD_BYTES} bytes."))

    def on_response_complete(self) -> None:
        """Count as idle, unless the next request is there already."""
        super().on_response_complete()
        if self.cycle.response_complete and not self.transport.is_closing():
            self._idle[self] = None

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no more."""
        self._head_is_there()
        self.config.app.state.metrics.connected(-1)
        super().connection_lost(exc)

    def send_400_response(self, msg: str) -> None:
        """Refuse bytes that are no HTTP, in place of the server's plain text."""
        self._refuse(Malformed(msg))

    def _close_longest_idle(self) -> None:
        """Close one connection, as any server may at any time between requests (RFC 9112, section 9.5)."""
        longest = next(iter(self._idle))
        longest._head_is_there()
        longest.transport.close()
        self.config.app.state.metrics.dropped()
        logger.info("idle connection closed", connections=len(self.connections))

    def _await_head(self) -> None:
        """Begin to count and to wait."""
        self._head = 0
        late = TooSlow(f"The head of the request did not arrive within {HEAD_WITHIN_S:g} s.")
        self._timer = self.loop.call_later(HEAD_WITHIN_S, self._refuse, late)

    def _head_is_there(self) -> None:
        """Wait no more."""
        self._idle.pop(self, None)
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _refuse(self, error: ServiceError) -> None:
        """Say why in the one shape of all problems, count and log it, and close."""
        self._head_is_there()
        if self.transport.is_closing():
            return
        identifier, answer = uuid.uuid4().hex[:12], problem_of(error)
        headers = [*answer.raw_headers, (b"x-request-id", identifier.encode()), (b"connection", b"close")]
        lines = b"".join(b"%s: %s\r\n" % header for header in headers)
        status = f"HTTP/1.1 {error.status} {error.title}\r\n".encode()
        self.transport.write(status + lines + b"\r\n" + bytes(answer.body))
        self.transport.close()
        self.config.app.state.metrics.refused(error.kind)
        logger.info("request", status=error.status, problem=error.kind, request_id=identifier)


def http_server(app: FastAPI) -> Server:
    """Return the server of an app."""
    config = uvicorn.Config(
        app,
        http=BoundedHttp,
        ws="none",
        log_config=None,
        access_log=False,
        timeout_graceful_shutdown=_STOPPING_S,
        timeout_keep_alive=_KEEP_ALIVE_S,
        lifespan="on",
    )
    return Server(config, app.state.context, app.state.metrics.text)


class Server(uvicorn.Server):
    """HTTP server that, as it stops, ends waits for live answers at once and other requests in time.

    Attributes
    ----------
    vitals : Vitals
        Signs of life of the process that the server runs in.
    metrics : callable
        Returns its figures as text.
    """

    def __init__(self, config: uvicorn.Config, context: Context, metrics: Callable[[], bytes]) -> None:
        super().__init__(config)
        self._context, self._loop, self.metrics = context, EventLoop(), metrics
        self.vitals = Vitals(context.scheduler, context.writes, self._loop.fault)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to serve."""
        self._loop.loop = asyncio.get_running_loop()
        await super().startup(sockets)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End the workers of waiting callers, then end the server as uvicorn does."""
        await asyncio.to_thread(self._context.stop_waiting)
        await super().shutdown(sockets)
