"""A receiver of webhooks on loopback that takes them, refuses, hangs, drips or redirects, by their path."""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

KEY = bytes(range(32))
SECRET = "whsec_" + base64.b64encode(KEY).decode()


@dataclass(frozen=True)
class Received:
    """A request that came."""

    path: str
    headers: dict[str, str]
    body: bytes

    @property
    def signed(self) -> bool:
        """Whether the signature is that of Standard Webhooks, written out here once more."""
        content = f"{self.headers['webhook-id']}.{self.headers['webhook-timestamp']}.".encode() + self.body
        digest = base64.b64encode(hmac.digest(KEY, content, hashlib.sha256)).decode()
        return self.headers["webhook-signature"] == f"v1,{digest}"

    @property
    def json(self) -> Any:
        return json.loads(self.body)


class Receiver(ThreadingHTTPServer):
    """Notes requests; `refusals` is how many a path ``/refuse`` gets first, `released` ends hanging ones."""

    daemon_threads = True

    def __init__(self) -> None:
        self.requests: list[Received] = []
        self.refusals = 0
        self.released = threading.Event()
        super().__init__(("127.0.0.1", 0), _Handler)

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"

    def paths(self) -> list[str]:
        return [request.path for request in self.requests]


class _Handler(BaseHTTPRequestHandler):
    """Answers one request."""

    server: Receiver

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["content-length"]))
        headers = {name.lower(): value for name, value in self.headers.items()}
        self.server.requests.append(Received(self.path, headers, body))
        with suppress(OSError):
            self._answer(self.path.partition("?")[0])

    def _answer(self, path: str) -> None:
        if path == "/hang":
            self.server.released.wait(300.0)
        if path == "/drip":
            while not self.server.released.wait(0.1):
                self.wfile.write(b"H")
        if path == "/redirect":
            self.send_response(302)
            self.send_header("Location", f"{self.server.origin}/secret")
        elif path == "/refuse" and self.server.refusals > 0:
            self.server.refusals -= 1
            self.send_response(503)
        else:
            self.send_response(410 if path == "/gone" else 204)
        self.end_headers()

    def log_message(self, *_: object) -> None:
        """Say nothing."""


@contextmanager
def receiver() -> Iterator[Receiver]:
    with Receiver() as server:
        thread = threading.Thread(target=server.serve_forever, args=(0.05,))
        thread.start()
        try:
            yield server
        finally:
            server.released.set()
            server.shutdown()
            thread.join()
