"""A load of force queries from one process without threads, which itself takes little of the machine.

``python -m benchmarks.query_load PORT KEY CALLERS SECONDS`` asks one point after the other on each of its
kept connections, and prints JSON: `latency_s` of each answer, `elapsed_s`, and its own CPU time `cpu_s`.
"""

from __future__ import annotations

import json
import selectors
import socket
import sys
import time
from dataclasses import dataclass

BODY = b'{"position": [0.3], "deflection_um": [5.0]}'


@dataclass
class _Caller:
    """A connection: what of its answer has arrived, and when it asked."""

    socket: socket.socket
    request: bytes
    begun: float = 0.0
    piece: bytes = b""

    def ask(self) -> None:
        """Send the query."""
        self.begun, self.piece = time.perf_counter(), b""
        self.socket.sendall(self.request)

    def answered(self) -> bool:
        """Read what is there; whether the answer is whole."""
        self.piece += self.socket.recv(65536)
        head, separator, body = self.piece.partition(b"\r\n\r\n")
        if not separator:
            return False
        if not head.startswith(b"HTTP/1.1 200 "):
            raise RuntimeError(f"the service answered {self.piece[:500]!r}")
        return len(body) == int(head.lower().partition(b"content-length: ")[2].split(b"\r\n")[0])


def main(port: int, key: str, callers: int, seconds: float) -> None:
    """Ask, and print what was measured."""
    head = f"POST /v1/databases/{key}/query HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n"
    head += f"Content-Type: application/json\r\nContent-Length: {len(BODY)}\r\n\r\n"
    selector, taken = selectors.DefaultSelector(), list[float]()
    begin, cpu = time.perf_counter(), time.process_time()
    for _ in range(callers):
        connection = socket.create_connection(("127.0.0.1", port))
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        caller = _Caller(connection, head.encode() + BODY)
        caller.ask()
        selector.register(connection, selectors.EVENT_READ, caller)
    while time.perf_counter() < begin + seconds:
        for ready, _ in selector.select(1.0):
            if ready.data.answered():
                taken.append(time.perf_counter() - ready.data.begun)
                ready.data.ask()
    elapsed, cpu = time.perf_counter() - begin, time.process_time() - cpu
    print(json.dumps({"latency_s": taken, "elapsed_s": elapsed, "cpu_s": cpu}))


if __name__ == "__main__":
    main(int(sys.argv[1]), sys.argv[2], int(sys.argv[3]), float(sys.argv[4]))
