"""A submission with an ``Idempotency-Key`` is one job, however often it arrives."""

import uuid
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from fastapi.testclient import TestClient
from service_fakes import EXECUTION


def entered(client: TestClient, name: str | None, reuse: bool = False, **wish: Any) -> Any:
    headers = {} if name is None else {"Idempotency-Key": name}
    body = {"inputs": {"wish": wish}, "reuse": reuse}
    return client.post(EXECUTION, json=body, headers=headers)


def jobs(client: TestClient) -> int:
    return len(client.get("/v1/jobs").json()["jobs"])


def test_the_same_request_is_the_same_job(client):
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: entered(client, "one", text="x"), range(16)))
    assert {answer.status_code for answer in answers} == {201}
    (job,) = {answer.json()["jobID"] for answer in answers}
    assert str(uuid.UUID(job)) == job and jobs(client) == 1
    assert entered(client, "one", text="y").status_code == 422 and jobs(client) == 1
    assert entered(client, "other", text="x").json()["jobID"] != job
    assert entered(client, None, text="x").json()["jobID"] != job
    assert jobs(client) == 3


@pytest.mark.parametrize("name", ["", "x" * 256])
def test_a_name_has_a_length(client, name):
    assert entered(client, name, text="x").status_code == 422
    assert jobs(client) == 0


def test_a_submission_may_take_the_equal_job(client):
    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(lambda _: entered(client, None, reuse=True, text="x"), range(16)))
    assert len({answer.json()["jobID"] for answer in answers}) == jobs(client) == 1


def test_the_inputs_of_a_job_are_as_its_caller_stated_them(client):
    job = entered(client, None, text="x").json()["jobID"]
    long = entered(client, None, text="x" * 70_000).json()["jobID"]
    assert client.get(f"/v1/jobs/{job}/inputs").json() == {
        "processID": "fake",
        "inputs": {"wish": {"text": "x"}},
    }
    computed = client.get(f"/v1/jobs/{long}/inputs").json()["inputs"]["wish"]
    assert computed == {"mode": "write", "text": "x" * 70_000, "number": 0.0}
    assert client.get(f"/v1/jobs/{uuid.uuid4()}/inputs").status_code == 404
