"""Results of jobs, in the form that the execution or the request asks for."""

from typing import Any

import pytest
from fastapi.testclient import TestClient
from httpx2 import Response
from ogc_jobs import EXCEPTIONS, REL, ended, executed, link
from service_fake_work import SECRET
from service_fakes import EXECUTION


def delivered(client: TestClient, process: str, text: str, **form: Any) -> Response:
    status = ended(client, process, {"inputs": {"wish": {"text": text}}, **form})
    return client.get(link(status, f"{REL}results"))


@pytest.mark.requirement("/req/core/job-results", "/req/core/job-results-async-raw-value-one")
def test_a_result_is_its_raw_value(client):
    """Also of an execution that leaves everything out: raw and value are the defaults of the standard."""
    wanted = {"response": "raw", "outputs": {"database": {"transmissionMode": "value"}}}
    for form in ({}, wanted, {"outputs": {}}):
        answer = delivered(client, "fake", "results", **form)
        assert (answer.status_code, answer.content) == (200, b"results")
        assert answer.headers["content-type"] == "application/x-netcdf"
        where = client.get(answer.headers["content-location"], headers={"Accept": "application/x-netcdf"})
        assert where.content == answer.content
        assert where.headers["content-digest"] == answer.headers["content-digest"]


@pytest.mark.requirement("/req/core/job-results-async-raw-ref")
def test_a_result_may_be_a_reference(client):
    outputs = {"database": {"transmissionMode": "reference"}}
    answer = delivered(client, "fake", "raw", outputs=outputs)
    assert (answer.status_code, answer.content) == (204, b"")
    (reference,) = answer.links.values()
    found = client.get(reference["url"], headers={"Accept": reference["type"]})
    assert (found.status_code, found.headers["content-type"]) == (200, reference["type"])
    assert reference["title"] == "database"


@pytest.mark.requirement("/req/core/job-results-async-document")
def test_a_document_holds_references(client):
    """A link: JSON does not hold netCDF."""
    for outputs in ({}, {"database": {"transmissionMode": "reference"}}):
        answer = delivered(client, "fake", "document", response="document", outputs=outputs)
        assert answer.headers["content-type"] == "application/json"
        reference = answer.json()["database"]
        found = client.get(reference["href"], headers={"Accept": reference["type"]})
        assert (found.content, found.headers["content-type"]) == (b"document", reference["type"])


@pytest.mark.requirement("/req/core/job-results-exception/results-not-ready")
def test_a_result_that_is_not_ready_is_said_to_be(client):
    location = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang"}}}).headers["location"]
    answer = client.get(f"{location}/results")
    assert (answer.status_code, answer.json()["type"]) == (404, f"{EXCEPTIONS}result-not-ready")
    client.delete(location)


@pytest.mark.requirement("/req/core/job-results-failed")
@pytest.mark.parametrize(
    ("mode", "detail", "faults"),
    [
        ("mesh", "element 7 has a negative Jacobian", []),
        ("input", None, [("pair.pinion.bore_diameter_mm", 95.0)]),
        ("defect", None, []),
    ],
)
def test_a_failed_job_answers_a_problem(client, mode, detail, faults):
    """With the fields at fault; the text of a defect never leaves."""
    location = f"/v1/jobs/{executed(client, mode=mode)['jobID']}"
    answer = client.get(f"{location}/results")
    problem = answer.json()
    assert (answer.status_code, answer.headers["content-type"]) == (500, "application/problem+json")
    assert {"type", "title", "status", "detail"} <= set(problem)
    assert detail in (None, problem["detail"])
    assert [(fault["field"], fault["value"]) for fault in problem["errors"]] == faults
    assert SECRET not in answer.text + client.get(location).text


def test_a_request_for_results_may_ask_for_another_form(client):
    status = ended(client, "fake", {"inputs": {"wish": {"text": "other form"}}})
    path = link(status, f"{REL}results")
    assert client.get(path, params={"response": "document"}).json()["database"]["href"]
    assert client.get(path, params={"transmissionMode": "reference"}).status_code == 204
    refused = client.get(path, params={"response": "document", "transmissionMode": "value"})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == "transmissionMode"
    assert client.get(path).content == b"other form"


@pytest.mark.parametrize("response", ["raw", "document"])
def test_a_request_for_results_gets_the_type_that_it_prefers(client, response):
    text = f"accepted {response}"
    status = ended(client, "fake", {"inputs": {"wish": {"text": text}}, "response": response})
    path = link(status, f"{REL}results")
    for accept, kind in (
        ("application/json", "application/json"),
        ("application/x-netcdf, application/json;q=0.5", "application/x-netcdf"),
        ("text/html", {"raw": "application/x-netcdf", "document": "application/json"}[response]),
    ):
        answer = client.get(path, headers={"Accept": accept})
        assert (answer.status_code, answer.headers["content-type"]) == (200, kind), accept
        assert "Accept" in answer.headers["vary"]
