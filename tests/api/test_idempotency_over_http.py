"""A submission with an ``Idempotency-Key`` is one job, however often it arrives."""

from __future__ import annotations

import uuid
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from service_fakes import REGISTRY

from service.app import create_app
from service.settings import Settings


@pytest.fixture
def http(tmp_path: Path) -> Iterator[TestClient]:
    """A running app with the fake process."""
    with TestClient(create_app(Settings(data_directory=tmp_path), REGISTRY)) as found:
        yield found


def entered(http: TestClient, name: str | None, reuse: bool = False, **wish: Any) -> Any:
    """Submit and return the answer."""
    headers = {} if name is None else {"Idempotency-Key": name}
    body = {"inputs": {"wish": wish}, "reuse": reuse}
    return http.post("/v1/processes/fake/execution", json=body, headers=headers)


def jobs(http: TestClient) -> int:
    """Return how many jobs there are."""
    return len(http.get("/v1/jobs").json()["jobs"])


def test_the_same_request_is_the_same_job(http: TestClient) -> None:
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: entered(http, "one", text="x"), range(16)))
    assert {answer.status_code for answer in answers} == {201}
    (job,) = {answer.json()["jobID"] for answer in answers}
    assert str(uuid.UUID(job)) == job and jobs(http) == 1
    assert entered(http, "other", text="x").json()["jobID"] != job
    assert entered(http, None, text="x").json()["jobID"] != job
    assert jobs(http) == 3


def test_a_name_stands_for_one_request(http: TestClient) -> None:
    entered(http, "one", text="x")
    refused = entered(http, "one", text="y")
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == "Idempotency-Key"
    assert jobs(http) == 1


@pytest.mark.parametrize("name", ["", "x" * 256])
def test_a_name_has_a_length(http: TestClient, name: str) -> None:
    assert entered(http, name, text="x").status_code == 422
    assert jobs(http) == 0


def test_a_submission_may_take_the_equal_job(http: TestClient) -> None:
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: entered(http, None, reuse=True, text="x"), range(16)))
    assert len({answer.json()["jobID"] for answer in answers}) == jobs(http) == 1


def test_the_inputs_of_a_job_are_as_its_caller_stated_them(http: TestClient) -> None:
    job = entered(http, None, text="x").json()["jobID"]
    long = entered(http, None, text="x" * 70_000).json()["jobID"]
    assert http.get(f"/v1/jobs/{job}/inputs").json() == {
        "processID": "fake",
        "inputs": {"wish": {"text": "x"}},
    }
    computed = http.get(f"/v1/jobs/{long}/inputs").json()["inputs"]["wish"]
    assert computed == {"mode": "write", "text": "x" * 70_000, "number": 0.0}
    assert http.get(f"/v1/jobs/{uuid.uuid4()}/inputs").status_code == 404
