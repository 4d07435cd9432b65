"""Many submissions of few distinct cases at once: each computed once, right answers for all, a bounded queue.

To one process on SQLite, and to a server with access keys and two schedulers on PostgreSQL: 60 submissions
of 6 cases with every change, 200 of 20 at night. And to a server on SQLite by many clients at the same time,
none of which is refused.
"""

import random
import re
import time
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import httpx2
import pytest
from fastapi.testclient import TestClient
from killed_service import KilledService
from postgres_server import migrated
from prometheus_client.parser import text_string_to_metric_families
from running_service import PATIENCE_S, REFERENCES, until
from service_fakes import EXECUTION, REGISTRY

from service.access.key_file import KeyFile
from service.app import create_app
from service.settings import Settings

SUBMISSIONS_PER_CASE, QUEUE = 10, 4
FILE = {"Accept": "application/x-netcdf"}
Client = TestClient | httpx2.Client


@dataclass(frozen=True)
class Asked:
    """A service that is asked: by whom, and where the work leaves its traces."""

    clients: Sequence[Client]
    directory: Path


@pytest.fixture
def one_process(tmp_path):
    """One process on SQLite with a queue shorter than the number of cases."""
    settings = Settings(data_directory=tmp_path, queue_limit=QUEUE, workers=2)
    with TestClient(create_app(settings, REGISTRY), raise_server_exceptions=False) as found:
        yield Asked([found], tmp_path)


@pytest.fixture
def several_processes(tmp_path, postgres):
    """A server on PostgreSQL in a process of its own, and two callers with keys."""
    keys = KeyFile(tmp_path / "keys.json")
    settings = {
        "LOA_DATABASE_URL": migrated(postgres.new_database()),
        "LOA_RESULTS_URL": (tmp_path / "results").as_uri(),
        "LOA_KEYS_FILE": str(keys.path),
        "LOA_QUEUE_LIMIT": str(QUEUE),
        "LOA_WORKERS": "2",
    }
    headers = [{"Authorization": f"Bearer {keys.add(name)}"} for name in ("one", "other")]
    with KilledService(tmp_path, settings, headers=headers[0]) as service:
        service.request("GET", "/ready")
        first, second = (
            httpx2.Client(base_url=service.address, headers=one, timeout=PATIENCE_S) for one in headers
        )
        with first, second:
            assert httpx2.get(f"{service.address}/v1/jobs").status_code == 401
            yield Asked([first, second], tmp_path)


@pytest.fixture(params=["one_process", "several_processes"])
def asked(request):
    found: Asked = request.getfixturevalue(request.param)
    return found


def submit(client: Client, text: str) -> str:
    """Submit until there is room; return the job's address."""
    while True:
        answer = client.post(EXECUTION, json={"inputs": {"wish": {"text": text}}})
        if answer.status_code == 201:
            return str(answer.headers["location"])
        assert (answer.status_code, answer.headers.get("retry-after")) == (429, "10"), answer.text
        time.sleep(1.0)  # the tests' patience is less than the 10 s requested


def submitted_at_once(asked: Asked, wishes: Sequence[str], meanwhile: Callable[[], bool]) -> list[str]:
    """Submit in 16 threads, every other one with another key, and wait until `meanwhile` is true."""
    with ThreadPoolExecutor(16) as pool:
        callers = [asked.clients[n % len(asked.clients)] for n in range(len(wishes))]
        locations = pool.map(submit, callers, wishes)
        until(meanwhile)
        return list(locations)


@pytest.mark.parametrize("cases", [6, pytest.param(20, marks=pytest.mark.nightly)])
def test_equal_cases_are_computed_once_and_all_are_answered(asked, cases):
    wishes = [f"case {n % cases}" for n in range(SUBMISSIONS_PER_CASE * cases)]
    random.Random(7).shuffle(wishes)
    client, waiting = asked.clients[0], []

    def watch():
        time.sleep(0.2)
        states = re.findall(r'loa_computations{state="(.*)"} ([1-9].*)', client.get("/metrics").text)
        counts = {state: int(float(number)) for state, number in states}
        waiting.append(counts.get("accepted", 0))
        return bool(counts == {"successful": cases})

    locations = submitted_at_once(asked, wishes, watch)
    assert max(waiting) <= QUEUE
    assert len(set(locations)) == len(wishes)
    for number, (text, location) in enumerate(zip(wishes, locations, strict=True)):
        reader = asked.clients[number % len(asked.clients)]
        reference = reader.get(f"{location}/results", params=REFERENCES).json()["database"]
        assert reader.get(reference["href"], headers=FILE).text == text
    starts = [line for file in asked.directory.rglob("started_*") for line in file.read_text().splitlines()]
    assert len(starts) == cases
    figures = {f.name: f for f in text_string_to_metric_families(client.get("/metrics").text)}
    counted = [s.value for s in figures["loa_computation_seconds"].samples if s.name.endswith("_count")]
    assert counted == [cases]


@pytest.mark.parametrize(
    ("clients", "submissions"),
    [
        (64, 128),
        pytest.param(64, 1200, marks=pytest.mark.nightly),
        pytest.param(256, 1200, marks=pytest.mark.nightly),
    ],
)
def test_many_clients_at_once_are_all_answered(tmp_path, clients, submissions):
    """Of 1200 six were told that the database cannot be reached: others had always come before them."""
    settings = {"LOA_QUEUE_LIMIT": str(submissions)}
    with KilledService(tmp_path, settings) as service, ThreadPoolExecutor(clients) as pool:
        service.request("GET", "/ready")
        limits = httpx2.Limits(max_connections=clients)
        with httpx2.Client(base_url=service.address, timeout=PATIENCE_S, limits=limits) as client:

            def kind(number):
                answer = client.post(EXECUTION, json={"inputs": {"wish": {"text": f"case {number}"}}})
                return str(answer.json().get("type", answer.status_code))

            kinds = Counter(pool.map(kind, range(submissions)))
    assert kinds == {"process": submissions}
