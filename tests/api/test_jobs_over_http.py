"""What the API refuses: a full queue, bodies too long or unusable, paths and methods, in one error shape."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient
from httpx2 import Response
from service_fake_work import SECRET
from service_fakes import EXECUTION, REGISTRY

from service.app import create_app
from service.settings import Settings


@pytest.fixture
def client(tmp_path):
    app = create_app(Settings(data_directory=tmp_path, queue_limit=2, body_limit=5000), REGISTRY)
    with TestClient(app, raise_server_exceptions=False) as found:
        yield found


def execute(client: TestClient, **wish: Any) -> Response:
    return client.post(EXECUTION, json={"inputs": {"wish": wish}})


def assert_problem(answer: Response, status: int) -> dict[str, Any]:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    body: dict[str, Any] = answer.json()
    assert set(body) - {"reference"} == {"type", "title", "status", "detail", "errors"}
    assert body["status"] == status
    for fault in body["errors"]:
        assert set(fault) == {"field", "value", "bound", "suggestion"}
    return body


def test_a_full_queue_answers_429_with_a_time_to_come_back(client):
    answers = [execute(client, mode="hang", number=n) for n in range(5)]
    refused = [answer for answer in answers if answer.status_code != 201]
    assert refused
    for answer in refused:
        assert assert_problem(answer, 429)["type"] == "urn:lineofaction:problem:queue-full"
        assert answer.headers["retry-after"] == "10"
    for answer in answers:
        if answer.status_code == 201:
            client.delete(answer.headers["location"])


def test_a_body_beyond_the_limit_answers_413(client):
    assert (
        assert_problem(execute(client, text="x" * 6000), 413)["type"] == "urn:lineofaction:problem:too-large"
    )


def test_a_body_that_does_not_tell_its_length_is_counted(client):
    pieces: Callable[[], Iterator[bytes]] = lambda: (b"x" * 1000 for _ in range(100))  # noqa: E731
    answer = client.post(EXECUTION, content=pieces(), headers={"Content-Type": "application/json"})
    assert_problem(answer, 413)


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ('{"inputs": {"wish": {"number": NaN}}}', "inputs.wish.number"),
        ('{"inputs": {"wish": {"number": Infinity}}}', "inputs.wish.number"),
        ('{"inputs": {"wish": {"number": 1e999}}}', "inputs.wish.number"),
        ('{"inputs": {"wish": {"number": "1"}}}', "inputs.wish.number"),
        ('{"inputs": {"wish": {"number": 11}}}', "inputs.wish.number"),
        ('{"inputs": {"wish": {"unknown": 1}}}', "inputs.wish.unknown"),
        ('{"inputs": {"wish": {"\\ud800": 1}}}', "inputs.wish"),
        ('{"inputs": {"wish": {"mode": "refuse"}}}', "mode"),
        ('{"inputs": {"wish": []}}', "inputs.wish"),
        ('{"inputs": {}}', "inputs.wish"),
        ('{"inputs": {"wish": {}}, "subscriber": {}}', "subscriber"),
        ("{}", "inputs"),
        ("[]", "body"),
        ("{", "body"),
        ("", "body"),
    ],
)
def test_a_body_that_cannot_be_used_is_one_fault_by_name(client, text, field):
    answer = client.post(EXECUTION, content=text, headers={"Content-Type": "application/json"})
    (fault,) = assert_problem(answer, 422)["errors"]
    assert fault["field"] == field
    assert fault["bound"]


def test_bytes_that_are_no_text_are_a_problem_too(client):
    answer = client.post(EXECUTION, content=b"\xff\xfe\x00", headers={"Content-Type": "application/json"})
    assert_problem(answer, 400)


@pytest.mark.parametrize(
    ("method", "path", "status", "kind"),
    [
        ("GET", f"/v1/results/{'0' * 64}", 404, "urn:lineofaction:problem:not-found"),
        ("GET", "/v1/results/..%2f..%2fetc", 404, "about:blank"),
        ("GET", "/v1/results/ABC", 422, "urn:lineofaction:problem:bad-input"),
        ("GET", "/v1/jobs?limit=0", 422, "urn:lineofaction:problem:bad-input"),
        ("GET", "/nowhere", 404, "about:blank"),
        ("PUT", "/v1/jobs", 405, "about:blank"),
    ],
)
def test_every_refusal_is_a_problem(client, method, path, status, kind):
    assert assert_problem(client.request(method, path), status)["type"] == kind


def test_an_unknown_exception_becomes_a_reference(client, monkeypatch):
    context = client.app.state.context

    def explode(_identifier):
        raise RuntimeError(SECRET)

    monkeypatch.setattr(context.submissions, "find", explode)
    answer = client.get("/v1/jobs/any")
    body = assert_problem(answer, 500)
    assert SECRET not in answer.text
    assert body["reference"] == answer.headers["x-request-id"]
    assert body["reference"] in body["detail"]


def test_a_stopped_scheduler_is_not_ready(tmp_path):
    app = create_app(Settings(data_directory=tmp_path), REGISTRY)
    client = TestClient(app)  # not entered: nothing is started
    assert_problem(client.get("/ready"), 503)
