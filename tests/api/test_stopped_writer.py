"""A process stopped (SIGSTOP) while it holds what all writers need: callers are told, readers served."""

import signal
import subprocess
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import Any

import pytest
import structlog
from anyio.to_thread import current_default_thread_limiter
from fastapi.testclient import TestClient
from own_process import python
from running_service import PATIENCE_S, until
from service_fakes import EXECUTION, REGISTRY
from sqlalchemy import update
from sqlalchemy.exc import DBAPIError
from structlog.testing import LogCapture

from service.app import create_app
from service.queue.tables import jobs
from service.settings import Settings
from service.store.database import BRIEF_MS, database_engine, reading, writing
from service.store.results import results

HOLD = """
import sys
from service.store.database import writing
from service.store.database import database_engine
with writing(database_engine(sys.argv[1]), in_turn=True):
    print("held", flush=True)
    sys.stdin.readline()
"""
LONG_AGO = "2020-01-01T00:00:00.000000Z"


@pytest.fixture
def address(tmp_path, database_url, monkeypatch):
    """A database on which nobody waits for long."""
    monkeypatch.setattr("service.store.dialects.PATIENCE_MS", 1000)
    monkeypatch.setattr("service.store.dialects._STALLED", "-c lock_timeout=1s")
    monkeypatch.setattr("service.store.retries._PATIENCE_S", 0.5)
    return database_url or f"sqlite:///{tmp_path / 'service.sqlite3'}"


@contextmanager
def stopped_writer(address: str) -> Iterator[subprocess.Popen[str]]:
    with python("-c", HOLD, address, stdin=subprocess.PIPE) as process:
        assert process.stdout is not None and process.stdout.readline() == "held\n"
        process.send_signal(signal.SIGSTOP)
        try:
            yield process
        finally:
            process.kill()


@pytest.fixture
def client(tmp_path, address):
    settings: dict[str, Any] = {"data_directory": tmp_path, "database_url": address}
    with TestClient(create_app(Settings(**settings), REGISTRY), raise_server_exceptions=False) as found:
        yield found


def body(text: str) -> dict[str, Any]:
    return {"inputs": {"wish": {"text": text}}}


@pytest.mark.law
def test_writers_are_told_to_come_again_and_readers_notice_nothing(client, address):
    location = client.post(EXECUTION, json=body("done")).headers["location"]
    until(lambda: client.get(location).json()["status"] == "successful")
    engine = database_engine(address)
    with writing(engine) as connection:  # so long ago that looking at them is worth a note
        connection.execute(update(jobs).values(created=LONG_AGO))
        connection.execute(update(results).values(used=LONG_AGO))
    log = LogCapture()
    with stopped_writer(address) as process:
        structlog.configure(processors=[log])
        for text in ("new", "done"):
            answer = client.post(EXECUTION, json=body(text))
            assert (answer.status_code, answer.headers["retry-after"]) == (503, "2")
            assert answer.json()["type"] == "urn:lineofaction:problem:busy"
        steps = [entry for entry in log.entries if entry["event"] == "request"]
        assert [entry["status"] for entry in steps] == [503, 503]
        for path in (location, f"{location}/results", "/v1/jobs", "/v1/databases", "/metrics"):
            assert client.get(path).status_code == 200, path
        assert [entry for entry in log.entries if entry["event"] == "database lost"] == []
        assert client.get("/ready").status_code == 503  # follows a write
        with reading(engine) as connection:
            noted = connection.execute(jobs.select()).one().asked
        assert (noted is None) == address.startswith("sqlite")  # there it holds rows too
        process.send_signal(signal.SIGCONT)
        process.communicate("go on\n")
    answer = client.post(EXECUTION, json=body("new"))
    assert answer.status_code == 201
    until(lambda: client.get(answer.headers["location"]).json()["status"] == "successful")
    assert client.get(location).status_code == 200
    with reading(engine) as connection:
        noted = connection.execute(jobs.select().where(jobs.c.created == LONG_AGO)).one()
        assert noted.asked is not None
    engine.dispose()


def test_health_is_answered_while_every_thread_waits(tmp_path):
    """Else a supervisor would restart a service that is well."""
    app = create_app(Settings(data_directory=tmp_path), REGISTRY)
    with TestClient(app) as client, ThreadPoolExecutor(2) as pool:

        async def all_threads():
            limiter = current_default_thread_limiter()
            tokens = list(range(int(limiter.available_tokens)))
            for token in tokens:
                limiter.acquire_on_behalf_of_nowait(token)
            return limiter, tokens

        async def given_back():
            for token in tokens:
                limiter.release_on_behalf_of(token)

        limiter, tokens = client.portal.call(all_threads)
        health, ready = (pool.submit(client.get, path) for path in ("/health", "/ready"))
        try:
            assert health.result(timeout=PATIENCE_S).json() == {"status": "ok"}
            assert not ready.done()
        finally:
            client.portal.call(given_back)
        assert ready.result().status_code == 200


def test_one_who_can_do_without_waits_for_a_fraction_of_the_time(address):
    engine = database_engine(address)
    of_server = "SELECT setting FROM pg_settings WHERE name = 'lock_timeout'"
    question = "PRAGMA busy_timeout" if address.startswith("sqlite") else of_server
    waits = []
    for patience_ms in (None, BRIEF_MS):
        with writing(engine, patience_ms=patience_ms) as connection:
            waits.append(int(connection.exec_driver_sql(question).scalar_one()))
    assert waits == pytest.approx([1000, BRIEF_MS], abs=BRIEF_MS / 2) and BRIEF_MS <= 500
    brief = writing(engine, in_turn=True, patience_ms=BRIEF_MS)
    with stopped_writer(address), pytest.raises(DBAPIError), brief:
        pass
    engine.dispose()
