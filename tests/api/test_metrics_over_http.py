"""Figures for Prometheus: text that its parser reads, true for all services of one database."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from postgres_server import running_server
from prometheus_client import Metric
from prometheus_client.parser import text_string_to_metric_families
from running_service import until
from service_fakes import REGISTRY

from service.app import create_app
from service.settings import Settings
from service.store.database import database_engine
from service.store.schema import Schema

EXECUTION = "/v1/processes/fake/execution"


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    """A client of a running app."""
    with TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY)) as found:
        yield found


def families(client: TestClient) -> dict[str, Metric]:
    """Return the figures by name, read by Prometheus' own rules."""
    answer = client.get("/metrics")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "text/plain; version=0.0.4; charset=utf-8"
    found = list(text_string_to_metric_families(answer.text))
    assert len({family.name for family in found}) == len(found)
    assert all(family.documentation and family.type != "unknown" for family in found)
    return {family.name: family for family in found}


def value(family: Metric, suffix: str = "", **labels: str) -> float:
    """Return the one sample of these labels."""
    (found,) = [
        one.value for one in family.samples if one.name == family.name + suffix and one.labels == labels
    ]
    return float(found)


def run(client: TestClient, mode: str, text: str) -> None:
    """Run a job to its end."""
    wish = {"mode": mode, "text": text}
    location = client.post(EXECUTION, json={"inputs": {"wish": wish}}).headers["location"]
    until(lambda: client.get(location).json()["status"] in ("successful", "failed"))


def test_figures_are_valid_and_tell_what_was_done(client: TestClient) -> None:
    run(client, "write", "x" * 100)
    run(client, "write", "y" * 23)
    run(client, "die", "")
    found = families(client)
    taken, attempts = found["loa_computation_seconds"], found["loa_computation_attempts"]
    assert (taken.type, attempts.type) == ("histogram", "counter")
    for outcome, number, tries in (("successful", 2, 2), ("failed", 1, 2)):
        which = {"process": "fake", "outcome": outcome}
        assert value(taken, "_count", **which) == value(taken, "_bucket", **which, le="+Inf") == number
        assert value(taken, "_sum", **which) > 0.0
        assert value(attempts, "_total", **which) == tries
    assert value(found["loa_computations"], state="failed") == 1
    assert value(found["loa_results"], kind="database") == 2
    assert value(found["loa_result_bytes"], kind="database") == 123
    assert value(found["loa_oldest_waiting_seconds"]) == 0
    assert value(found["loa_database_up"]) == 1
    which = {"method": "POST", "route": EXECUTION, "status": "201"}
    assert value(found["loa_requests"], "_total", **which) == 3
    job = {"method": "GET", "route": "/v1/jobs/{job_id}", "status": "200"}
    assert value(found["loa_requests"], "_total", **job) >= 3


def test_without_a_database_there_are_figures_that_say_so(tmp_path: Path) -> None:
    with running_server() as server:
        url = server.new_database()
        Schema(engine := database_engine(url)).upgrade()
        engine.dispose()
        app = create_app(Settings(data_directory=tmp_path, database_url=url), REGISTRY)
        client = TestClient(app, raise_server_exceptions=False)
        assert value(families(client)["loa_database_up"]) == 1
    found = families(client)
    assert value(found["loa_database_up"]) == 0
    assert "loa_computations" not in found
    assert value(found["loa_requests"], "_total", method="GET", route="/metrics", status="200") == 1
    app.state.context.close()
