"""Executions and their inputs; what is not offered is refused by name."""

import pytest
from ogc_jobs import REL, ended, link
from service_fakes import EXECUTION


@pytest.mark.requirement(
    "/req/core/process-execute-op",
    "/req/core/process-execute-request",
    "/req/core/process-execute-inputs",
    "/req/core/process-execute-default-execution-mode",
    "/req/core/process-execute-auto-execution-mode",
    "/req/core/process-execute-success-async",
    "/rec/core/process-execute-honor-prefer",
    "/rec/core/process-execute-preference-applied",
)
def test_an_execution_is_asynchronous_whatever_is_preferred(client):
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


@pytest.mark.requirement("/req/core/process-execute-input-inline-object")
def test_an_input_may_be_qualified(client):
    plain, value = {"text": "qualified"}, {"value": {"text": "qualified"}}
    hashes = set()
    for given in (plain, value, {**value, "mediaType": "application/json"}):
        status = ended(client, "fake", {"inputs": {"wish": given}})
        hashes.add(client.get(link(status, f"{REL}results")).headers["content-location"])
    assert len(hashes) == 1
    refused = client.post(EXECUTION, json={"inputs": {"wish": {"value": {"number": 11}}}})
    assert [fault["field"] for fault in refused.json()["errors"]] == ["inputs.wish.number"]


@pytest.mark.requirement(
    "/req/core/process-execute-input-validation", "/req/core/process-execute-default-outputs"
)
def test_inputs_are_validated(client):
    assert client.post(EXECUTION, json={"inputs": {"wish": {"number": 11}}}).status_code == 422
    assert client.post(EXECUTION, json={"inputs": {"wish": {}}}).status_code == 201


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
def test_what_is_not_offered_is_refused_by_name(client, part, field):
    jobs = len(client.get("/v1/jobs", params={"limit": 1000}).json()["jobs"])
    answer = client.post(EXECUTION, json={"inputs": {"wish": {"text": "refused"}}, **part})
    assert answer.status_code == 422
    (fault,) = answer.json()["errors"]
    assert fault["field"] == field and fault["bound"]
    assert len(client.get("/v1/jobs", params={"limit": 1000}).json()["jobs"]) == jobs


def test_a_callback_is_refused_with_its_reason(client):
    body = {"inputs": {"wish": {}}, "subscriber": {"successUri": "http://caller.example/done"}}
    assert "sends no requests to addresses" in client.post(EXECUTION, json=body).json()["detail"]
