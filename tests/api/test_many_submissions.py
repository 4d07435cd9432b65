"""200 submissions of 20 distinct cases at once: 20 computations, 200 right answers, a bounded queue."""

from __future__ import annotations

import random
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from fastapi.testclient import TestClient
from running_service import REFERENCES, until
from service_stand_ins import REGISTRY

from service.app import create_app
from service.settings import Settings

EXECUTION = "/v1/processes/standin/execution"
SUBMISSIONS, CASES, QUEUE = 200, 20, 8
FILE = {"Accept": "application/x-netcdf"}


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    """A client of a running app with a queue shorter than the number of cases."""
    settings = Settings(data_directory=tmp_path, queue_limit=QUEUE, workers=2)
    with TestClient(create_app(settings, REGISTRY), raise_server_exceptions=False) as found:
        yield found


def submit(client: TestClient, text: str) -> str:
    """Submit until there is room; return the job's address."""
    while True:
        answer = client.post(EXECUTION, json={"inputs": {"wish": {"text": text}}})
        if answer.status_code == 201:
            return str(answer.headers["location"])
        assert (answer.status_code, answer.headers["retry-after"]) == (429, "10"), answer.text
        time.sleep(1.0)  # the tests' patience is less than the 10 s asked for


def test_equal_cases_are_computed_once_and_all_are_answered(client: TestClient, tmp_path: Path) -> None:
    wishes = [f"case {n % CASES}" for n in range(SUBMISSIONS)]
    random.Random(7).shuffle(wishes)
    waiting: list[int] = []

    def watch() -> bool:
        time.sleep(0.2)
        counts = client.get("/ready").json()["computations"]
        waiting.append(counts.get("accepted", 0))
        return bool(counts == {"successful": CASES})

    with ThreadPoolExecutor(16) as pool:
        submitted = pool.map(lambda text: submit(client, text), wishes)
        until(watch, 600.0)
        locations = list(submitted)
    assert max(waiting) <= QUEUE
    assert len(set(locations)) == SUBMISSIONS
    for text, location in zip(wishes, locations, strict=True):
        reference = client.get(f"{location}/results", params=REFERENCES).json()["database"]
        assert client.get(reference["href"], headers=FILE).text == text
    starts = [line for file in tmp_path.glob("started_*") for line in file.read_text().splitlines()]
    assert len(starts) == CASES
