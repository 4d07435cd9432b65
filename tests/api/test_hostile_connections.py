"""Connections that drip, or send what never ends, to the server as `loa serve` sets it up."""

import http.client
import socket
import threading
import time

import pytest
import uvicorn
from killed_service import KilledService
from running_service import PATIENCE_S, until
from service_fakes import REGISTRY

from lineofaction.cli import connections
from lineofaction.cli.connections import BoundedHttp
from service.access.capacity import Capacity
from service.app import create_app
from service.routes import middleware
from service.settings import Settings

POST = b"POST /v1/cases/from-toml HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\n"
WHOLE = b"GET /health HTTP/1.1\r\nHost: localhost\r\n\r\n"


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    with socket.create_server(("127.0.0.1", 0)) as listener:
        app = create_app(
            Settings(data_directory=tmp_path_factory.mktemp("drip"), body_limit=100_000), REGISTRY
        )
        server = uvicorn.Server(uvicorn.Config(app, http=BoundedHttp, log_config=None, lifespan="off"))
        thread = threading.Thread(target=server.run, kwargs={"sockets": [listener]})
        thread.start()
        until(lambda: server.started)
        yield server
        server.should_exit = True
        thread.join()


@pytest.fixture
def port(server):
    """Where it listens, once it has noticed that the connections of other tests are closed."""
    until(lambda: not server.server_state.connections)
    return int(server.servers[0].sockets[0].getsockname()[1])


def answered(port: int, *pieces: bytes) -> bytes:
    """Send pieces and return all that comes until the other side closes."""
    found = b""
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as connection:
        try:
            for piece in pieces:
                connection.sendall(piece)
            while content := connection.recv(65536):
                found += content
        except (ConnectionResetError, BrokenPipeError):
            pass  # closed while we were still sending
    return found


def test_a_head_that_does_not_end_is_not_waited_for(port, monkeypatch):
    monkeypatch.setattr(connections, "HEAD_WITHIN_S", 0.5)
    for begun in (b"", b"GET /health HTT", WHOLE[:-2]):
        assert answered(port, begun).startswith(b"HTTP/1.1 408 ")


def test_nor_is_that_of_a_later_request(port, monkeypatch):
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as connection:
        connection.sendall(WHOLE)
        found = b""
        while not found.endswith(b'{"status":"ok"}'):
            found += connection.recv(65536)
        monkeypatch.setattr(connections, "HEAD_WITHIN_S", 0.5)
        connection.sendall(WHOLE[:-2])
        assert connection.recv(65536).startswith(b"HTTP/1.1 408 ")
        assert connection.recv(65536) == b""


@pytest.mark.parametrize("piece", [b"X-Long: " + b"a" * 200_000, b"X-Many: a\r\n" * 20_000])
def test_a_head_that_is_too_long_is_not_read(port, piece):
    assert answered(port, WHOLE[:-2], piece)[:13] in (b"HTTP/1.1 431 ", b"HTTP/1.1 400 ", b"")


def test_a_body_that_does_not_come_is_not_waited_for(port, monkeypatch):
    monkeypatch.setattr(middleware, "PATIENCE_S", 0.5)
    answer = answered(port, POST + b"Content-Length: 1000\r\n\r\n", b"{")
    assert answer.startswith(b"HTTP/1.1 408 ") and b"urn:lineofaction:problem:too-slow" in answer


def test_a_body_in_pieces_is_read_up_to_the_limit(port):
    def chunk(content):
        return b"%x\r\n%s\r\n" % (len(content), content)

    head = POST + b"Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n"
    longer = answered(port, head, *(chunk(b" " * 20_000) for _ in range(8)))
    assert longer.startswith(b"HTTP/1.1 413 ") or longer == b""
    whole = answered(port, head, chunk(b'{"toml": '), chunk(b'""}'), chunk(b""))
    assert whole.startswith(b"HTTP/1.1 422 ") and b"pair" in whole


def test_a_caller_in_time_is_answered_again_and_again_on_a_connection(port):
    closing = WHOLE[:-2] + b"Connection: close\r\n\r\n"
    assert answered(port, WHOLE, WHOLE, closing).count(b'{"status":"ok"}') == 3


def test_where_every_connection_is_busy_one_more_is_told_so(port, server, monkeypatch):
    monkeypatch.setitem(server.config.app.state._state, "capacity", Capacity(1))
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as busy:
        busy.sendall(POST + b"Expect: 100-continue\r\nContent-Length: 1000\r\n\r\n")
        assert busy.recv(65536).startswith(b"HTTP/1.1 100 ")  # the request is under way
        answer = answered(port)
    assert answer.startswith(b"HTTP/1.1 503 ") and b"retry-after: 1\r\n" in answer.lower()
    assert b"urn:lineofaction:problem:too-many-requests" in answer


def test_an_idle_connection_makes_room_for_another(port, server, monkeypatch):
    monkeypatch.setitem(server.config.app.state._state, "capacity", Capacity(1))
    closing = WHOLE[:-2] + b"Connection: close\r\n\r\n"
    with socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as idle:
        assert b'{"status":"ok"}' in answered(port, closing)
        assert idle.recv(65536) == b""


# Idle connections: kept for longer than callers and proxies keep them.


CLIENTS_KEEP_S = 5.0  # the default of our client's library


def test_an_idle_connection_is_closed_by_the_caller_not_under_its_request(tmp_path):
    with KilledService(tmp_path, {}) as service:
        service.request("GET", "/health")
        connection = http.client.HTTPConnection(service.address.removeprefix("http://"), timeout=PATIENCE_S)
        for pause in (0.0, 1.4 * CLIENTS_KEEP_S):
            time.sleep(pause)
            connection.request("GET", "/health")
            answer = connection.getresponse()
            assert (answer.status, answer.read()) == (200, b'{"status":"ok"}')
        assert service.stop() == 0
        connection.close()
