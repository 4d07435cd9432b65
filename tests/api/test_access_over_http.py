"""A service with keys: nothing without one, nothing about one in what it says."""

from contextlib import ExitStack, closing
from typing import Any

import httpx2
import pytest
import structlog.contextvars
import structlog.testing
from fastapi.testclient import TestClient
from running_service import until
from served_app import served
from service_fakes import EXECUTION, REGISTRY, bearing

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.problems import RateExceeded, TooManyHeld, TooManyRequests, Unauthorised
from service.access.capacity import Usage
from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings


@pytest.fixture
def settings(tmp_path):
    return Settings(data_directory=tmp_path / "data")


@pytest.fixture
def secret(settings):
    return KeyFile(settings.key_file).add("bench", requests_per_minute=50)


@pytest.fixture
def http(settings, secret):
    with TestClient(create_app(settings, REGISTRY), raise_server_exceptions=False) as found:
        yield found


def test_every_path_but_health_readiness_and_the_page_asks_for_a_key(http):
    paths = {
        (method, path.replace("{", "").replace("}", ""))
        for path, methods in http.app.openapi()["paths"].items()
        for method in methods
    }
    paths |= {("get", f"/{name}") for name in ("openapi.json", "nowhere", "health/", "pages", "page")}
    assert len(paths) > 25
    for method, path in sorted(paths - {("get", "/health"), ("get", "/ready")}):
        answer = http.request(method, path)
        assert answer.status_code == 401, (method, path)
        assert answer.headers["www-authenticate"] == "Bearer"
        assert answer.headers["content-type"] == "application/problem+json"
        assert "x-request-id" in answer.headers
    assert [http.get(path).status_code for path in ("/health", "/ready", "/", "/page/api.js")] == [200] * 4


@pytest.mark.parametrize(
    "value", ["", "Bearer", "Bearer ", "Basic {}", "{}", "Bearer {}x", "Bearer \xff", "Bearer a,b"]
)
def test_what_is_no_key_is_not_taken_for_one(http, secret, value):
    answer = http.get("/v1/jobs", headers={"Authorization": value.replace("{}", secret).encode("latin-1")})
    assert answer.status_code == 401
    assert secret not in answer.text


def test_the_scheme_may_be_written_in_any_case(http, secret):
    for scheme in ("Bearer", "bearer", "BEARER"):
        assert http.get("/v1/jobs", headers={"Authorization": f"{scheme} {secret}"}).status_code == 200


def test_taking_the_last_key_back_opens_nothing(http, settings, secret):
    assert http.get("/v1/jobs", headers=bearing(secret)).status_code == 200
    KeyFile(settings.key_file).remove("bench")
    assert http.get("/v1/jobs", headers=bearing(secret)).status_code == 401
    assert http.get("/v1/jobs").status_code == 401
    settings.key_file.unlink()
    assert http.get("/v1/jobs").status_code == 401


def test_the_first_key_shuts_a_service_that_was_open(settings):
    with TestClient(create_app(settings, REGISTRY)) as http:
        assert http.get("/v1/jobs").status_code == 200
        secret = KeyFile(settings.key_file).add("late")
        assert http.get("/v1/jobs").status_code == 401
        assert http.get("/v1/jobs", headers=bearing(secret)).status_code == 200


def test_beyond_its_rate_a_key_is_told_when_to_come_again(http, secret):
    codes = [http.get("/v1/processes", headers=bearing(secret)).status_code for _ in range(60)]
    assert codes[:50] == [200] * 50
    assert 429 in codes
    answer = http.get("/v1/processes", headers=bearing(secret))
    assert answer.json()["type"] == RateExceeded.type
    assert 1 <= int(answer.headers["retry-after"]) <= 2


def test_the_log_names_the_key_and_never_holds_it(settings, secret):
    kept = structlog.testing.LogCapture()
    structlog.configure(processors=[structlog.contextvars.merge_contextvars, kept])
    with TestClient(create_app(settings, REGISTRY)) as http:
        named = http.get("/v1/jobs", headers=bearing(secret))
        unknown = http.get("/v1/jobs", headers=bearing("loa_guessed"))
    lines = [entry for entry in kept.entries if entry["event"] == "request"]
    assert [entry.get("caller") for entry in lines] == ["bench", None]
    assert [entry["request_id"] for entry in lines] == [a.headers["x-request-id"] for a in (named, unknown)]
    assert secret not in str(kept.entries) and "guessed" not in str(kept.entries)


def test_the_client_takes_its_key_from_its_caller_or_the_environment(http, secret, tmp_path, monkeypatch):
    def client(key):
        return LineOfActionClient("http://testserver", cache_dir=tmp_path, transport=http._transport, key=key)

    with client(None) as without, pytest.raises(Unauthorised, match="Authorization"):
        without.submit("fake", {"wish": {}})
    with client(secret) as given:
        assert given.submit("fake", {"wish": {"text": "table"}}).process == "fake"
    monkeypatch.setenv("LOA_KEY", secret)
    with client(None) as found:
        assert found.submit("fake", {"wish": {"text": "table"}}).process == "fake"


def test_a_key_has_as_many_unfinished_jobs_as_it_may_and_leaves_room_for_others(settings):
    file = KeyFile(settings.key_file)
    few, many = bearing(file.add("few", unfinished_jobs=2)), bearing(file.add("many"))

    def enter(number, who):
        wish = {"mode": "hang", "number": number}
        return http.post(EXECUTION, json={"inputs": {"wish": wish}}, headers=who)

    with TestClient(create_app(settings, REGISTRY), raise_server_exceptions=False) as http:
        first, second = enter(1.0, few), enter(2.0, few)
        refused = enter(3.0, few)
        assert [a.status_code for a in (first, second, refused)] == [201, 201, 429]
        assert "'few' has 2 unfinished jobs" in refused.json()["detail"]
        assert refused.headers["retry-after"]
        assert enter(1.0, few).status_code == 429, "shared work is a job of its own"
        assert enter(3.0, many).status_code == 201
        assert http.delete(second.headers["location"], headers=few).status_code == 200
        for number in (3.0, 4.0):  # the first is work that another key shares, and goes on
            entered = enter(number, few)
            assert entered.status_code == 201, "what is dismissed makes room"
            http.delete(entered.headers["location"], headers=few)


# What a key may hold at the same time, and the line that each access leaves in the log.


def test_what_is_held_is_counted_by_name_and_given_back():
    held = Usage("streams", in_all=4)
    with held.one("a"), held.one("a"), held.one("b"):
        with pytest.raises(TooManyHeld, match="'a' holds 2 streams, the limit"):
            held.refuse_beyond("a", 2)
        held.refuse_beyond("a", 3)
        held.refuse_beyond("a", None)
        with held.one("c"), pytest.raises(TooManyRequests, match="4 streams in all"):
            held.refuse_beyond("b", None)
    held.refuse_beyond("a", 1)
    assert not held._counts, "nothing is kept of who holds nothing"


@pytest.fixture
def at(settings):
    """The address of a service behind a socket that works on nothing."""
    KeyFile(settings.key_file).add("first")
    with served(create_app(settings, REGISTRY, works=False)) as port:
        yield f"http://127.0.0.1:{port}"


def test_a_key_holds_as_many_streams_as_it_may_and_leaves_others_theirs(at, settings):
    file = KeyFile(settings.key_file)
    few, many = bearing(file.add("few", streams=2)), bearing(file.add("many"))
    body = {"inputs": {"wish": {"mode": "hang"}}}
    with httpx2.Client(base_url=at, timeout=60.0) as http, ExitStack() as held:
        events = http.post(EXECUTION, json=body, headers=few).headers["location"] + "/events"

        def listen(who):
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


def test_a_key_holds_as_many_connections_as_it_may(at, settings):
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


def test_every_access_leaves_a_line_and_none_the_key(settings):
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


def test_a_key_that_asks_too_often_is_in_the_log_too(settings):
    file, kept = KeyFile(settings.key_file), structlog.testing.LogCapture()
    structlog.configure(processors=[structlog.contextvars.merge_contextvars, kept])
    key = bearing(file.add("bench", requests_per_minute=1))
    with TestClient(create_app(settings, REGISTRY, works=False)) as http:
        codes = [http.get("/v1/jobs", headers=key).status_code for _ in range(2)]
    outcomes = [entry["outcome"] for entry in kept.entries if entry["event"] == "access"]
    assert codes == [200, 429]
    assert outcomes == ["granted", "rate-exceeded"]
