"""RateLimit and RateLimit-Policy say what a key may still ask (draft-ietf-httpapi-ratelimit-headers)."""

import re
from collections.abc import Mapping
from contextlib import ExitStack, closing

import httpx2
import pytest
from fastapi.testclient import TestClient
from served_app import served
from service_fakes import EXECUTION, REGISTRY, bearing

from service.access.capacity import RateLimits
from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings

PARAMETER = re.compile(r';([a-z]+)=("[a-z-]+"|[0-9]+)')
ITEM = re.compile(r'"([a-z-]+)"((?:;[a-z]+=(?:"[a-z-]+"|[0-9]+))*)(?:, |$)')
Share = dict[str, dict[str, str]]


def items(field: str) -> Share:
    """Read a list of structured fields whose items are strings with parameters (RFC 9651)."""
    assert ITEM.sub("", field) == "", field
    return {name: dict(PARAMETER.findall(parameters)) for name, parameters in ITEM.findall(field)}


def shares(headers: Mapping[str, str]) -> tuple[Share, Share]:
    return items(headers["ratelimit-policy"]), items(headers["ratelimit"])


@pytest.fixture
def file(tmp_path):
    return KeyFile(Settings(data_directory=tmp_path).key_file)


@pytest.mark.law
def test_a_key_may_ask_as_often_as_it_is_told(tmp_path, file):
    """One that stops when nothing remains is never refused; the refusal says the same."""
    key = bearing(file.add("bench", requests_per_minute=7, connections=3))
    with TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY, works=False)) as http:
        answer = http.get("/v1/processes", headers=key)
        policies, limits = shares(answer.headers)
        assert policies["requests"] == {"q": "7", "w": "60"}
        assert policies["concurrent"] == {"q": "3", "qu": '"concurrent-requests"'}
        assert limits["concurrent"] == {"r": "2"}, "this one is answered"
        for _ in range(int(limits["requests"]["r"])):
            answer = http.get("/v1/nowhere", headers=key)
            assert answer.status_code == 404
        left = shares(answer.headers)[1]["requests"]
        assert (left["r"], 40 < int(left["t"]) <= 60) == ("0", True)
        refused = http.get("/v1/processes", headers=key)
        assert refused.status_code == 429
        assert shares(refused.headers)[1]["requests"]["r"] == "0"
        assert int(refused.headers["retry-after"]) <= int(left["t"])


def test_all_of_a_quota_is_there_again_when_it_says(file):
    instant = 0.0
    limits = RateLimits(clock=lambda: instant)
    file.add("bench", requests_per_minute=7)
    (holder,) = file.read()
    while limits.wait_s(holder) == 0:
        pass
    spent = limits.quota(holder)
    assert spent is not None and spent.left == 0 and spent.full_s is not None
    instant += spent.full_s - 2.0
    before = limits.quota(holder)
    instant += 2.0
    after = limits.quota(holder)
    assert (before.left, after.left) == (6, 7)


def test_requests_under_way_count_against_the_share_of_their_key(tmp_path, file):
    one, other = (bearing(file.add(name, connections=3)) for name in ("one", "other"))
    app = create_app(Settings(data_directory=tmp_path), REGISTRY, works=False)
    with ExitStack() as stack:
        address = f"http://127.0.0.1:{stack.enter_context(served(app))}"
        http = stack.enter_context(httpx2.Client(base_url=address, timeout=60.0))
        body = {"inputs": {"wish": {"mode": "hang"}}}
        events = http.post(EXECUTION, json=body, headers=one).headers["location"] + "/events"
        for _ in range(2):
            stream = stack.enter_context(http.stream("GET", events, headers=one))
            assert next(stack.enter_context(closing(stream.iter_lines())))
        assert shares(http.get("/v1/processes", headers=one).headers)[1] == {"concurrent": {"r": "0"}}
        assert shares(http.get("/v1/processes", headers=other).headers)[1] == {"concurrent": {"r": "2"}}


def test_who_has_no_share_is_told_of_none(tmp_path):
    with TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY, works=False)) as http:
        for path in ("/v1/processes", "/health", "/v1/nowhere"):
            assert not {"ratelimit", "ratelimit-policy"} & set(http.get(path).headers)
