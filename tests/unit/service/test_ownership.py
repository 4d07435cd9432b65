"""One server owns the job table; what it starts ends with it, and a lock that is lost is acquired again."""

import fcntl
import os
import signal
import time

import pytest
from own_process import python
from running_service import Bench, bench, lives, until
from service_fakes import REGISTRY
from sqlalchemy import text

from lineofaction.gearbox.problems import BadInput
from service.queue.machinery import job_machinery
from service.settings import Settings
from service.store.database import reading


@pytest.fixture
def settings(tmp_path, database_url):
    """Return the settings of servers on one table, each with a data directory of its own."""
    url = database_url or f"sqlite:///{tmp_path / 'shared.sqlite3'}"
    yield {"database_url": url, "results_url": (tmp_path / "results").as_uri()}


def test_a_second_server_is_refused_by_name_until_the_first_has_stopped(tmp_path, settings):
    first = job_machinery(Settings(data_directory=tmp_path / "one", **settings), REGISTRY)
    other = Settings(data_directory=tmp_path / "other", **settings)
    with pytest.raises(BadInput) as caught:
        job_machinery(other, REGISTRY)
    (fault,) = caught.value.faults
    assert (fault.field, fault.bound) == ("database_url", "free: another server works on its jobs")
    assert "Stop that server" in str(fault.suggestion)
    reader = job_machinery(other, REGISTRY, works=False)  # upkeep goes on beside it
    reader.close()
    first.scheduler.start()
    first.scheduler.stop()
    job_machinery(other, REGISTRY).close()
    first.close()


def test_two_tables_of_one_database_have_an_owner_each(tmp_path, postgres):
    """The lock is of the table: another one, here in another schema, is another's."""
    url = postgres.emptied_database()
    first = bench(tmp_path / "one", REGISTRY, database_url=url)
    first.scheduler.start()
    with first.engine.begin() as connection:
        connection.execute(text("CREATE SCHEMA other"))
        connection.execute(text("CREATE TABLE other.computation (id int)"))
        connection.execute(text("SET search_path TO other"))
        lock = "SELECT pg_try_advisory_lock(7106401, CAST(CAST('computation' AS regclass) AS oid)::int4)"
        assert connection.execute(text(lock)).scalar_one()
        assert not connection.execute(text(lock.replace("'comp", "'public.comp"))).scalar_one()
    first.close()


@pytest.fixture
def server(tmp_path, postgres):
    """A started server on PostgreSQL with a job that hangs."""
    made = bench(tmp_path / "server", REGISTRY, database_url=postgres.emptied_database())
    made.scheduler.start()
    yield made
    made.close()


def child_of(machine: Bench, key: str) -> int:
    file = machine.settings.data_directory / f"started_{key[:8]}"
    until(lambda: file.exists() and file.read_text() != "")
    return int(file.read_text().splitlines()[-1].split()[0])


def owners(machine: Bench) -> int:
    with reading(machine.engine) as connection:
        locks = "SELECT count(*) FROM pg_locks WHERE locktype = 'advisory' AND classid = 7106401 AND granted"
        return int(connection.execute(text(locks)).scalar_one())


def test_a_lock_that_is_lost_is_acquired_again_and_the_work_goes_on(server, postgres):
    job = server.submit(mode="hang")
    child = child_of(server, job.key)
    postgres.end_connections(str(server.settings.database_address))
    until(lambda: owners(server) == 1)
    assert lives(child)
    assert server.submissions.find(job.id).attempts == 1
    server.submissions.dismiss(job.id)
    until(lambda: not lives(child))


@pytest.mark.law
def test_who_has_lost_the_table_to_another_server_ends_its_work_and_starts_none(
    tmp_path, server, postgres, monkeypatch
):
    """The other one puts the work back and does it: never do two write to the table."""
    job = server.submit(mode="hang")
    child = child_of(server, job.key)
    acquire, url = server.scheduler._owner.acquire, str(server.settings.database_address)
    free: list[bool] = []

    def acquire_late():
        until(lambda: free != [])
        acquire()

    monkeypatch.setattr(server.scheduler._owner, "acquire", acquire_late)
    postgres.end_connections(url)
    other = bench(tmp_path / "other", REGISTRY, database_url=url)
    other.scheduler.start()
    free.append(True)
    until(lambda: not lives(child))
    again = child_of(other, job.key)
    next_one = server.submit(text="next")
    server.scheduler.wake()
    time.sleep(1.5)  # three turns
    assert lives(again) and server.submissions.find(next_one.id).status == "accepted"
    assert server.submissions.find(job.id).attempts == 1
    other.close()
    until(lambda: owners(server) == 1)
    child_of(server, job.key)
    server.submissions.dismiss(job.id)
    assert server.ended(next_one).status == "successful"


def test_what_runs_by_the_table_but_not_here_waits_again(tmp_path):
    """A claim was committed, and no answer came however often it was tried."""
    machine = bench(tmp_path, REGISTRY)
    machine.scheduler.start()
    job = machine.submit(text="a")
    until(lambda: machine.submissions.find(job.id).ended)
    lost = machine.submit(text="lost")
    if machine.submissions.find(lost.id).status == "accepted":
        machine.claims.claim()
    machine.scheduler._doubtful = True
    ended = machine.ended(lost)
    assert (ended.status, ended.attempts) == ("successful", 1)
    machine.close()


def test_a_worker_waits_until_the_earlier_one_in_its_workspace_is_gone(tmp_path):
    machine = bench(tmp_path, REGISTRY)
    job = machine.submit(text="after")
    (row,) = machine.claims.waiting()
    workspace = machine.settings.data_directory / "work" / row
    workspace.mkdir(parents=True)
    earlier = os.open(workspace, os.O_RDONLY)
    fcntl.flock(earlier, fcntl.LOCK_EX)
    machine.scheduler.start()
    until(lambda: machine.submissions.find(job.id).status == "running")
    time.sleep(1.0)
    assert machine.starts(job) == []
    os.close(earlier)
    assert machine.ended(job).status == "successful"
    machine.close()


# A worker whose service is killed without warning ends with all its children.


SERVICE = """
import sys
from pathlib import Path
from own_process import python
from running_service import bench
from service_fakes import REGISTRY
machine = bench(Path(sys.argv[1]), REGISTRY)
machine.scheduler.start()
machine.submit(mode="hang")
machine.scheduler._thread.join()
"""


def test_kill_minus_nine_leaves_no_orphan(tmp_path):
    service = python("-c", SERVICE, tmp_path, stdout=None)
    try:
        until(lambda: any(f.read_text() for f in tmp_path.glob("grandchild_*")))
        sleeper = int(next(tmp_path.glob("grandchild_*")).read_text())
        child = int(next(tmp_path.glob("started_*")).read_text().split()[0])
        assert lives(sleeper) and lives(child)
    finally:
        os.kill(service.pid, signal.SIGKILL)
        service.wait()
    until(lambda: not lives(sleeper) and not lives(child))
