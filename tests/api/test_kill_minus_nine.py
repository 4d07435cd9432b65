"""kill -9 of workers, servers and schedulers, and ended database connections, at random moments.

No job is lost, none ends with another result, no process is left, no partial file is served. A few moments
here; LOA_KILL_MOMENTS asks for more (the nightly run for 50), LOA_KILL_SEED for others.
"""

from __future__ import annotations

import os
import random
import sys
from collections import Counter
from pathlib import Path

import pytest
from killed_service import KilledService
from postgres_server import PostgresServer
from running_service import until
from service_stand_in_work import slow_content

from service.store import stored_results
from service.store.maintenance import verify_store

MOMENTS = int(os.environ.get("LOA_KILL_MOMENTS", "4"))
SEED = int(os.environ.get("LOA_KILL_SEED", "20261120"))
COMMON = {"LOA_WORKERS": "2", "LOA_ATTEMPTS": "10", "LOA_LEASE_S": "5"}


@pytest.fixture
def service(request: pytest.FixtureRequest, tmp_path: Path, database_url: str | None) -> KilledService:
    """One process on SQLite; on PostgreSQL one that serves and two that work."""
    settings = dict(COMMON)
    if database_url is None:
        return KilledService(tmp_path, settings, None, apart=False)
    server: PostgresServer = request.getfixturevalue("postgres")
    settings |= {"LOA_DATABASE_URL": database_url, "LOA_RESULTS_URL": (tmp_path / "results").as_uri()}
    return KilledService(tmp_path, settings, lambda: server.end_connections(database_url), apart=True)


@pytest.mark.slow
def test_nothing_is_lost_when_parts_are_killed_at_random_moments(
    service: KilledService, tmp_path: Path, database_url: str | None
) -> None:
    chance = random.Random(SEED)
    with service:
        service.measure("undisturbed")
        for number in range(MOMENTS):
            service.submit(f"case {number}")
            service.submit(f"case {chance.randrange(number + 1)}")  # shared, or done already
            service.strike(chance)
            sys.stdout.write(f"{number}: {service.struck[-1]}\n")
        ends = service.settled()
        assert set(ends.values()) == {"successful"}, ends
        for text in {*service.jobs.values()}:
            until(lambda text=text: text in service.served)  # type: ignore[misc]
        assert service.stop() == [0] * len(service.parts)
        until(lambda: service.marked() == [])
    assert service.faults == []
    texts = ["undisturbed", *(f"case {number}" for number in range(MOMENTS))]
    assert {text: len(digests) for text, digests in service.served.items()} == dict.fromkeys(texts, 1)
    place = service.parts[0].environment
    store = stored_results(Path(place["LOA_DATA_DIRECTORY"]), database_url, place.get("LOA_RESULTS_URL"))
    assert len(store.lines()) == verify_store(store).sound == len(texts)
    assert slow_content("case 0") != slow_content("case 1")
    sys.stdout.write(f"struck: {Counter(service.struck)}\n")
