"""The landing page, the definition of the API and what is declared."""

from __future__ import annotations

import pytest
from fastapi.testclient import TestClient
from ogc_jobs import REL, link
from service_fakes import EXECUTION

BASE = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/"


@pytest.mark.requirement(
    "/req/core/landingpage-op", "/req/core/landingpage-success", "/rec/job-list/job-list-landing-page"
)
def test_the_landing_page_leads_everywhere(client: TestClient) -> None:
    answer = client.get("/v1/")
    assert answer.status_code == 200
    for relation in ("service-desc", f"{REL}conformance", f"{REL}processes", f"{REL}job-list"):
        assert client.get(link(answer.json(), relation)).status_code == 200


@pytest.mark.requirement("/rec/core/api-definition-oas")
def test_types_of_the_definition(client: TestClient) -> None:
    """What the links say they lead to is answered to those who accept it."""
    links = [entry for entry in client.get("/v1/").json()["links"] if entry["rel"].startswith("service-")]
    assert [entry["type"] for entry in links if entry["rel"] == "service-desc"] == [
        "application/vnd.oai.openapi+json;version=3.1"
    ]
    for entry in links:
        answer = client.get(entry["href"], headers={"Accept": entry["type"]})
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith(entry["type"])
        assert "accept" in answer.headers["vary"].lower()


@pytest.mark.requirement("/req/core/api-definition-op", "/req/core/api-definition-success")
def test_the_definition_has_every_path(client: TestClient) -> None:
    definition = client.get(link(client.get("/v1/").json(), "service-desc")).json()
    assert definition["openapi"].startswith("3.")
    for path in ("/v1", "/v1/conformance", "/v1/processes", "/v1/processes/{process_id}", EXECUTION):
        assert path in definition["paths"]
    for path in ("/v1/jobs", "/v1/jobs/{job_id}", "/v1/jobs/{job_id}/results"):
        assert path in definition["paths"]


@pytest.mark.requirement("/req/core/conformance-op", "/req/core/conformance-success")
def test_the_classes_are_declared(client: TestClient) -> None:
    classes = client.get("/v1/conformance").json()["conformsTo"]
    wanted = ("core", "ogc-process-description", "json", "job-list", "dismiss")
    assert set(classes) == {BASE + name for name in wanted}


@pytest.mark.requirement("/req/core/http")
def test_methods_and_paths_are_refused_as_http_says(client: TestClient) -> None:
    assert client.get("/v1/nothing").status_code == 404
    answer = client.post("/v1/jobs")
    assert answer.status_code == 405 and "GET" in answer.headers["allow"]


@pytest.mark.requirement("/req/json/definition")
def test_answers_are_json(client: TestClient) -> None:
    for path in ("/v1", "/v1/conformance", "/v1/processes", "/v1/processes/fake", "/v1/jobs"):
        assert client.get(path).headers["content-type"] == "application/json"
