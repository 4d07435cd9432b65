"""Whatever is wrong with a request, to whichever route: one error shape, its status documented."""

import tempfile
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from service_fakes import REGISTRY

from service.app import create_app
from service.schemas.examples import BODIES
from service.settings import Settings

_directory = tempfile.TemporaryDirectory(prefix="loa-problems-")
_app = create_app(Settings(data_directory=Path(_directory.name), body_limit=2000), REGISTRY)
DOCUMENT: dict[str, Any] = _app.openapi()
ROUTES = [(method.upper(), path) for path, methods in DOCUMENT["paths"].items() for method in methods]
REFUSED = {
    int(status): DOCUMENT["components"]["responses"][response["$ref"].rpartition("/")[2]]
    for methods in DOCUMENT["paths"].values()
    for operation in methods.values()
    for status, response in operation["responses"].items()
    if "$ref" in response
}
NAMES = {"{key}": "0" * 64, "{job_id}": "nothing", "{process_id}": "nothing"}
WRONG_BODIES: dict[str, tuple[bytes, dict[str, str]]] = {
    "no JSON": (b"{", {"Content-Type": "application/json"}),
    "no text": (b"\xff\xfe", {"Content-Type": "application/json"}),
    "a list": (b"[]", {"Content-Type": "application/json"}),
    "empty": (b"", {"Content-Type": "application/json"}),
    "unknown field": (b'{"nothing": 1}', {"Content-Type": "application/json"}),
    "deep": (b'{"inputs":' * 150 + b"1" + b"}" * 150, {"Content-Type": "application/json"}),
    "other type": (b"a=1", {"Content-Type": "application/x-www-form-urlencoded"}),
    "too long": (b" " * 3000, {"Content-Type": "application/json"}),
}
DRAFTS, OF_FIELDS = "/v1/drafts/", ("unknown field", "deep")
"""Where what is wrong with fields is an answer, and the bodies that are wrong so."""


@pytest.fixture(scope="module")
def client():
    yield TestClient(_app, raise_server_exceptions=False)


def named(path: str, names: dict[str, str] = NAMES) -> str:
    """Return a path with values in place of its parameters."""
    for parameter, value in names.items():
        path = path.replace(parameter, value)
    return path


def assert_problem(answer: Any, *statuses: int) -> None:
    assert answer.status_code in statuses, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert set(answer.json()) - {"reference"} == {"type", "title", "status", "detail", "errors"}
    assert answer.json()["status"] == answer.status_code
    described = {name.lower() for name in REFUSED[answer.status_code]["headers"]}
    of_shares = {"ratelimit", "ratelimit-policy"}  # this caller has none
    assert described - {"retry-after"} - of_shares <= set(answer.headers)


@pytest.mark.parametrize("path", [p for method, p in ROUTES if method == "POST" and "process_id" not in p])
@pytest.mark.parametrize("sent", ["application/x-www-form-urlencoded", "text/plain", ""])
def test_a_body_of_another_type_is_told_the_header_to_send(client, path, sent):
    """As ``curl -d`` sends it: the body was called no object, which it was."""
    answer = client.post(
        named(path), content=b'{"inputs": {}}', headers={"Content-Type": sent} if sent else {}
    )
    assert_problem(answer, 415)
    assert "Content-Type: application/json" in answer.json()["detail"]
    assert "application/json" in answer.headers["accept-post"]


@pytest.mark.parametrize("wrong", WRONG_BODIES)
@pytest.mark.parametrize("path", [path for method, path in ROUTES if method == "POST"])
def test_a_wrong_body_is_a_problem_that_is_documented(client, path, wrong):
    content, headers = WRONG_BODIES[wrong]
    answer = client.post(named(path), content=content, headers=headers)
    if path.startswith(DRAFTS) and wrong in OF_FIELDS:
        assert answer.status_code == 200 and answer.json()["faults"]
        return
    assert_problem(answer, *((413,) if wrong == "too long" else (400, 404, 415, 422)))
    assert str(answer.status_code) in DOCUMENT["paths"][path]["post"]["responses"]


@pytest.mark.parametrize("path", [path for _, path in ROUTES if "{" in path])
def test_what_does_not_exist_is_a_problem(client, path):
    for method in [method for method, known in ROUTES if known == path and method != "POST"]:
        body = {"json": BODIES[path]} if method == "PATCH" else {}
        assert_problem(client.request(method, named(path), **body), 404)
        odd = named(path, dict.fromkeys(NAMES, "%00%2e%2e%ff"))
        assert_problem(client.request(method, odd, **body), 404, 422)


@pytest.mark.parametrize("path", sorted({path for _, path in ROUTES}))
def test_a_method_that_is_none_is_a_problem_and_says_which_are(client, path):
    known = {method for method, other in ROUTES if other == path}
    answer = client.request("PUT", named(path))
    assert_problem(answer, 405)
    assert known <= {method.strip() for method in answer.headers["allow"].split(",")}


def test_results_that_never_change_say_so_to_caches(client):
    file = Path(_directory.name) / "file.nc"
    file.write_bytes(b"table")
    context = client.app.state.context
    context.store.put("1" * 64, "database", file)
    accept = {"Accept": "application/x-netcdf"}
    answer = client.get(f"/v1/results/{'1' * 64}", headers=accept)
    assert answer.headers["cache-control"].endswith("immutable") and answer.headers["vary"] == "Accept"
    tag = answer.headers["etag"]
    for known, status in ((tag, 304), (f"W/{tag}", 304), (f'"a", {tag}', 304), ("*", 304), ('"a"', 200)):
        again = client.get(f"/v1/results/{'1' * 64}", headers=accept | {"If-None-Match": known})
        assert again.status_code == status, known
