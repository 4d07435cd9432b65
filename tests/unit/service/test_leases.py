"""Several schedulers on one database: none is run by two, none is lost with its holder."""

from __future__ import annotations

import fcntl
import os
import signal
import sqlite3
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient
from own_process import python
from running_service import PATIENCE_S, REFERENCES, Bench, bench, lives, until
from service_fakes import EXECUTION, REGISTRY
from sqlalchemy import select, update

from service.app import create_app
from service.queue.job import Job
from service.queue.tables import computations
from service.settings import Settings
from service.store.database import reading, writing
from service.worker.order import WorkOrder
from service.worker.worker import Worker

Schedulers = Callable[..., Bench]


@pytest.fixture
def schedulers(tmp_path: Path, database_url: str | None) -> Iterator[Schedulers]:
    """Return what makes schedulers on one database and one store, each with a data directory of its own."""
    made: list[Bench] = []
    database = database_url or f"sqlite:///{tmp_path / 'shared.sqlite3'}"

    def make(name: str, **settings: Any) -> Bench:
        facts = {"database_url": database, "lease_s": 60.0, **settings}
        made.append(bench(tmp_path / name, REGISTRY, results=tmp_path / "results", **facts))
        return made[-1]

    yield make
    for one in made:
        one.close()


def let_leases_end(machine: Bench) -> None:
    """Let all leases have ended a while ago."""
    with writing(machine.engine) as connection:
        connection.execute(update(computations).values(leased_until=0.0))


def lease_end(machine: Bench, job: Job) -> float:
    with reading(machine.engine) as connection:
        which = select(computations.c.leased_until).where(computations.c.key == job.key)
        return float(connection.execute(which).scalar_one())


def test_a_claim_without_a_sign_of_life_is_taken_up_and_its_holder_is_refused(schedulers: Schedulers) -> None:
    dead, alive = schedulers("dead"), schedulers("alive")
    job = dead.submit(text="taken up")
    claim = dead.claimed()
    assert dead.claims.renew([claim]) == {claim.id}
    assert alive.claims.take_up() == []
    let_leases_end(dead)
    (taken,) = alive.claims.take_up()
    assert (taken.id, taken.attempts) == (claim.id, 1)
    assert dead.claims.renew([claim]) == dead.claims.held([claim]) == set()
    dead.claims.succeed(claim)
    dead.claims.fail(claim, "late")
    dead.claims.put_back(claim, "late", counted=False)
    assert dead.submissions.find(job.id).status == "running"
    assert alive.claims.held([taken]) == {claim.id}


def test_work_of_a_scheduler_that_died_is_done_by_another(schedulers: Schedulers) -> None:
    dead, alive = schedulers("dead"), schedulers("alive")
    job = dead.submit(text="done elsewhere")
    dead.claimed()
    let_leases_end(dead)
    alive.scheduler.start()
    ended = alive.ended(job)
    assert (ended.status, ended.attempts) == ("successful", 2)
    assert dead.store.verified(job.key, "database").path.read_text() == "done elsewhere"


def test_schedulers_that_live_share_the_work_and_take_none_from_each_other(schedulers: Schedulers) -> None:
    """The lease of a long job is renewed; of the others each is started once, by one or the other."""
    pair = [schedulers(name, workers=2, lease_s=20.0) for name in ("one", "other")]
    long = pair[0].submit(mode="hang")
    for one in pair:
        one.scheduler.start()
    jobs = [pair[0].submit(text=str(n)) for n in range(4)]
    assert [pair[0].ended(job).status for job in jobs] == ["successful"] * 4
    assert [len(pair[0].starts(job)) + len(pair[1].starts(job)) for job in jobs] == [1] * 4
    end = lease_end(pair[0], long)
    until(lambda: lease_end(pair[0], long) > end)
    assert (pair[0].submissions.find(long.id).status, pair[0].submissions.find(long.id).attempts) == (
        "running",
        1,
    )
    pair[0].submissions.dismiss(long.id)
    until(lambda: all(not list((one.settings.data_directory / "work").iterdir()) for one in pair))


SCHEDULER = """
import sys
from pathlib import Path
from own_process import python
from running_service import bench
from service_fakes import EXECUTION, REGISTRY
from sqlalchemy import select, update
directory, database, results = sys.argv[1:]
machine = bench(Path(directory), REGISTRY, results=Path(results), database_url=database, lease_s=20.0)
machine.scheduler.start()
machine.scheduler._thread.join()
"""


def stop_between_transactions(pid: int, other: Bench) -> None:
    """Stop a process; one that holds SQLite's lock just then would stop all others with it."""
    file = Path(str(other.engine.url.database))
    while True:
        os.kill(pid, signal.SIGSTOP)
        os.waitpid(pid, os.WUNTRACED)  # a thread inside a system call may still take the lock until then
        if other.engine.dialect.name != "sqlite":
            return
        with closing(sqlite3.connect(file, timeout=0.2, isolation_level=None)) as connection:
            try:
                connection.execute("BEGIN IMMEDIATE")
                return
            except sqlite3.OperationalError:
                os.kill(pid, signal.SIGCONT)
                time.sleep(0.05)


@pytest.mark.parametrize("database_url", ["sqlite", "postgresql"], indirect=True)
@pytest.mark.nightly  # it waits for a lease to end
def test_the_worker_of_a_stalled_scheduler_ends_before_another_takes_up_its_work(
    tmp_path: Path, schedulers: Schedulers
) -> None:
    """SIGSTOP: the scheduler neither renews nor kills; its worker and its children must end by themselves."""
    alive = schedulers("alive")
    job = alive.submit(mode="hang")
    place = tmp_path / "stalled"
    arguments = [place, alive.settings.database_address, tmp_path / "results"]
    stalled = python("-c", SCHEDULER, *arguments, stdout=subprocess.DEVNULL)
    try:
        grandchild = place / f"grandchild_{job.key[:8]}"
        until(lambda: grandchild.exists() and grandchild.read_text() != "")
        child = int((place / f"started_{job.key[:8]}").read_text().split()[0])
        stop_between_transactions(stalled.pid, alive)
        until(lambda: alive.claims.take_up() != [])
        assert not lives(child)
        assert not lives(int(grandchild.read_text()))
    finally:
        stalled.kill()
        stalled.wait()


def test_a_process_that_only_serves_leaves_the_work_to_another(
    tmp_path: Path, schedulers: Schedulers
) -> None:
    elsewhere = schedulers("elsewhere")
    settings = Settings(data_directory=tmp_path, database_url=elsewhere.settings.database_url)
    with TestClient(create_app(settings, REGISTRY, works=False)) as client:
        execution = EXECUTION
        location = client.post(execution, json={"inputs": {"wish": {"text": "far"}}}).headers["location"]
        assert client.get("/ready").json()["computations"] == {"accepted": 1}
        elsewhere.scheduler.start()
        until(lambda: client.get(location).json()["status"] == "successful")
        href = client.get(f"{location}/results", params=REFERENCES).json()["database"]["href"]
        assert client.get(href, headers={"Accept": "application/x-netcdf"}).content == b"far"

        hangs = client.post(execution, json={"inputs": {"wish": {"mode": "hang"}}}).headers["location"]
        until(lambda: client.get(hangs).json()["progress"] == 12)
        assert client.delete(hangs).json()["status"] == "dismissed"
        until(lambda: not list((elsewhere.settings.data_directory / "work").iterdir()))


def test_a_worker_waits_until_the_earlier_one_in_its_workspace_is_gone(schedulers: Schedulers) -> None:
    machine = schedulers("one")
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


def test_kill_minus_nine_leaves_no_orphan(tmp_path: Path) -> None:
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


@pytest.mark.parametrize(("granted_s", "renewed_s"), [(-1.0, None), (PATIENCE_S, -1.0)])
def test_a_worker_ends_at_the_end_of_its_lease_however_late_it_started(
    tmp_path: Path, granted_s: float, renewed_s: float | None
) -> None:
    """It counted from when it had read the order: a slow start let it outlive a lease that nobody renewed."""
    inputs = {"wish": {"mode": "hang"}}
    now = time.monotonic()
    order = WorkOrder(
        "service_fake_work:work", inputs, "a" * 64, tmp_path, tmp_path, lease_until=now + granted_s
    )
    worker = Worker(order, tmp_path / "log")
    if renewed_s is not None:
        worker.beat(now + renewed_s)
    until(lambda: worker.listen()[1])
    outcome = worker.finish()
    assert outcome.died and "SIGKILL" in outcome.failure
