"""A service with keys: nothing without one, nothing about one in what it says."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
import structlog.contextvars
import structlog.testing
from fastapi.testclient import TestClient
from httpx2 import Response
from service_fakes import EXECUTION, REGISTRY, bearing

from lineofaction.client import LineOfActionClient
from lineofaction.gearbox.problems import RateExceeded, Unauthorised
from service.access.keyring import KeyFile
from service.app import create_app
from service.settings import Settings


@pytest.fixture
def settings(tmp_path: Path) -> Settings:
    return Settings(data_directory=tmp_path / "data")


@pytest.fixture
def secret(settings: Settings) -> str:
    return KeyFile(settings.key_file).add("bench", requests_per_minute=50)


@pytest.fixture
def http(settings: Settings, secret: str) -> Iterator[TestClient]:
    with TestClient(create_app(settings, REGISTRY), raise_server_exceptions=False) as found:
        yield found


def test_every_path_but_health_readiness_and_the_page_asks_for_a_key(http: TestClient) -> None:
    paths = {
        (method, path.replace("{", "").replace("}", ""))
        for path, methods in http.app.openapi()["paths"].items()  # type: ignore[attr-defined]
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
def test_what_is_no_key_is_not_taken_for_one(http: TestClient, secret: str, value: str) -> None:
    answer = http.get("/v1/jobs", headers={"Authorization": value.replace("{}", secret).encode("latin-1")})
    assert answer.status_code == 401
    assert secret not in answer.text


def test_the_scheme_may_be_written_in_any_case(http: TestClient, secret: str) -> None:
    for scheme in ("Bearer", "bearer", "BEARER"):
        assert http.get("/v1/jobs", headers={"Authorization": f"{scheme} {secret}"}).status_code == 200


def test_taking_the_last_key_back_opens_nothing(http: TestClient, settings: Settings, secret: str) -> None:
    assert http.get("/v1/jobs", headers=bearing(secret)).status_code == 200
    KeyFile(settings.key_file).remove("bench")
    assert http.get("/v1/jobs", headers=bearing(secret)).status_code == 401
    assert http.get("/v1/jobs").status_code == 401
    settings.key_file.unlink()
    assert http.get("/v1/jobs").status_code == 401


def test_the_first_key_shuts_a_service_that_was_open(settings: Settings) -> None:
    with TestClient(create_app(settings, REGISTRY)) as http:
        assert http.get("/v1/jobs").status_code == 200
        secret = KeyFile(settings.key_file).add("late")
        assert http.get("/v1/jobs").status_code == 401
        assert http.get("/v1/jobs", headers=bearing(secret)).status_code == 200


def test_beyond_its_rate_a_key_is_told_when_to_come_again(http: TestClient, secret: str) -> None:
    codes = [http.get("/v1/processes", headers=bearing(secret)).status_code for _ in range(60)]
    assert codes[:50] == [200] * 50
    assert 429 in codes
    answer = http.get("/v1/processes", headers=bearing(secret))
    assert answer.json()["type"] == RateExceeded.type
    assert 1 <= int(answer.headers["retry-after"]) <= 2


def test_the_log_names_the_key_and_never_holds_it(settings: Settings, secret: str) -> None:
    kept = structlog.testing.LogCapture()
    structlog.configure(processors=[structlog.contextvars.merge_contextvars, kept])
    with TestClient(create_app(settings, REGISTRY)) as http:
        named = http.get("/v1/jobs", headers=bearing(secret))
        unknown = http.get("/v1/jobs", headers=bearing("loa_guessed"))
    lines = [entry for entry in kept.entries if entry["event"] == "request"]
    assert [entry.get("caller") for entry in lines] == ["bench", None]
    assert [entry["request_id"] for entry in lines] == [a.headers["x-request-id"] for a in (named, unknown)]
    assert secret not in str(kept.entries) and "guessed" not in str(kept.entries)


def test_the_client_takes_its_key_from_its_caller_or_the_environment(
    http: TestClient, secret: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def client(key: str | None) -> LineOfActionClient:
        return LineOfActionClient("http://testserver", cache_dir=tmp_path, transport=http._transport, key=key)

    with client(None) as without, pytest.raises(Unauthorised, match="Authorization"):
        without.submit("fake", {"wish": {}})
    with client(secret) as given:
        assert given.submit("fake", {"wish": {"text": "table"}}).process == "fake"
    monkeypatch.setenv("LOA_KEY", secret)
    with client(None) as found:
        assert found.submit("fake", {"wish": {"text": "table"}}).process == "fake"


def test_a_key_has_as_many_unfinished_jobs_as_it_may_and_leaves_room_for_others(settings: Settings) -> None:
    file = KeyFile(settings.key_file)
    few, many = bearing(file.add("few", unfinished_jobs=2)), bearing(file.add("many"))

    def enter(number: float, who: dict[str, str]) -> Response:
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
