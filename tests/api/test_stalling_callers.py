"""Callers that begin many requests and end none, beside one that has a small question."""

import select
import socket
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

import httpx2
import pytest
from running_service import PATIENCE_S
from served_app import served
from service_fakes import EXECUTION, REGISTRY

from service.access.capacity import Capacity
from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings

BODY = {"inputs": {"wish": {"text": "small"}}}
ATTACKERS = 420
"""More than the requests that one server process answers at once."""


@pytest.fixture
def settings(tmp_path):
    return Settings(data_directory=tmp_path / "data")


def begun(port: int, key: str, *fields: str) -> socket.socket:
    """Begin a request: its head, with further fields, and ten bytes of its body."""
    connection = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
    own = ("Host: localhost", "Content-Type: application/json", "Content-Length: 1000")
    head = (f"POST {EXECUTION} HTTP/1.1", *own, f"Authorization: Bearer {key}", *fields)
    connection.sendall(("\r\n".join(head) + f"\r\n\r\n{'{':<10}").encode())
    return connection


def client(port: int) -> httpx2.Client:
    return httpx2.Client(base_url=f"http://127.0.0.1:{port}", timeout=PATIENCE_S)


@contextmanager
def check_stalled(port: int, key: str, number: int, held: int, status: bytes) -> Iterator[None]:
    """Begin so many requests; wait until so many of them are held, and the others refused with a status."""
    with ExitStack() as stack:
        connections = [stack.enter_context(begun(port, key)) for _ in range(number)]
        answers: Counter[bytes] = Counter()
        for _ in range(number - held):
            ready, _, _ = select.select(connections, [], [], PATIENCE_S)
            connections.remove(ready[0])
            answers[ready[0].recv(65536)[9:12]] += 1
        assert answers == {status: number - held}
        assert select.select(connections, [], [], 0.0)[0] == [], "the others wait for their bodies"
        yield


def test_a_key_that_ends_no_body_leaves_the_others_theirs(settings):
    """It was 503 for everybody for 30 s."""
    file = KeyFile(settings.key_file)
    slow, other = file.add("slow"), {"Authorization": f"Bearer {file.add('other')}"}
    app = create_app(settings, REGISTRY, works=False)
    with (
        served(app) as port,
        check_stalled(port, slow, ATTACKERS, Capacity().share, b"429"),
        client(port) as http,
    ):
        assert http.get("/v1/jobs", headers=other).status_code == 200
        assert http.post(EXECUTION, json=BODY, headers=other).status_code == 201
        mine = {"Authorization": f"Bearer {slow}"}
        assert http.get("/v1/jobs", headers=mine).status_code == 200, "its bodies are no requests yet"


@pytest.mark.law
def test_bodies_that_do_not_end_take_no_place_of_requests_without_keys(settings):
    """All callers are one; what carries no body is answered."""
    app = create_app(settings, REGISTRY, works=False)
    maximum = Capacity().requests
    with served(app) as port, check_stalled(port, "none", ATTACKERS, maximum, b"503"), client(port) as http:
        assert http.get("/v1/jobs").status_code == 200
        refused = http.post(EXECUTION, json=BODY)
        assert refused.status_code == 503 and "bodies under way" in refused.json()["detail"]


def test_a_limit_of_the_key_takes_the_place_of_the_share(settings):
    file = KeyFile(settings.key_file)
    app, key = create_app(settings, REGISTRY, works=False), file.add("few", connections=3)
    with served(app) as port, check_stalled(port, key, 5, 3, b"429"):
        pass


def test_a_body_that_came_gives_its_place_back(settings):
    key = KeyFile(settings.key_file).add("one", connections=1)
    app = create_app(settings, REGISTRY, works=False)
    with served(app) as port, client(port) as http:
        http.headers["Authorization"] = f"Bearer {key}"
        for _ in range(3):
            assert http.post(EXECUTION, json=BODY).status_code == 201
        with begun(port, key, "Expect: 100-continue") as slow:
            assert slow.recv(65536).startswith(b"HTTP/1.1 100 ")  # it has its place
            assert http.post(EXECUTION, json=BODY).status_code == 429
            assert http.get("/v1/jobs").status_code == 200
            slow.sendall(b" " * 990)
            assert slow.recv(65536).startswith(b"HTTP/1.1 422 ")
        assert http.post(EXECUTION, json=BODY).status_code == 201
