"""Whole jobs done by workers of a real Dask scheduler: each ends, whoever is killed meanwhile."""

import asyncio
import errno
import json
import os
import signal
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from dask_processes import DaskProcesses, dask_processes
from divided_work import CASE, SEARCH
from running_service import Bench, bench, lives, until
from service_fake_work import SECRET
from service_fakes import REGISTRY

from fe_contact.ste import SteDatabase
from lineofaction.gearbox.problems import BadInput
from model_studies.workers import dask_cluster
from service.queue import cluster, settlement
from service.queue.claims import Claims
from service.queue.job import Job
from service.queue.machinery import crew_of
from service.settings import Settings
from service.store.deployment import Deployment
from service.version import solver_version
from service.worker.order import Outcome, Product, WorkOrder
from service.worker.process import ANALYZE, default_registry
from service.worker.task import Done, do_job

pytest.importorskip("distributed", reason="the extra dask is not installed")

MakeServer = Callable[..., Bench]
BUSY = 10.0
"""How many times longer than on an idle machine a step may take."""


@pytest.fixture(scope="module")
def dask(tmp_path_factory):
    """Two workers with one thread each, whose data directory is that of all servers of this file."""
    folder = tmp_path_factory.mktemp("dask")
    with dask_processes(folder, 2, LOA_DATA_DIRECTORY=str(folder / "data")) as running:
        yield running


@pytest.fixture
def server(dask, tmp_path):
    """Return what makes servers on one table whose jobs the workers do."""
    made: list[Bench] = []

    def make(**settings):
        dask.await_workers(2)
        made.append(bench(tmp_path / "server", REGISTRY, scheduler=dask.address, **settings))
        made[-1].scheduler._crew = cluster.Cluster(dask.address, tmp_path.name)
        made[-1].scheduler.start()
        return made[-1]

    yield make
    for job in made[-1].submissions.page(100):
        made[-1].submissions.dismiss(job.id)  # it would go on without a server
    made[-1].scheduler.wake()
    for file in (dask.folder / "data").glob("started_*"):
        until(lambda file=file: not lives(int(file.read_text().split()[-3])))
    for file in (*(dask.folder / "data").glob("started_*"), *(dask.folder / "data").glob("grandchild_*")):
        file.unlink()
    for one in made:
        one.close()


def note(dask: DaskProcesses, name: str, job: Job) -> Path:
    """Return what the fake work leaves in the data directory of the workers, once it is there."""
    file = dask.folder / "data" / f"{name}_{job.key[:8]}"
    until(lambda: file.exists() and file.read_text() != "")
    return file


def child(dask: DaskProcesses, job: Job) -> int:
    return int(note(dask, "started", job).read_text().splitlines()[-1].split()[0])


def starts(dask: DaskProcesses, job: Job) -> int:
    return len(note(dask, "started", job).read_text().splitlines())


def worker_of(dask: DaskProcesses, pid: int) -> int:
    """Return the Dask worker above a child, which it started or which its warm process forked."""
    workers = set(dask.pids())
    while pid not in workers:
        pid = int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
        assert pid > 1
    return pid


def test_a_job_is_done_by_a_worker_and_its_files_come_home(dask, server):
    machine = server()
    job = machine.ended(machine.submit(text="hello"))
    until(lambda: dask.results() == [])
    assert (job.status, job.fraction, job.attempts) == ("successful", 1.0, 1)
    assert machine.store.verified(job.key, "database").path.read_text() == "hello"
    until(lambda: not list((machine.settings.data_directory / "work").iterdir()))
    assert worker_of(dask, child(dask, machine.submit(mode="hang"))) in dask.pids()


@pytest.mark.law
def test_a_table_of_a_worker_is_that_of_this_machine_to_the_last_bit(dask, tmp_path):
    tables = []
    for name, address in (("here", None), ("dask", dask.address)):
        machine = bench(tmp_path / name, default_registry(), scheduler=address)
        machine.scheduler._crew = crew_of(
            machine.settings, default_registry(), Deployment(machine.engine, machine.store)
        )
        inputs = ANALYZE.prepare(ANALYZE.inputs.model_validate({"case": CASE}), machine.store)
        machine.scheduler.start()
        job = machine.submissions.submit("analyze", ANALYZE.key(inputs), inputs, stored=False)
        ended = machine.ended(job)
        assert ended.status == "successful", ended.message
        tables.append(SteDatabase.from_netcdf(machine.store.verified(job.key, "database").path))
        machine.close()
    for field in ("static_transmission_error", "tangent_compliance", "error_estimate", "residuals"):
        here, there = (getattr(table, field) for table in tables)
        np.testing.assert_array_equal(here, there, err_msg=field)


def test_progress_ends_and_reasons_are_those_of_a_child_here(dask, server):
    machine = server()
    hangs = machine.submit(mode="hang")
    until(lambda: machine.submissions.find(hangs.id).stage == "first")
    seen = machine.submissions.find(hangs.id)
    assert (seen.status, seen.stage_fraction, seen.fraction) == ("running", 0.5, 0.125)
    ends = {mode: machine.ended(machine.submit(mode=mode)) for mode in ("mesh", "input", "defect", "die")}
    assert {(job.status, job.attempts) for job in ends.values()} == {("failed", 1), ("failed", 2)}
    assert ends["mesh"].message == "element 7 has a negative Jacobian"
    assert ends["input"].faults[0]["field"] == "pair.pinion.bore_diameter_mm"
    assert ends["die"].message == "The worker ended early with exit code 7. That was attempt 2 of 2."
    assert SECRET not in ends["defect"].message
    log = machine.settings.data_directory / "log" / f"{ends['defect'].computation}.log"
    assert SECRET in log.read_text()


def test_a_child_over_its_memory_or_killed_ends_alone(dask, server, monkeypatch):
    monkeypatch.setattr(settlement, "MAX_LOST_RUNS", 1)
    machine, workers = server(memory_limit_mb=256, attempts=1), sorted(dask.pids())
    assert "256 MB (LOA_MEMORY_LIMIT_MB)" in machine.ended(machine.submit(mode="hog")).message
    hangs = machine.submit(mode="hang")
    os.kill(child(dask, hangs), signal.SIGKILL)
    text = "The worker was ended by SIGKILL from outside the service. So ended 1 of its runs in a row"
    assert machine.ended(hangs).message.startswith(text)
    assert sorted(dask.pids()) == workers


def test_dismissal_kills_the_child_within_half_a_second(dask, server):
    machine = server()
    job = machine.submit(mode="hang")
    pids = [child(dask, job), int(note(dask, "grandchild", job).read_text())]
    assert all(map(lives, pids))
    began = time.monotonic()
    machine.submissions.dismiss(job.id)
    machine.scheduler.wake()
    until(lambda: not any(map(lives, pids)))
    assert time.monotonic() - began < 0.5 * BUSY
    assert machine.submissions.find(job.id).status == "dismissed"
    machine.submit(mode="hang")  # equal work, for which the name of the cancelled task is none
    until(lambda: starts(dask, job) == 2)
    assert lives(child(dask, job))


def test_deadline_and_cost_limit_end_the_work(dask, server):
    machine = server(deadline_s=2.0)
    ended = machine.ended(machine.submit(mode="hang"))
    assert ended.message.startswith("The deadline of 2 s (LOA_DEADLINE_S) passed.")
    until(lambda: not lives(child(dask, ended)))


def test_a_cost_limit_ends_the_work(dask, server):
    from service.queue.terms import Terms  # noqa: PLC0415

    machine = server()
    inputs = {"wish": {"mode": "burn", "text": "", "number": 0.0}}
    key = REGISTRY["fake"].key(inputs)
    job = machine.submissions.submit("fake", key, inputs, stored=False, terms=Terms(max_cost_s=1.0))
    ended = machine.ended(job)
    assert ended.message.startswith("The limit of 1 CPU s (max_cost_s) was reached.")


def test_work_whose_worker_is_killed_is_begun_again_by_another(dask, server):
    machine = server()
    hangs, others = machine.submit(mode="hang"), [machine.submit(text=str(n)) for n in range(3)]
    first = child(dask, hangs)
    os.kill(worker_of(dask, first), signal.SIGKILL)
    began = time.monotonic()
    text = "The Dask worker that ran it was lost. Waits to be begun again, which is no attempt."
    until(lambda: machine.submissions.find(hangs.id).message == text)
    assert time.monotonic() - began < 5.0 * BUSY
    until(lambda: not lives(first))
    until(lambda: machine.submissions.find(hangs.id).stage == "first")
    assert machine.submissions.find(hangs.id).attempts == 1
    assert [machine.ended(job).status for job in others] == ["successful"] * 3


def test_work_that_ends_its_dask_workers_again_and_again_is_given_up(dask, server, monkeypatch):
    monkeypatch.setattr(settlement, "MAX_LOST_RUNS", 2)
    machine = server()
    hangs = machine.submit(mode="hang")
    os.kill(worker_of(dask, child(dask, hangs)), signal.SIGKILL)
    until(lambda: machine.submissions.find(hangs.id).status == "accepted")
    until(lambda: machine.submissions.find(hangs.id).stage == "first")
    os.kill(worker_of(dask, child(dask, hangs)), signal.SIGKILL)
    ended = machine.ended(hangs)
    assert ended.message.startswith("The Dask worker that ran it was lost. So ended 2 of its runs in a row")
    assert ended.attempts == 1


def test_a_server_that_is_started_again_finds_its_tasks(dask, server, monkeypatch):
    """Also where the table answers later than Dask: none is cancelled that may be wanted."""
    machine = server()
    hangs, slow = machine.submit(mode="hang"), machine.submit(mode="slow", text="found")
    ends = child(dask, slow)
    os.kill(ends, signal.SIGSTOP)
    pid = child(dask, hangs)
    machine.close()
    os.kill(ends, signal.SIGCONT)
    until(lambda: not lives(ends))  # its result stays
    assert machine.submissions.find(slow.id).status == "running"
    running = Claims.running
    monkeypatch.setattr(Claims, "running", lambda claims: time.sleep(2.0) or running(claims))
    again = server()
    assert (again.ended(slow).status, again.submissions.find(slow.id).attempts) == ("successful", 1)
    assert (starts(dask, slow), starts(dask, hangs), lives(pid)) == (1, 1, True)
    again.submissions.dismiss(hangs.id)
    again.scheduler.wake()
    until(lambda: not lives(pid))


def test_what_was_dismissed_while_the_server_was_away_is_cancelled(dask, server):
    machine = server()
    job = machine.submit(mode="hang")
    pid = child(dask, job)
    machine.close()
    machine.submissions.dismiss(job.id)
    assert lives(pid)
    server()
    until(lambda: not lives(pid))


@pytest.mark.law
def test_a_scheduler_that_is_lost_costs_no_job_and_no_attempt(dask, server):
    machine = server(attempts=1)
    jobs = [machine.submit(mode="slow", text=f"lost {n}") for n in range(4)]
    child(dask, jobs[0])
    dask.end_scheduler()
    until(lambda: machine.scheduler.maximum == 0)
    dask.end_workers()
    dask.start_scheduler()
    dask.start_workers(2)
    assert [machine.ended(job).status for job in jobs] == ["successful"] * 4


def test_one_worker_with_one_thread_does_a_job_and_its_parts(tmp_path):
    """The job waits for parts that it gives to the scheduler whose only thread it would hold."""
    optimize = default_registry()["optimize"]
    with dask_processes(tmp_path, 1, LOA_DATA_DIRECTORY=str(tmp_path / "data")) as alone:
        machine = bench(tmp_path / "server", default_registry(), scheduler=alone.address)
        machine.scheduler._crew = cluster.Cluster(alone.address, "alone")
        machine.scheduler.start()
        stated = optimize.inputs.model_validate_json(json.dumps({"case": CASE, **SEARCH}))
        inputs = optimize.prepare(stated, machine.store)
        job = machine.submissions.submit("optimize", optimize.key(inputs), inputs, stored=False)
        ended = machine.ended(job)
        assert ended.status == "successful", ended.message
        (keys,) = alone.run(lambda dask_worker: {str(e[0]) for e in dask_worker.state.log}).values()
        assert len([key for key in keys if "search_one" in key]) == 2
        machine.close()


# One task without a scheduler: what becomes of reports and errors.


class Future:
    """What a client returns for a task: it ends with an error, or with what was done."""

    def __init__(self, ends: Done | Exception, status: str) -> None:
        self.ends, self.status = ends, status

    def __await__(self) -> Any:
        yield from asyncio.sleep(0).__await__()
        if isinstance(self.ends, Exception):
            raise self.ends
        return self.ends


@pytest.fixture
def dropped():
    return []


@pytest.fixture
def task(tmp_path, dropped):
    order = WorkOrder("a:b", {}, "k", tmp_path, tmp_path)
    return cluster.Task("name", order, tmp_path / "log", dropped.append)


def follow(task: cluster.Task, ends: Done | Exception, status: str = "finished") -> Outcome | None:
    """Let a task end so; return its outcome, None if it is followed anew."""

    async def publish(*_, **__):
        return

    client: Any = SimpleNamespace(submit=lambda *_, **__: Future(ends, status), publish_dataset=publish)
    of_tasks = cluster.Cluster("tcp://127.0.0.1:1", "d")
    of_tasks._notify = lambda: None
    asyncio.run(of_tasks._follow(client, task))
    return task.finish() if task.ended else None


def made(*files: Path) -> Done:
    products = tuple(Product("k", "database", file) for file in files)
    return Done(Outcome(products), None, cluster.CacheReads(), (), (b"content",) * len(files), b"")


def report(begin: str) -> dict[str, Any]:
    return {"begin": begin, "age": 7.0, "spent": 1.0, "steps": []}


def test_a_second_beginning_ends_the_run_but_not_after_a_lost_scheduler(task):
    task.hear(report("one"))
    assert task.age > 6.0
    task.await_anew()
    assert task.age == 0.0  # the deadline is that of a run
    task.hear(report("two"))
    assert not task.ended
    task.hear(report("three"))
    assert task.finish() == Outcome(failure="The Dask worker that ran it was lost.", lost=True)


def test_what_breaks_in_a_transfer_is_followed_anew(task, dropped):
    assert follow(task, OSError("tcp://10.0.0.1: broken")) is None
    found = follow(task, made(Path("a.nc")))
    assert found is not None and found.products[0].file.read_bytes() == b"content"
    assert dropped == []  # Dask keeps the result until it is stored
    task.kill()
    assert dropped == ["name"]


@pytest.mark.parametrize(
    ("error", "text"),
    [
        (OSError(errno.ENOSPC, SECRET), "there is no space left in the folder of the Dask worker"),
        (RuntimeError(SECRET), "could not do it; the log of the service has the reason."),
    ],
)
def test_what_fails_on_a_worker_is_said_in_our_words(task, error, text):
    found = follow(task, error, "error")
    assert found is not None and found.died
    assert text in found.failure and SECRET not in found.failure


def test_a_full_disk_of_the_server_ends_the_job_with_that_reason(task, monkeypatch):
    def full(*_):
        raise OSError(errno.ENOSPC, SECRET)

    monkeypatch.setattr(Path, "write_bytes", full)
    found = follow(task, made(Path("a.nc")))
    assert found is not None and not found.died
    assert "no space left in the data directory of the service (LOA_DATA_DIRECTORY)" in found.failure


def test_a_worker_of_another_version_does_nothing():
    done = do_job(b"", {}, "", "lineofaction 0.0.9")
    assert done is not None and done.outcome.lost
    text = f"The Dask worker has lineofaction {solver_version()}"
    assert done.outcome.failure.startswith(text) and "the service lineofaction 0.0.9" in done.outcome.failure


# Refusals at the start.


def refused(address: str, tmp_path: Path) -> str:
    machine = bench(tmp_path, REGISTRY)
    settings = Settings(data_directory=tmp_path, scheduler=address)
    try:
        with pytest.raises(BadInput) as caught:
            crew_of(settings, REGISTRY, Deployment(machine.engine, machine.store))
    finally:
        machine.close()
    (fault,) = caught.value.faults
    assert (fault.field, fault.value) == ("scheduler", address)
    return f"{fault.bound} {fault.suggestion}"


def test_a_scheduler_that_does_not_answer_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 0.5)
    text = refused("tcp://127.0.0.1:1", tmp_path)
    assert "a Dask scheduler that answers" in text and "dask scheduler --port 1" in text


def test_a_caller_with_an_event_loop_of_its_own_is_refused_alike(tmp_path, monkeypatch):
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 0.5)

    async def called() -> str:
        return refused("tcp://127.0.0.1:1", tmp_path)

    assert "a Dask scheduler that answers" in asyncio.run(called())


def test_missing_and_other_workers_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(dask_cluster, "CONNECT_S", 0.5)
    names = tmp_path / "names" / "lineofaction-0.0.9.dist-info"
    names.mkdir(parents=True)
    (names / "METADATA").write_text("Metadata-Version: 2.1\nName: lineofaction\nVersion: 0.0.9\n")
    with dask_processes(tmp_path, 0) as found:
        text = refused(found.address, tmp_path / "data")
        assert "a scheduler with workers" in text and f"dask worker {found.address} --nthreads 1" in text
        path = f"{names.parent}{os.pathsep}{found.environment['PYTHONPATH']}"
        found.start_workers(PYTHONPATH=path)
        found.await_workers(1)
        text = refused(found.address, tmp_path / "data")
        assert f"workers with lineofaction {solver_version()}, Python 3." in text
        assert "has lineofaction 0.0.9" in text
