"""A lost connection: outlasted if it comes back, answered with a time to try again if it does not."""

import os
import socket
import sqlite3
from itertools import count

import pytest
from cut_connections import relay
from fastapi.testclient import TestClient
from postgres_server import migrated, running_server
from running_service import bench
from service_fakes import REGISTRY
from sqlalchemy import event

from lineofaction.gearbox.problems import BadInput, Busy
from service.app import create_app
from service.queue.entry import BatchCase, Entry
from service.settings import Settings, load_settings
from service.store.database import Schema, database_engine, now, open_database

KEEPALIVE = (socket.TCP_KEEPIDLE, socket.TCP_KEEPINTVL, socket.TCP_KEEPCNT)


@pytest.fixture
def server_url(postgres):
    url = postgres.new_database()
    engine = database_engine(url)
    Schema(engine).upgrade()
    engine.dispose()
    return url


@pytest.fixture
def machine(tmp_path, server_url):
    found = bench(tmp_path, REGISTRY, database_url=server_url)
    yield found
    found.close()


def test_steps_go_on_when_their_connections_are_ended(machine, postgres):
    """Connections that wait in the pool, and one in mid-transaction whose commit is never answered."""
    job = machine.submit(text="kept")
    url = str(machine.settings.database_address)
    assert postgres.end_connections(url) > 0
    assert machine.submissions.find(job.id).status == "accepted"

    ended: list[int] = []

    def end_once(_connection):
        if not ended:
            ended.append(postgres.end_connections(url))

    event.listen(machine.engine, "commit", end_once)
    again = machine.submit(text="another")
    assert ended and ended[0] > 0
    assert [found.id for found in machine.submissions.page(10)] == [again.id, job.id]
    assert machine.submissions.counts() == {"accepted": 2}


def test_an_answer_to_a_commit_that_is_lost_enters_no_job_twice(machine):
    """The transaction was committed; the connection broke before the answer came: the step runs again."""
    entry, work = machine.submissions.entry(), BatchCase("ab" * 32, {"wish": {}})
    enter = Entry._job.__wrapped__
    identifier = "7a8a9f0e-26f4-4f55-9e0b-3a3e3a3f3a3f"
    for _ in range(2):
        enter(entry, identifier, "fake", work, now())
    assert len(machine.submissions.page(10)) == 1
    assert machine.submissions.counts() == {"accepted": 1}


def test_jobs_end_while_connections_are_ended_all_the_time(machine, postgres):
    url, writes = str(machine.settings.database_address), count(1)

    def end_at_every_third(connection):
        if connection.get_execution_options().get("immediate") and next(writes) % 3 == 0:
            postgres.end_connections(url)

    event.listen(machine.engine, "commit", end_at_every_third)
    machine.scheduler.start()
    ended = [machine.ended(machine.submit(text=text)) for text in ("one", "two")]
    assert [(job.status, job.attempts) for job in ended] == [("successful", 1)] * 2
    assert next(writes) > 6


def test_a_server_that_is_gone_is_said_to_callers_with_a_time_to_try_again(tmp_path):
    with running_server() as server:
        url = server.new_database()
        Schema(engine := database_engine(url)).upgrade()
        engine.dispose()
        app = create_app(Settings(data_directory=tmp_path, database_url=url), REGISTRY, works=False)
        client = TestClient(app, raise_server_exceptions=False)
        assert client.get("/v1/jobs").json()["jobs"] == []
    answer = client.get("/v1/jobs")
    assert (answer.status_code, answer.headers["retry-after"]) == (503, "5")
    assert answer.headers["content-type"] == "application/problem+json"
    assert answer.json()["type"] == "urn:lineofaction:problem:database-unavailable"
    app.state.context.close()


def test_a_network_that_swallows_everything_is_noticed(postgres):
    """The system drops a connection whose packets nobody takes, within a client's patience of 30 s."""
    with relay(postgres.socket) as between:
        url = postgres.new_database().partition("?")[0].replace("@", f"@127.0.0.1:{between.port}")
        engine = database_engine(url)
        with engine.connect() as connection:
            descriptor = os.dup(connection.connection.dbapi_connection.fileno())
            with socket.socket(fileno=descriptor) as wire:
                assert 0 < wire.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) <= 20_000
                silent = [wire.getsockopt(socket.IPPROTO_TCP, option) for option in KEEPALIVE]
        engine.dispose()
    idle, interval, count = silent
    assert idle + interval * count < 30


def test_a_connection_that_is_cut_in_mid_statement_is_outlasted(tmp_path, postgres):
    with relay(postgres.socket) as between:
        direct = migrated(postgres.new_database())
        url = direct.partition("?")[0].replace("@", f"@127.0.0.1:{between.port}")
        machine, cuts = bench(tmp_path, REGISTRY, database_url=url), []

        def cut_once(*_):
            if len(cuts) < 1:
                cuts.append(between.cut())

        event.listen(machine.engine, "before_cursor_execute", cut_once)
        job = machine.submit(text="kept")
        assert cuts[0] > 0
        assert [found.id for found in machine.submissions.page(10)] == [job.id]
        machine.close()


def test_a_file_that_another_holds_is_waited_for_and_then_refused(tmp_path, monkeypatch):
    monkeypatch.setattr("service.store.dialects.PATIENCE_MS", 20)
    machine = bench(tmp_path, REGISTRY)
    holder = sqlite3.connect(tmp_path / "service.sqlite3", isolation_level=None)
    holder.execute("BEGIN IMMEDIATE")
    with pytest.raises(Busy):
        machine.submit(text="refused")
    # let go at the first refusal
    monkeypatch.setattr("service.store.retries._note", lambda _state: holder.rollback())
    assert machine.submit(text="waits").status == "accepted"
    holder.close()


def test_a_database_that_is_none_is_refused_without_its_password(tmp_path, monkeypatch):
    monkeypatch.setenv("LOA_DATABASE_URL", "mysql://user:geheim@host/name")
    with pytest.raises(BadInput) as caught:
        open_database(str(load_settings(data_directory=tmp_path).database_address))
    assert "geheim" not in str(caught.value)
    assert [fault.field for fault in caught.value.faults] == ["database_url"]
    assert "geheim" not in repr(load_settings(data_directory=tmp_path))


def test_a_server_is_not_upgraded_by_the_way(postgres):
    with pytest.raises(BadInput, match=r"it has no tables\. Run loa database upgrade first"):
        open_database(postgres.new_database())
