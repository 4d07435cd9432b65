"""Webhooks: who is called, what is told, in which order, how often; and who is never called."""

import base64
import hashlib
import hmac
import json
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest
from fastapi.testclient import TestClient
from killed_service import KilledService
from running_service import until
from service_fakes import EXECUTION, REGISTRY

from service.app import create_app
from service.settings import Settings
from service.webhooks import calls, deliverer, requests

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


@pytest.fixture(autouse=True)
def quickly(monkeypatch):
    monkeypatch.setattr(calls, "FIRST_PAUSE_S", 0.05)
    monkeypatch.setattr(calls, "MAX_ATTEMPTS", 3)
    monkeypatch.setattr(deliverer, "LOOK_S", 0.1)
    monkeypatch.setattr(requests, "TOTAL_S", 1.0)


@pytest.fixture
def listener():
    with receiver() as found:
        yield found


@pytest.fixture
def http(tmp_path, listener):
    """A running app that may call the receiver by its address, and by a name."""
    origins = f"{listener.origin}, http://localhost:{listener.server_port}"
    settings = Settings(data_directory=tmp_path, webhook_origins=origins, webhook_secret=SECRET)
    with TestClient(create_app(settings, REGISTRY)) as found:
        yield found


def submitted(http: TestClient, wish: dict[str, Any], **subscriber: str) -> str:
    body = {"inputs": {"wish": wish}, "subscriber": {f"{name}Uri": uri for name, uri in subscriber.items()}}
    answer = http.post(EXECUTION, json=body)
    assert answer.status_code == 201, answer.text
    location: str = answer.headers["location"]
    return location


def settled(http: TestClient, location: str) -> dict[str, tuple[str, int, str]]:
    """Wait until no call about a job waits; return state, attempts and message by event."""
    found: dict[str, tuple[str, int, str]] = {}

    def over():
        entries = http.get(location).json()["webhooks"]
        found.update({e["event"]: (e["state"], e["attempts"], e["message"]) for e in entries})
        return all(state != "waiting" for state, _, _ in found.values())

    until(over)
    return found


def test_calls_are_made_in_order_and_signed(http, listener):
    uris = {name: f"{listener.origin}/{name}?x=1" for name in ("inProgress", "success", "failed")}
    location = submitted(http, {"mode": "hang"}, **uris)
    until(lambda: len(listener.requests) == 1)
    http.delete(location)
    ends = settled(http, location)
    assert ends["inProgress"] == ends["failed"] == ("delivered", 1, "answered 204.")
    assert ends["success"] == ("skipped", 0, "")
    assert listener.paths() == ["/inProgress?x=1", "/failed?x=1"]
    assert all(request.signed for request in listener.requests)
    assert len({request.headers["webhook-id"] for request in listener.requests}) == 2
    progress = listener.requests[0].json
    assert (progress["jobID"], progress["status"]) == (location.rpartition("/")[2], "running")


def test_a_success_is_told_as_the_document_of_the_results(http, listener):
    location = submitted(http, {"text": "told"}, success=f"{listener.origin}/success")
    assert settled(http, location)["success"][0] == "delivered"
    (success,) = listener.requests
    assert success.signed and success.headers["content-type"] == "application/json"
    assert success.headers["webhook-id"] == f"{location.rpartition('/')[2]}_success"
    assert abs(int(success.headers["webhook-timestamp"]) - time.time()) < 100
    assert success.json == http.get(f"{location}/results", params={"response": "document"}).json()


def test_a_failure_and_a_dismissal_are_told_as_problems(http, listener):
    failed = submitted(http, {"mode": "mesh"}, failed=f"{listener.origin}/a", success=f"{listener.origin}/b")
    assert settled(http, failed)["failed"][0] == "delivered"
    dismissed = submitted(http, {"mode": "hang"}, failed=f"{listener.origin}/c")
    http.delete(dismissed)
    assert settled(http, dismissed)["failed"][0] == "delivered"
    assert [request.json["status"] for request in listener.requests] == [500, 410]
    assert "negative Jacobian" in listener.requests[0].json["detail"]


def test_a_batch_is_told_as_a_whole(http, listener):
    jobs = [{"wish": {"text": text}} for text in "ab"]
    uri = {"successUri": f"{listener.origin}/batch"}
    answer = http.post("/v1/batches", json={"process": "fake", "jobs": jobs, "subscriber": uri})
    assert settled(http, answer.headers["location"])["success"][0] == "delivered"
    (request,) = listener.requests
    assert [entry["status"] for entry in request.json["jobs"]] == ["successful"] * 2


def test_what_is_not_taken_is_sent_again_under_the_same_identifier(http, listener):
    listener.refusals = 2
    taken = submitted(http, {"text": "a"}, success=f"{listener.origin}/refuse")
    assert settled(http, taken)["success"] == ("delivered", 3, "answered 204.")
    assert len({request.headers["webhook-id"] for request in listener.requests}) == 1
    assert all(request.signed for request in listener.requests) and len(listener.requests) == 3
    listener.refusals = 100
    never = submitted(http, {"text": "b"}, success=f"{listener.origin}/refuse")
    assert settled(http, never)["success"] == ("given up", 3, "answered 503, not taken.")
    gone = submitted(http, {"text": "c"}, success=f"{listener.origin}/gone")
    assert settled(http, gone)["success"] == ("given up", 1, "answered 410, not taken.")


@pytest.mark.parametrize("path", ["/hang", "/drip"])
def test_a_receiver_that_takes_too_long_is_left(http, listener, path):
    location = submitted(http, {"text": "a"}, success=f"{listener.origin}{path}")
    state, attempts, message = settled(http, location)["success"]
    assert (state, attempts) == ("given up", 3) and message.startswith("no answer")
    assert http.get(location).json()["status"] == "successful"


def test_redirects_are_not_followed(http, listener):
    location = submitted(http, {"text": "a"}, success=f"{listener.origin}/redirect")
    assert settled(http, location)["success"] == ("given up", 3, "answered 302, redirects are not followed.")
    assert set(listener.paths()) == {"/redirect"}


def test_a_name_of_this_machine_is_not_called(http, listener):
    location = submitted(http, {"text": "a"}, success=f"http://localhost:{listener.server_port}/name")
    state, attempts, message = settled(http, location)["success"]
    assert (state, attempts) == ("given up", 3) and "no public address" in message
    assert listener.requests == []


@pytest.mark.parametrize(
    "uri",
    [
        "http://127.0.0.1:1/",
        "https://hooks.example.com/",
        "ftp://127.0.0.1/",
        "http://user@{host}/",
        "http://{host}/#part",
        "http://{host}/a b",
        "http://{host}\\@evil.example/",
        "http://{host}/\r\nX: y",
        "nothing",
        "",
    ],
)
def test_what_is_not_listed_is_refused_by_name(http, listener, uri):
    text = uri.replace("{host}", listener.origin.removeprefix("http://"))
    body = {"inputs": {"wish": {}}, "subscriber": {"successUri": text}}
    answer = http.post(EXECUTION, json=body)
    assert (answer.status_code, answer.json()["errors"][0]["field"]) == (422, "subscriber.successUri")
    assert http.get("/v1/jobs").json()["jobs"] == [] and listener.requests == []


@pytest.mark.nightly  # it waits for the call to time out
def test_a_call_that_a_killed_service_was_making_is_made_again(tmp_path, listener):
    """kill -9 while the receiver holds the request: its lease ends, and it is sent again."""
    settings = {"LOA_WEBHOOK_ORIGINS": listener.origin, "LOA_WEBHOOK_SECRET": SECRET}
    with KilledService(tmp_path, settings) as service:
        body = {"inputs": {"wish": {"text": "a"}}, "subscriber": {"successUri": f"{listener.origin}/hang"}}
        location = service.request("POST", EXECUTION, json=body).headers["location"]
        until(lambda: len(listener.requests) == 1)
        service.kill()
        listener.released.set()
        until(lambda: len(listener.requests) == 2)
        first, again = listener.requests
        assert first.headers["webhook-id"] == again.headers["webhook-id"] and again.signed
        until(lambda: service.request("GET", location).json()["webhooks"][0]["state"] == "delivered")
        assert service.request("GET", location).json()["webhooks"][0]["attempts"] == 2
        assert service.stop() == 0
