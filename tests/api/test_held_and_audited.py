"""What a key may hold at the same time, and the line that each access leaves in the log."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import httpx2
import pytest
import structlog.contextvars
import structlog.testing
from fastapi.testclient import TestClient
from running_service import until
from served_app import served
from service_fakes import EXECUTION, REGISTRY, bearing

from lineofaction.gearbox.problems import TooManyHeld, TooManyRequests
from service.access.capacity import Held
from service.access.keyring import KeyFile
from service.app import create_app
from service.settings import Settings


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_directory=tmp_path / "data")


def test_what_is_held_is_counted_by_name_and_given_back() -> None:
    held = Held("streams", in_all=4)
    with held.one("a"), held.one("a"), held.one("b"):
        with pytest.raises(TooManyHeld, match="'a' holds 2 streams, the limit"):
            held.refuse_beyond("a", 2)
        held.refuse_beyond("a", 3)
        held.refuse_beyond("a", None)
        with held.one("c"), pytest.raises(TooManyRequests, match="4 streams in all"):
            held.refuse_beyond("b", None)
    held.refuse_beyond("a", 1)
    assert not held._held, "nothing is kept of who holds nothing"


@pytest.fixture
def at(settings: Settings) -> Iterator[str]:
    """The address of a service behind a socket that works on nothing."""
    KeyFile(settings.key_file).add("first")
    with served(create_app(settings, REGISTRY, works=False)) as port:
        yield f"http://127.0.0.1:{port}"


def test_a_key_holds_as_many_streams_as_it_may_and_leaves_others_theirs(at: str, settings: Settings) -> None:
    file = KeyFile(settings.key_file)
    few, many = bearing(file.add("few", streams=2)), bearing(file.add("many"))
    body = {"inputs": {"wish": {"mode": "hang"}}}
    with httpx2.Client(base_url=at, timeout=60.0) as http, ExitStack() as held:
        events = http.post(EXECUTION, json=body, headers=few).headers["location"] + "/events"

        def listen(who: dict[str, str]) -> ExitStack:
            stream = ExitStack()
            answer = stream.enter_context(http.stream("GET", events, headers=who))
            lines = stream.enter_context(closing(answer.iter_lines()))
            assert answer.status_code == 200 and next(lines)
            return held.enter_context(stream)

        first, _second = listen(few), listen(few)
        refused = http.get(events, headers=few, timeout=5.0)
        assert (refused.status_code, refused.json()["type"]) == (429, TooManyHeld.type)
        assert "'few' holds 2 event streams" in refused.json()["detail"]
        assert int(refused.headers["retry-after"]) >= 1
        listen(many)
        first.close()
        until(lambda: _taken(http, events, few))


def _taken(http: httpx2.Client, events: str, who: dict[str, str]) -> bool:
    with http.stream("GET", events, headers=who) as answer:
        return answer.status_code == 200


def test_a_key_holds_as_many_connections_as_it_may(at: str, settings: Settings) -> None:
    file = KeyFile(settings.key_file)
    one, other = bearing(file.add("one", connections=1)), bearing(file.add("other"))
    body = {"inputs": {"wish": {"mode": "hang"}}}
    with httpx2.Client(base_url=at, timeout=60.0) as http:
        events = http.post(EXECUTION, json=body, headers=one).headers["location"] + "/events"
        with http.stream("GET", events, headers=one) as answer:
            lines = answer.iter_lines()  # the stream ends when nobody holds this
            assert next(lines)
            refused = http.get("/v1/jobs", headers=one)
            assert (refused.status_code, refused.json()["type"]) == (429, TooManyHeld.type)
            assert "'one' holds 1 requests" in refused.json()["detail"]
            assert http.get("/v1/jobs", headers=other).status_code == 200
        until(lambda: http.get("/v1/jobs", headers=one).status_code == 200)


def test_every_access_leaves_a_line_and_none_the_key(settings: Settings) -> None:
    file, kept = KeyFile(settings.key_file), structlog.testing.LogCapture()
    structlog.configure(processors=[structlog.contextvars.merge_contextvars, kept])
    reader = file.add("reader", project="axle", scopes=["read"])
    ended = file.add("ended", expires="1h")
    file.path.write_text(file.path.read_text().replace('"expires": "2', '"expires": "1'))
    with TestClient(create_app(settings, REGISTRY, works=False)) as http:
        job = "00000000-0000-4000-8000-000000000000"
        answers = [
            http.get("/v1/jobs", headers=bearing(reader)),
            http.get(f"/v1/jobs/{job}", headers=bearing(reader)),
            http.post(EXECUTION, json={}, headers=bearing(reader)),
            http.get("/v1/jobs", headers=bearing(ended)),
            http.get(f"/v1/jobs/{reader}", headers=bearing("loa_guessed")),
            http.get("/v1/nowhere"),
        ]
        assert http.get("/health").status_code == 200
    lines = [entry for entry in kept.entries if entry["event"] == "access"]
    fields = ("caller", "project", "scope", "operation", "target", "outcome", "status")
    told: list[Any] = [tuple(line[name] for name in fields) for line in lines]
    assert told == [
        ("reader", "axle", "read", "list_jobs", "GET /v1/jobs", "granted", 200),
        ("reader", "axle", "read", "job_status", f"GET /v1/jobs/{job}", "no-such-job", 404),
        ("reader", "axle", "submit", "fake", f"POST {EXECUTION}", "missing-scope", 403),
        ("ended", "", None, None, "GET /v1/jobs", "key-expired", 401),
        (None, None, None, None, "GET /v1/jobs/(key)", "unauthorised", 401),
        (None, None, None, None, "GET /v1/nowhere", "unauthorised", 401),
    ]
    assert [line["request_id"] for line in lines] == [answer.headers["x-request-id"] for answer in answers]
    assert not any(secret in str(kept.entries) for secret in (reader, ended, "guessed"))


def test_a_key_that_asks_too_often_is_in_the_log_too(settings: Settings) -> None:
    file, kept = KeyFile(settings.key_file), structlog.testing.LogCapture()
    structlog.configure(processors=[structlog.contextvars.merge_contextvars, kept])
    key = bearing(file.add("bench", requests_per_minute=1))
    with TestClient(create_app(settings, REGISTRY, works=False)) as http:
        codes = [http.get("/v1/jobs", headers=key).status_code for _ in range(2)]
    outcomes = [entry["outcome"] for entry in kept.entries if entry["event"] == "access"]
    assert codes == [200, 429]
    assert outcomes == ["granted", "rate-exceeded"]
