"""The management port: health, readiness and metrics of a process, without a key.

The port answers from threads of its own. So it is the same for a program with an event loop and one without,
and it can report that the loop of requests is stuck.
"""

from __future__ import annotations

import json
import socket
import threading
from collections.abc import Callable
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler
from socketserver import TCPServer, ThreadingMixIn
from types import TracebackType
from typing import Any, NamedTuple, Self
from urllib.parse import urlsplit

from lineofaction.gearbox.problems import BadInput
from service.management.vitals import Vitals

METRICS_TYPE = "text/plain; version=0.0.4; charset=utf-8"
_MAX_REQUESTS = 16
"""Most requests answered at the same time; a connection beyond them is closed."""
_PATIENCE_S = 5.0
"""Longest pause in s before the next piece of a request."""


class _Answer(NamedTuple):
    """An answer: status, media type, body."""

    status: HTTPStatus
    media_type: str
    body: bytes


class ManagementServer:
    """Server of the port, a context manager: it answers until the context ends.

    Raises `BadInput`: the port is taken, or the address does not belong to this machine.

    Parameters
    ----------
    host, port : str, int
        Address of the port; port 0: a free one.
    metrics : callable
        Returns the text exposition.
    """

    def __init__(self, host: str, port: int, vitals: Vitals, metrics: Callable[[], bytes]) -> None:
        paths = {
            "/health": lambda: _status_answer(vitals.fault_of_health(), "ok"),
            "/ready": lambda: _status_answer(vitals.fault_of_readiness(), "ready"),
            "/metrics": lambda: _Answer(HTTPStatus.OK, METRICS_TYPE, metrics()),
        }
        try:
            self._server = _Server(host, port, paths)
        except OSError as error:
            remedy = f"{error.strerror}. Choose another with LOA_MANAGEMENT_PORT, or 0 for a free one."
            raise BadInput.of("management_port", port, "a free port", remedy) from None
        self._thread = threading.Thread(target=self._server.serve_forever, name="management", daemon=True)

    @property
    def address(self) -> str:
        """Return the URL."""
        host, port = self._server.server_address[:2]
        name = f"[{host!s}]" if ":" in str(host) else host
        return f"http://{name!s}:{port}"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, _kind: type[BaseException] | None, _error: BaseException | None, _trace: TracebackType | None
    ) -> None:
        self._server.shutdown()
        self._server.server_close()


class _Server(ThreadingMixIn, TCPServer):
    """Server with a thread for each request, up to `_MAX_REQUESTS`."""

    daemon_threads = True
    block_on_close = False
    allow_reuse_address = True

    def __init__(self, host: str, port: int, paths: dict[str, Callable[[], _Answer]]) -> None:
        family, *_, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        self.address_family, self.paths = family, paths
        self._room = threading.BoundedSemaphore(_MAX_REQUESTS)
        super().__init__(address, _Handler)  # type: ignore[arg-type]  # an IPv6 address has four parts

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer in a thread, if there is room."""
        if self._room.acquire(blocking=False):
            super().process_request(request, client_address)
        else:
            self.shutdown_request(request)

    def process_request_thread(self, request: Any, client_address: Any) -> None:
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._room.release()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Keep quiet about connections that broke."""


class _Handler(BaseHTTPRequestHandler):
    """Answers one request."""

    timeout = _PATIENCE_S
    server: _Server

    def do_GET(self) -> None:
        self._answer(with_body=True)

    def do_HEAD(self) -> None:
        self._answer(with_body=False)

    def _answer(self, *, with_body: bool) -> None:
        absent = _document(HTTPStatus.NOT_FOUND, {"detail": "Here are /health, /ready and /metrics."})
        answer = self.server.paths.get(urlsplit(self.path).path, lambda: absent)
        status, media_type, body = answer()
        self.send_response(status)
        fields = {"Content-Type": media_type, "Content-Length": str(len(body)), "Cache-Control": "no-store"}
        for name, value in fields.items():
            self.send_header(name, value)
        self.end_headers()
        if with_body:
            self.wfile.write(body)

    def version_string(self) -> str:
        """Return the name of the server, without the name of the interpreter."""
        return "lineofaction"

    def log_message(self, format: str, *arguments: object) -> None:  # noqa: A002 (the name of http.server)
        """Log nothing: probes come every few seconds."""


def _status_answer(fault: str, well: str) -> _Answer:
    if fault:
        return _document(HTTPStatus.SERVICE_UNAVAILABLE, {"status": f"not {well}", "detail": fault})
    return _document(HTTPStatus.OK, {"status": well})


def _document(status: HTTPStatus, fields: dict[str, str]) -> _Answer:
    return _Answer(status, "application/json", json.dumps(fields).encode())
