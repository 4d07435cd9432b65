"""The list of processes and their descriptions."""

from __future__ import annotations

import pytest
from fastapi.testclient import TestClient
from ogc_jobs import EXCEPTIONS, REL, link
from service_fakes import EXECUTION


@pytest.mark.requirement("/req/core/process-list", "/req/core/process-list-success", "/req/core/pl-links")
def test_every_process_is_listed_with_its_link(client: TestClient) -> None:
    document = client.get("/v1/processes").json()
    for summary in document["processes"]:
        assert {"id", "version", "jobControlOptions", "outputTransmission", "links"} <= set(summary)
        assert client.get(link(summary, "self")).json()["id"] == summary["id"]
    assert link(document, "self")


@pytest.mark.requirement("/req/core/pl-limit-definition", "/req/core/pl-limit-response")
def test_the_list_of_processes_is_limited(client: TestClient) -> None:
    assert len(client.get("/v1/processes", params={"limit": 1}).json()["processes"]) == 1
    assert client.get("/v1/processes", params={"limit": 0}).status_code == 422


@pytest.mark.requirement(
    "/req/core/process", "/req/core/process-success", "/req/ogc-process-description/json-encoding"
)
def test_a_process_is_described(client: TestClient) -> None:
    description = client.get("/v1/processes/fake").json()
    assert description["jobControlOptions"] == ["async-execute", "dismiss"]
    assert set(description["outputTransmission"]) <= {"value", "reference"}
    assert link(description, f"{REL}execute") == EXECUTION


@pytest.mark.requirement(
    "/req/ogc-process-description/inputs-def",
    "/req/ogc-process-description/input-def",
    "/req/ogc-process-description/outputs-def",
    "/req/ogc-process-description/output-def",
)
def test_inputs_and_outputs_have_titles_and_schemas(client: TestClient) -> None:
    description = client.get("/v1/processes/fake").json()
    for part in ("inputs", "outputs"):
        assert description[part]
        for entry in description[part].values():
            assert entry["title"] and isinstance(entry["schema"], dict)


@pytest.mark.requirement("/req/core/process-exception/no-such-process")
def test_an_unknown_process_is_no_such_process(client: TestClient) -> None:
    for answer in (client.get("/v1/processes/no"), client.post("/v1/processes/no/execution", json={})):
        assert (answer.status_code, answer.json()["type"]) == (404, f"{EXCEPTIONS}no-such-process")
