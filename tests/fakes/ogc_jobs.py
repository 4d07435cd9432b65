"""Names of OGC API - Processes, links of its documents, and jobs that are entered as it says."""

from typing import Any

from fastapi.testclient import TestClient
from running_service import until

REL = "http://www.opengis.net/def/rel/ogc/1.0/"
EXCEPTIONS = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"


def link(document: dict[str, Any], relation: str) -> str:
    """Return the first link of a relation: but for descriptions, which have two types, the only one."""
    found, *others = [entry["href"] for entry in document["links"] if entry["rel"] == relation]
    assert not others or relation == "service-desc"
    return str(found)


def executed(client: TestClient, **wish: Any) -> dict[str, Any]:
    return ended(client, "fake", {"inputs": {"wish": wish}})


def ended(client: TestClient, process: str, body: dict[str, Any]) -> dict[str, Any]:
    answer = client.post(f"/v1/processes/{process}/execution", json=body)
    assert answer.status_code == 201, answer.text
    location = answer.headers["location"]
    until(lambda: client.get(location).json()["status"] in ("successful", "failed", "dismissed"))
    status: dict[str, Any] = client.get(location).json()
    return status
