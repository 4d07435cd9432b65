"""The list of processes and their descriptions, the landing page and the definition of the API."""

import pytest
from ogc_jobs import EXCEPTIONS, REL, link
from service_fakes import EXECUTION


@pytest.mark.requirement("/req/core/process-list", "/req/core/process-list-success", "/req/core/pl-links")
def test_every_process_is_listed_with_its_link(client):
    document = client.get("/v1/processes").json()
    for summary in document["processes"]:
        assert {"id", "version", "jobControlOptions", "outputTransmission", "links"} <= set(summary)
        assert client.get(link(summary, "self")).json()["id"] == summary["id"]
    assert link(document, "self")


@pytest.mark.requirement("/req/core/pl-limit-definition", "/req/core/pl-limit-response")
def test_the_list_of_processes_is_limited(client):
    assert len(client.get("/v1/processes", params={"limit": 1}).json()["processes"]) == 1
    assert client.get("/v1/processes", params={"limit": 0}).status_code == 422


@pytest.mark.requirement(
    "/req/core/process", "/req/core/process-success", "/req/ogc-process-description/json-encoding"
)
def test_a_process_is_described(client):
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
def test_inputs_and_outputs_have_titles_and_schemas(client):
    description = client.get("/v1/processes/fake").json()
    for part in ("inputs", "outputs"):
        assert description[part]
        for entry in description[part].values():
            assert entry["title"] and isinstance(entry["schema"], dict)


@pytest.mark.requirement("/req/core/process-exception/no-such-process")
def test_an_unknown_process_is_no_such_process(client):
    for answer in (client.get("/v1/processes/no"), client.post("/v1/processes/no/execution", json={})):
        assert (answer.status_code, answer.json()["type"]) == (404, f"{EXCEPTIONS}no-such-process")


# The landing page, the definition of the API and what is declared.


BASE = "http://www.opengis.net/spec/ogcapi-processes-1/1.0/conf/"


@pytest.mark.requirement(
    "/req/core/landingpage-op", "/req/core/landingpage-success", "/rec/job-list/job-list-landing-page"
)
def test_the_landing_page_leads_everywhere(client):
    answer = client.get("/v1/")
    assert answer.status_code == 200
    for relation in ("service-desc", f"{REL}conformance", f"{REL}processes", f"{REL}job-list"):
        assert client.get(link(answer.json(), relation)).status_code == 200


@pytest.mark.law
@pytest.mark.requirement("/rec/core/api-definition-oas")
def test_types_of_the_definition(client):
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
def test_the_definition_has_every_path(client):
    definition = client.get(link(client.get("/v1/").json(), "service-desc")).json()
    assert definition["openapi"].startswith("3.")
    for path in ("/v1", "/v1/conformance", "/v1/processes", "/v1/processes/{process_id}", EXECUTION):
        assert path in definition["paths"]
    for path in ("/v1/jobs", "/v1/jobs/{job_id}", "/v1/jobs/{job_id}/results"):
        assert path in definition["paths"]


@pytest.mark.requirement("/req/core/conformance-op", "/req/core/conformance-success")
def test_the_classes_are_declared(client):
    classes = client.get("/v1/conformance").json()["conformsTo"]
    wanted = ("core", "ogc-process-description", "json", "job-list", "dismiss")
    assert set(classes) == {BASE + name for name in wanted}


@pytest.mark.requirement("/req/core/http")
def test_methods_and_paths_are_refused_as_http_says(client):
    assert client.get("/v1/nothing").status_code == 404
    answer = client.post("/v1/jobs")
    assert answer.status_code == 405 and "GET" in answer.headers["allow"]


@pytest.mark.requirement("/req/json/definition")
def test_answers_are_json(client):
    for path in ("/v1", "/v1/conformance", "/v1/processes", "/v1/processes/fake", "/v1/jobs"):
        assert client.get(path).headers["content-type"] == "application/json"
