"""Requirements of OGC API - Processes 1.0 (OGC 18-062r2) by their identifiers.

Of the classes core, ogc-process-description, json, oas30, job-list and dismiss, as far as they concern what
is offered: asynchronous execution of processes with one output.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient
from httpx2 import Response
from openapi_spec_validator import OpenAPIV30SpecValidator
from running_service import until
from service_fakes import REGISTRY

from service.app import create_app
from service.settings import Settings

BASE = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/"
REL = "http://www.opengis.net/def/rel/ogc/1.0/"
EXCEPTIONS = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"
EXECUTION = "/v1/processes/fake/execution"
REQUIREMENTS: dict[str, Callable[[TestClient], None]] = {}
Check = Callable[[TestClient], None]


def requirement(*names: str) -> Callable[[Check], Check]:
    """Enter a check under the requirements it states."""

    def enter(check: Check) -> Check:
        for name in names:
            REQUIREMENTS[name] = check
        return check

    return enter


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A client of a running service with one job that succeeded and one that failed."""
    settings = Settings(data_directory=tmp_path_factory.mktemp("ogc"))
    with TestClient(create_app(settings, REGISTRY)) as found:
        yield found


def link(document: dict[str, Any], relation: str) -> str:
    """Return the first link of a relation: but for descriptions, which have two types, the only one."""
    found, *others = [entry["href"] for entry in document["links"] if entry["rel"] == relation]
    assert not others or relation == "service-desc"
    return str(found)


def executed(client: TestClient, **wish: Any) -> dict[str, Any]:
    """Enter a job and wait for its end."""
    return ended(client, "fake", {"inputs": {"wish": wish}})


def ended(client: TestClient, process: str, body: dict[str, Any]) -> dict[str, Any]:
    """Execute a process and wait for the end of its job."""
    answer = client.post(f"/v1/processes/{process}/execution", json=body)
    assert answer.status_code == 201, answer.text
    location = answer.headers["location"]
    until(lambda: client.get(location).json()["status"] in ("successful", "failed", "dismissed"))
    status: dict[str, Any] = client.get(location).json()
    return status


@requirement(
    "/req/core/landingpage-op", "/req/core/landingpage-success", "/rec/job-list/job-list-landing-page"
)
def landing_page(client: TestClient) -> None:
    answer = client.get("/v1/")
    assert answer.status_code == 200
    for relation in ("service-desc", f"{REL}conformance", f"{REL}processes", f"{REL}job-list"):
        assert client.get(link(answer.json(), relation)).status_code == 200


@requirement("/rec/core/api-definition-oas")
def types_of_the_definition(client: TestClient) -> None:
    """What the links say they lead to is answered to those who accept it."""
    links = [entry for entry in client.get("/v1/").json()["links"] if entry["rel"].startswith("service-")]
    assert [entry["type"] for entry in links if entry["rel"] == "service-desc"] == [
        f"application/vnd.oai.openapi+json;version=3.{minor}" for minor in (1, 0)
    ]
    for entry in links:
        answer = client.get(entry["href"], headers={"Accept": entry["type"]})
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith(entry["type"])
        assert "accept" in answer.headers["vary"].lower()


@requirement("/req/oas30/oas-definition-1", "/req/oas30/oas-definition-2")
def description_of_version_30(client: TestClient) -> None:
    (href,) = [entry["href"] for entry in client.get("/v1/").json()["links"] if "3.0" in entry["type"]]
    assert list(OpenAPIV30SpecValidator(client.get(href).json()).iter_errors()) == []


@requirement("/req/core/api-definition-op", "/req/core/api-definition-success")
def api_definition(client: TestClient) -> None:
    definition = client.get(link(client.get("/v1/").json(), "service-desc")).json()
    assert definition["openapi"].startswith("3.")
    for path in ("/v1", "/v1/conformance", "/v1/processes", "/v1/processes/{process_id}", EXECUTION):
        assert path in definition["paths"]
    for path in ("/v1/jobs", "/v1/jobs/{job_id}", "/v1/jobs/{job_id}/results"):
        assert path in definition["paths"]


@requirement("/req/core/conformance-op", "/req/core/conformance-success")
def conformance(client: TestClient) -> None:
    classes = client.get("/v1/conformance").json()["conformsTo"]
    wanted = ("core", "ogc-process-description", "json", "oas30", "job-list", "dismiss")
    assert set(classes) == {BASE + name for name in wanted}


@requirement("/req/core/http")
def http(client: TestClient) -> None:
    assert client.get("/v1/nothing").status_code == 404
    answer = client.post("/v1/jobs")
    assert answer.status_code == 405 and "GET" in answer.headers["allow"]


@requirement("/req/core/process-list", "/req/core/process-list-success", "/req/core/pl-links")
def process_list(client: TestClient) -> None:
    document = client.get("/v1/processes").json()
    for summary in document["processes"]:
        assert {"id", "version", "jobControlOptions", "outputTransmission", "links"} <= set(summary)
        assert client.get(link(summary, "self")).json()["id"] == summary["id"]
    assert link(document, "self")


@requirement("/req/core/pl-limit-definition", "/req/core/pl-limit-response")
def process_list_limit(client: TestClient) -> None:
    assert len(client.get("/v1/processes", params={"limit": 1}).json()["processes"]) == 1
    assert client.get("/v1/processes", params={"limit": 0}).status_code == 422


@requirement("/req/core/process", "/req/core/process-success", "/req/ogc-process-description/json-encoding")
def process_description(client: TestClient) -> None:
    description = client.get("/v1/processes/fake").json()
    assert set(description["jobControlOptions"]) <= {"sync-execute", "async-execute", "dismiss"}
    assert set(description["outputTransmission"]) <= {"value", "reference"}
    assert link(description, f"{REL}execute") == EXECUTION


@requirement(
    "/req/ogc-process-description/inputs-def",
    "/req/ogc-process-description/input-def",
    "/req/ogc-process-description/outputs-def",
    "/req/ogc-process-description/output-def",
)
def inputs_and_outputs(client: TestClient) -> None:
    description = client.get("/v1/processes/fake").json()
    for part in ("inputs", "outputs"):
        assert description[part]
        for entry in description[part].values():
            assert entry["title"] and isinstance(entry["schema"], dict)


@requirement("/req/core/process-exception/no-such-process")
def no_such_process(client: TestClient) -> None:
    for answer in (client.get("/v1/processes/no"), client.post("/v1/processes/no/execution", json={})):
        assert (answer.status_code, answer.json()["type"]) == (404, f"{EXCEPTIONS}no-such-process")


@requirement(
    "/req/core/process-execute-op",
    "/req/core/process-execute-request",
    "/req/core/process-execute-inputs",
    "/req/core/process-execute-default-execution-mode",
    "/req/core/process-execute-auto-execution-mode",
    "/req/core/process-execute-success-async",
    "/rec/core/process-execute-honor-prefer",
    "/rec/core/process-execute-preference-applied",
)
def execution(client: TestClient) -> None:
    body = {"inputs": {"wish": {"text": "ogc"}}, "outputs": {}, "response": "document"}
    options = client.get("/v1/processes/fake").json()["jobControlOptions"]
    assert "sync-execute" not in options and "async-execute" in options
    for prefer in (
        {},
        {"Prefer": "respond-async"},
        {"Prefer": "respond-async, wait=1"},
        {"Prefer": "wait=9"},
        {"Prefer": "respond-sync"},
    ):
        answer = client.post(EXECUTION, json=body, headers=prefer)
        assert answer.status_code == 201
        assert answer.headers["location"] == f"/v1/jobs/{answer.json()['jobID']}"
        applied = answer.headers.get("preference-applied")
        assert applied == (None if prefer.get("Prefer") in ("wait=9", "respond-sync") else "respond-async")


@requirement("/req/core/process-execute-input-inline-object")
def qualified_inputs(client: TestClient) -> None:
    plain, value = {"text": "qualified"}, {"value": {"text": "qualified"}}
    hashes = set()
    for given in (plain, value, {**value, "mediaType": "application/json"}):
        status = ended(client, "fake", {"inputs": {"wish": given}})
        hashes.add(client.get(link(status, f"{REL}results")).headers["content-location"])
    assert len(hashes) == 1
    refused = client.post(EXECUTION, json={"inputs": {"wish": {"value": {"number": 11}}}})
    assert [fault["field"] for fault in refused.json()["errors"]] == ["inputs.wish.number"]


@requirement("/req/core/process-execute-input-validation", "/req/core/process-execute-default-outputs")
def validated_inputs(client: TestClient) -> None:
    assert client.post(EXECUTION, json={"inputs": {"wish": {"number": 11}}}).status_code == 422
    assert client.post(EXECUTION, json={"inputs": {"wish": {}}}).status_code == 201


@requirement("/req/core/job", "/req/core/job-success")
def job(client: TestClient) -> None:
    status = executed(client, text="job")
    assert {"jobID", "status", "type", "processID", "created", "started", "finished", "updated"} <= set(
        status
    )
    assert status["status"] in ("accepted", "running", "successful", "failed", "dismissed")
    assert status["type"] == "process" and 0 <= status["progress"] <= 100


@requirement("/req/core/job-exception-no-such-job", "/req/core/job-results-exception/no-such-job")
def no_such_job(client: TestClient) -> None:
    for path in ("/v1/jobs/no", "/v1/jobs/no/results"):
        answer = client.get(path)
        assert (answer.status_code, answer.json()["type"]) == (404, f"{EXCEPTIONS}no-such-job")


def delivered(client: TestClient, process: str, text: str, **form: Any) -> Response:
    """Execute with a form and get the results."""
    status = ended(client, process, {"inputs": {"wish": {"text": text}}, **form})
    return client.get(link(status, f"{REL}results"))


@requirement("/req/core/job-results", "/req/core/job-results-async-raw-value-one")
def raw_value(client: TestClient) -> None:
    """Also of an execution that leaves everything out: raw and value are the defaults of the standard."""
    wanted = {"response": "raw", "outputs": {"database": {"transmissionMode": "value"}}}
    for form in ({}, wanted, {"outputs": {}}):
        answer = delivered(client, "fake", "results", **form)
        assert (answer.status_code, answer.content) == (200, b"results")
        assert answer.headers["content-type"] == "application/x-netcdf"
        where = client.get(answer.headers["content-location"], headers={"Accept": "application/x-netcdf"})
        assert where.content == answer.content
        assert where.headers["content-digest"] == answer.headers["content-digest"]


@requirement("/req/core/job-results-async-raw-ref")
def raw_reference(client: TestClient) -> None:
    outputs = {"database": {"transmissionMode": "reference"}}
    answer = delivered(client, "fake", "raw", outputs=outputs)
    assert (answer.status_code, answer.content) == (204, b"")
    (reference,) = answer.links.values()
    found = client.get(reference["url"], headers={"Accept": reference["type"]})
    assert (found.status_code, found.headers["content-type"]) == (200, reference["type"])
    assert reference["title"] == "database"


@requirement("/req/core/job-results-async-document")
def document(client: TestClient) -> None:
    """A link: JSON does not hold netCDF."""
    for outputs in ({}, {"database": {"transmissionMode": "reference"}}):
        answer = delivered(client, "fake", "document", response="document", outputs=outputs)
        assert answer.headers["content-type"] == "application/json"
        reference = answer.json()["database"]
        found = client.get(reference["href"], headers={"Accept": reference["type"]})
        assert (found.content, found.headers["content-type"]) == (b"document", reference["type"])


@requirement("/req/core/job-results-exception/results-not-ready")
def not_ready(client: TestClient) -> None:
    location = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang"}}}).headers["location"]
    answer = client.get(f"{location}/results")
    assert (answer.status_code, answer.json()["type"]) == (404, f"{EXCEPTIONS}result-not-ready")
    client.delete(location)


@requirement("/req/core/job-results-failed")
def failed_job(client: TestClient) -> None:
    status = executed(client, mode="mesh")
    answer = client.get(f"/v1/jobs/{status['jobID']}/results")
    assert answer.status_code == 500
    assert {"type", "title", "status", "detail"} <= set(answer.json())


@requirement("/req/job-list/job-list-op", "/req/job-list/job-list-success", "/req/job-list/links")
def job_list(client: TestClient) -> None:
    executed(client, text="list")
    document = client.get("/v1/jobs").json()
    for status in document["jobs"]:
        assert client.get(link(status, "self")).json()["jobID"] == status["jobID"]
    assert link(document, "self")


@requirement(
    "/req/job-list/limit-definition",
    "/req/job-list/limit-response",
    "/rec/job-list/next-1",
)
def job_list_limit(client: TestClient) -> None:
    for number in (1, 2):
        executed(client, text=f"limit {number}")
    document = client.get("/v1/jobs", params={"limit": 1}).json()
    assert len(document["jobs"]) == 1
    assert client.get(link(document, "next")).json()["jobs"] != document["jobs"]


@requirement(
    "/req/job-list/type-definition",
    "/req/job-list/type-response",
    "/req/job-list/processID-mandatory",
    "/req/job-list/processID-definition",
    "/req/job-list/processid-response",
    "/req/job-list/status-definition",
    "/req/job-list/status-response",
    "/req/job-list/datetime-definition",
    "/req/job-list/datetime-response",
    "/req/job-list/duration-definition",
    "/req/job-list/duration-response",
)
def job_list_filters(client: TestClient) -> None:
    status = executed(client, text="filters")
    definition = client.get("/openapi.json").json()["paths"]["/v1/jobs"]["get"]["parameters"]
    offered = {entry["name"] for entry in definition if entry["in"] == "query"}
    assert {"type", "processID", "status", "datetime", "minDuration", "maxDuration", "limit"} <= offered
    assert status["processID"] == "fake"
    for matching in (
        {"type": "process"},
        {"processID": "fake"},
        {"status": status["status"]},
        {"datetime": status["created"]},
        {"minDuration": 0},
        {"maxDuration": 10**6},
    ):
        assert status in client.get("/v1/jobs", params=matching).json()["jobs"], matching
    for other in (
        {"processID": "other"},
        {"status": "failed"},
        {"datetime": "../2000-01-01T00:00:00Z"},
        {"minDuration": 10**6},
    ):
        assert status not in client.get("/v1/jobs", params=other).json()["jobs"], other


@requirement("/req/dismiss/job-dismiss-op", "/req/dismiss/job-dismiss-success")
def dismissal(client: TestClient) -> None:
    location = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang"}}}).headers["location"]
    answer = client.delete(location)
    assert (answer.status_code, answer.json()["status"]) == (200, "dismissed")
    assert client.delete("/v1/jobs/no").json()["type"] == f"{EXCEPTIONS}no-such-job"


@requirement("/req/json/definition")
def json_everywhere(client: TestClient) -> None:
    for path in ("/v1", "/v1/conformance", "/v1/processes", "/v1/processes/fake", "/v1/jobs"):
        assert client.get(path).headers["content-type"] == "application/json"


@pytest.mark.parametrize("name", REQUIREMENTS)
def test_the_requirement_is_met(client: TestClient, name: str) -> None:
    REQUIREMENTS[name](client)


REFUSED = [
    ({"subscriber": {"successUri": "http://caller.example/done"}}, "subscriber"),
    ({"inputs": {"wish": {"href": "http://caller.example/wish"}}}, "inputs.wish.href"),
    ({"inputs": {"wish": {"value": {}, "mediaType": "text/plain"}}}, "inputs.wish.mediaType"),
    ({"inputs": {"wish": {"value": {}, "encoding": "base64"}}}, "inputs.wish.encoding"),
    ({"outputs": {"flanks": {}}}, "outputs.flanks"),
    ({"outputs": {"database": {"format": {"mediaType": "text/csv"}}}}, "outputs.database.format.mediaType"),
    ({"outputs": {"database": {"transmissionMode": "pigeon"}}}, "outputs.database.transmissionMode"),
    (
        {"response": "document", "outputs": {"database": {"transmissionMode": "value"}}},
        "outputs.database.transmissionMode",
    ),
    ({"response": "xml"}, "response"),
    ({"mode": "sync"}, "mode"),
]


@pytest.mark.parametrize(("part", "field"), REFUSED)
def test_what_is_not_offered_is_refused_by_name(client: TestClient, part: dict[str, Any], field: str) -> None:
    jobs = len(client.get("/v1/jobs", params={"limit": 1000}).json()["jobs"])
    answer = client.post(EXECUTION, json={"inputs": {"wish": {"text": "refused"}}, **part})
    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert fault["field"] == field and fault["bound"]
    assert len(client.get("/v1/jobs", params={"limit": 1000}).json()["jobs"]) == jobs


def test_a_callback_is_refused_with_its_reason(client: TestClient) -> None:
    body = {"inputs": {"wish": {}}, "subscriber": {"successUri": "http://caller.example/done"}}
    assert "sends no requests to addresses" in client.post(EXECUTION, json=body).json()["detail"]


def test_a_request_for_results_may_ask_for_another_form(client: TestClient) -> None:
    status = ended(client, "fake", {"inputs": {"wish": {"text": "other form"}}})
    path = link(status, f"{REL}results")
    assert client.get(path, params={"response": "document"}).json()["database"]["href"]
    assert client.get(path, params={"transmissionMode": "reference"}).status_code == 204
    refused = client.get(path, params={"response": "document", "transmissionMode": "value"})
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == "transmissionMode"
    assert client.get(path).content == b"other form"


@pytest.mark.parametrize("response", ["raw", "document"])
def test_a_request_for_results_gets_the_type_that_it_prefers(client: TestClient, response: str) -> None:
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
