"""Jobs: their status, the list and its filters, dismissal."""

import pytest
from ogc_jobs import EXCEPTIONS, executed, link
from service_fakes import EXECUTION


@pytest.mark.law
@pytest.mark.requirement("/req/core/job", "/req/core/job-success")
def test_a_job_tells_its_status(client):
    status = executed(client, text="job")
    assert {"jobID", "status", "type", "processID", "created", "started", "finished", "updated"} <= set(
        status
    )
    assert status["status"] in ("accepted", "running", "successful", "failed", "dismissed")
    assert status["type"] == "process" and 0 <= status["progress"] <= 100
    assert all(client.get(entry["href"]).status_code == 200 for entry in status["links"])


@pytest.mark.requirement("/req/core/job-exception-no-such-job", "/req/core/job-results-exception/no-such-job")
def test_an_unknown_job_is_no_such_job(client):
    for path in ("/v1/jobs/no", "/v1/jobs/no/results"):
        answer = client.get(path)
        assert (answer.status_code, answer.json()["type"]) == (404, f"{EXCEPTIONS}no-such-job")


@pytest.mark.requirement("/req/job-list/job-list-op", "/req/job-list/job-list-success", "/req/job-list/links")
def test_every_job_is_listed_with_its_link(client):
    executed(client, text="list")
    document = client.get("/v1/jobs").json()
    for status in document["jobs"]:
        assert client.get(link(status, "self")).json()["jobID"] == status["jobID"]
    assert link(document, "self")


@pytest.mark.requirement(
    "/req/job-list/limit-definition",
    "/req/job-list/limit-response",
    "/rec/job-list/next-1",
)
def test_the_list_of_jobs_is_limited_and_goes_on(client):
    for number in (1, 2):
        executed(client, text=f"limit {number}")
    document = client.get("/v1/jobs", params={"limit": 1}).json()
    assert len(document["jobs"]) == 1
    assert client.get(link(document, "next")).json()["jobs"] != document["jobs"]


@pytest.mark.requirement(
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
def test_jobs_are_found_by_every_filter(client):
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


@pytest.mark.requirement("/req/dismiss/job-dismiss-op", "/req/dismiss/job-dismiss-success")
def test_a_job_is_dismissed(client):
    location = client.post(EXECUTION, json={"inputs": {"wish": {"mode": "hang"}}}).headers["location"]
    answer = client.delete(location)
    assert (answer.status_code, answer.json()["status"]) == (200, "dismissed")
    assert client.delete("/v1/jobs/no").json()["type"] == f"{EXCEPTIONS}no-such-job"
