"""HTTP connections whose request heads are bounded in size and time, which uvicorn leaves open."""

from __future__ import annotations

import asyncio
from http import HTTPStatus
from typing import Any

from uvicorn.protocols.http.auto import AutoHTTPProtocol

MOST_HEAD_BYTES = 65_536
HEAD_WITHIN_S = 20.0
MOST_CONNECTIONS = 500
"""Below the 1024 open files that a process usually may have."""


class BoundedHttp(AutoHTTPProtocol):  # type: ignore[misc, valid-type]  # one of two classes, chosen by uvicorn
    """A connection that is closed when a head is too long, or is not there in time.

    Without it a peer that sends a head byte by byte holds its connection for ever, and one that never ends a
    head fills the memory. Both classes of uvicorn begin a new `cycle` with every head that is complete.
    """

    _timer: asyncio.TimerHandle | None = None
    _head = 0

    def connection_made(self, transport: Any) -> None:
        """Wait for the first head."""
        super().connection_made(transport)
        self._await_head()

    def data_received(self, data: bytes) -> None:
        """Read on; close what is too long."""
        before = self.cycle
        if self._timer is None and (before is None or before.response_complete):
            self._await_head()
        self._head += len(data)
        super().data_received(data)
        if self.cycle is not before:
            self._head_is_there()
        elif self._timer is not None and self._head > MOST_HEAD_BYTES:
            self._refuse(HTTPStatus.REQUEST_HEADER_FIELDS_TOO_LARGE)

    def connection_lost(self, exc: Exception | None) -> None:
        """Wait no more."""
        self._head_is_there()
        super().connection_lost(exc)

    def _await_head(self) -> None:
        """Begin to count and to wait."""
        self._head = 0
        self._timer = self.loop.call_later(HEAD_WITHIN_S, self._refuse, HTTPStatus.REQUEST_TIMEOUT)

    def _head_is_there(self) -> None:
        """Wait no more."""
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _refuse(self, status: HTTPStatus) -> None:
        """Say why, and close."""
        self._head_is_there()
        if not self.transport.is_closing():
            line = f"HTTP/1.1 {status.value} {status.phrase}\r\n"
            self.transport.write(f"{line}Connection: close\r\nContent-Length: 0\r\n\r\n".encode())
            self.transport.close()
