"""The API as a caller sees it: execution, status, results, dismissal, one error shape."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from httpx2 import Response
from running_service import REFERENCES, until
from service_fake_work import SECRET
from service_fakes import REGISTRY

from service.app import create_app
from service.settings import Settings

EXECUTION = "/v1/processes/fake/execution"
OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    """A client of a running app with a short queue."""
    app = create_app(Settings(data_directory=tmp_path, queue_limit=2, body_limit=5000), REGISTRY)
    with TestClient(app, raise_server_exceptions=False) as found:
        yield found


def execute(client: TestClient, **wish: Any) -> Response:
    """Post a wish."""
    return client.post(EXECUTION, json={"inputs": {"wish": wish}})


def ended(client: TestClient, location: str) -> dict[str, Any]:
    """Wait for a job."""
    until(lambda: client.get(location).json()["status"] in ("successful", "failed", "dismissed"))
    status: dict[str, Any] = client.get(location).json()
    return status


def problem(answer: Response, status: int) -> dict[str, Any]:
    """Check the one error shape and return it."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    body: dict[str, Any] = answer.json()
    assert set(body) - {"reference"} == {"type", "title", "status", "detail", "errors"}
    assert body["status"] == status
    for fault in body["errors"]:
        assert set(fault) == {"field", "value", "bound", "suggestion"}
    return body


def test_a_job_runs_from_execution_to_result(client: TestClient) -> None:
    answer = execute(client, text="table")
    assert answer.status_code == 201
    status = ended(client, answer.headers["location"])
    assert (status["processID"], status["type"], status["status"]) == ("fake", "process", "successful")
    assert status["progress"] == 100
    reference = client.get(f"{answer.headers['location']}/results", params=REFERENCES).json()["database"]
    file = client.get(reference["href"], headers={"Accept": "application/x-netcdf"})
    assert file.content == b"table"
    assert file.headers["cache-control"] == "public, max-age=31536000, immutable"


def test_links_of_a_job_lead_to_it_and_to_its_results(client: TestClient) -> None:
    status = ended(client, execute(client).headers["location"])
    for link in status["links"]:
        assert client.get(link["href"]).status_code == 200


def test_a_known_version_is_not_sent_again(client: TestClient) -> None:
    location = execute(client, text="table").headers["location"]
    ended(client, location)
    href = client.get(f"{location}/results", params=REFERENCES).json()["database"]["href"]
    accept = {"Accept": "application/x-netcdf"}
    tag = client.get(href, headers=accept).headers["etag"]
    again = client.get(href, headers=accept | {"If-None-Match": tag})
    assert (again.status_code, again.content) == (304, b"")
    assert client.get(href, headers=accept | {"If-None-Match": '"other"'}).status_code == 200


def test_equal_inputs_are_one_computation_and_a_stored_result_is_used(
    client: TestClient, tmp_path: Path
) -> None:
    first = execute(client, text="once").headers["location"]
    second = execute(client, text="once").headers["location"]
    assert first != second
    ended(client, first)
    third = execute(client, text="once")
    assert third.json()["status"] == "successful"
    (starts,) = tmp_path.glob("started_*")
    assert len(starts.read_text().splitlines()) == 1


def test_defaults_written_out_make_no_new_computation(client: TestClient) -> None:
    first = execute(client)
    ended(client, first.headers["location"])
    assert execute(client, mode="write", text="", number=0.0).json()["status"] == "successful"


def test_dismissal_answers_with_the_status_and_the_result_is_gone(client: TestClient) -> None:
    location = execute(client, mode="hang").headers["location"]
    assert client.delete(location).json()["status"] == "dismissed"
    assert problem(client.get(f"{location}/results"), 410)["type"].endswith("job-dismissed")


def test_a_result_that_is_not_ready_says_so(client: TestClient) -> None:
    location = execute(client, mode="hang").headers["location"]
    assert problem(client.get(f"{location}/results"), 404)["type"] == f"{OGC}result-not-ready"
    client.delete(location)


def test_a_failed_job_says_why(client: TestClient) -> None:
    location = execute(client, mode="mesh").headers["location"]
    assert ended(client, location)["status"] == "failed"
    assert problem(client.get(f"{location}/results"), 500)["detail"] == "element 7 has a negative Jacobian"


def test_a_failed_job_names_the_fields_at_fault(client: TestClient) -> None:
    location = execute(client, mode="input").headers["location"]
    ended(client, location)
    (fault,) = problem(client.get(f"{location}/results"), 500)["errors"]
    assert (fault["field"], fault["value"]) == ("pair.pinion.bore_diameter_mm", 95.0)


def test_the_text_of_a_defect_never_leaves(client: TestClient) -> None:
    location = execute(client, mode="defect").headers["location"]
    ended(client, location)
    assert SECRET not in client.get(f"{location}/results").text + client.get(location).text


def test_jobs_are_listed_by_pages(client: TestClient) -> None:
    locations = [execute(client).headers["location"] for _ in range(3)]
    page = client.get("/v1/jobs", params={"limit": 2}).json()
    following = next(link["href"] for link in page["links"] if link["rel"] == "next")
    rest = client.get(following).json()["jobs"]
    assert [f"/v1/jobs/{job['jobID']}" for job in [*page["jobs"], *rest]] == locations[::-1]


def test_a_full_queue_answers_429_with_a_time_to_come_back(client: TestClient) -> None:
    answers = [execute(client, mode="hang", number=n) for n in range(5)]
    refused = [answer for answer in answers if answer.status_code != 201]
    assert refused
    for answer in refused:
        assert problem(answer, 429)["type"] == "urn:lineofaction:problem:queue-full"
        assert answer.headers["retry-after"] == "10"
    for answer in answers:
        if answer.status_code == 201:
            client.delete(answer.headers["location"])


def test_a_body_beyond_the_limit_answers_413(client: TestClient) -> None:
    assert problem(execute(client, text="x" * 6000), 413)["type"] == "urn:lineofaction:problem:too-large"


def test_a_body_that_does_not_tell_its_length_is_counted(client: TestClient) -> None:
    pieces: Callable[[], Iterator[bytes]] = lambda: (b"x" * 1000 for _ in range(100))  # noqa: E731
    answer = client.post(EXECUTION, content=pieces(), headers={"Content-Type": "application/json"})
    problem(answer, 413)


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
def test_a_body_that_cannot_be_used_is_one_fault_by_name(client: TestClient, text: str, field: str) -> None:
    answer = client.post(EXECUTION, content=text, headers={"Content-Type": "application/json"})
    (fault,) = problem(answer, 422)["errors"]
    assert fault["field"] == field
    assert fault["bound"]


def test_bytes_that_are_no_text_are_a_problem_too(client: TestClient) -> None:
    answer = client.post(EXECUTION, content=b"\xff\xfe\x00", headers={"Content-Type": "application/json"})
    problem(answer, 400)


@pytest.mark.parametrize(
    ("method", "path", "status", "kind"),
    [
        ("GET", "/v1/processes/nothing", 404, f"{OGC}no-such-process"),
        ("POST", "/v1/processes/nothing/execution", 404, f"{OGC}no-such-process"),
        ("GET", "/v1/jobs/nothing", 404, f"{OGC}no-such-job"),
        ("DELETE", "/v1/jobs/nothing", 404, f"{OGC}no-such-job"),
        ("GET", "/v1/jobs/nothing/results", 404, f"{OGC}no-such-job"),
        ("GET", f"/v1/results/{'0' * 64}", 404, "urn:lineofaction:problem:not-found"),
        ("GET", f"/v1/results/{'0' * 64}", 404, "urn:lineofaction:problem:not-found"),
        ("GET", "/v1/results/..%2f..%2fetc", 404, "about:blank"),
        ("GET", "/v1/results/ABC", 422, "urn:lineofaction:problem:bad-input"),
        ("GET", "/v1/jobs?limit=0", 422, "urn:lineofaction:problem:bad-input"),
        ("GET", "/nowhere", 404, "about:blank"),
        ("PUT", "/v1/jobs", 405, "about:blank"),
    ],
)
def test_every_refusal_is_a_problem(
    client: TestClient, method: str, path: str, status: int, kind: str
) -> None:
    assert problem(client.request(method, path), status)["type"] == kind


def test_an_unknown_exception_becomes_a_reference(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    context = client.app.state.context  # type: ignore[attr-defined]

    def explode(_identifier: str) -> None:
        raise RuntimeError(SECRET)

    monkeypatch.setattr(context.submissions, "find", explode)
    answer = client.get("/v1/jobs/any")
    body = problem(answer, 500)
    assert SECRET not in answer.text
    assert body["reference"] == answer.headers["x-request-id"]
    assert body["reference"] in body["detail"]


def test_the_standards_pages(client: TestClient) -> None:
    assert {link["rel"] for link in client.get("/v1/").json()["links"]} >= {"self", "service-desc"}
    assert any(
        "ogcapi-processes-1/1.0/conf/core" in c for c in client.get("/v1/conformance").json()["conformsTo"]
    )
    description = client.get("/v1/processes/fake").json()
    assert description["inputs"]["wish"]["schema"]
    assert description["jobControlOptions"] == ["async-execute", "dismiss"]


def test_health_readiness_and_figures(client: TestClient) -> None:
    ended(client, execute(client).headers["location"])
    assert client.get("/health").json() == {"status": "ok"}
    assert client.get("/ready").json()["computations"] == {"successful": 1}
    assert 'loa_computations{state="successful"} 1.0' in client.get("/metrics").text


def test_a_stopped_scheduler_is_not_ready(tmp_path: Path) -> None:
    app = create_app(Settings(data_directory=tmp_path), REGISTRY)
    client = TestClient(app)  # not entered: nothing is started
    problem(client.get("/ready"), 503)
