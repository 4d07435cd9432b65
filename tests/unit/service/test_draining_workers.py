"""A worker of Dask that is told to end finishes its job first."""

import os
import signal
import time

import pytest
from dask_processes import DaskProcesses, dask_processes
from running_service import PATIENCE_S, bench, until
from service_fakes import REGISTRY

from service.queue import cluster
from service.queue.job import Job

pytest.importorskip("distributed", reason="the extra dask is not installed")

PRELOAD = "service.worker.draining"


@pytest.fixture
def dask(tmp_path):
    with dask_processes(tmp_path, 0, LOA_DATA_DIRECTORY=str(tmp_path / "data")) as running:
        running.start_workers(nanny=False, preload=PRELOAD)
        running.await_workers(1)
        yield running


@pytest.fixture
def server(dask, tmp_path):
    made = bench(tmp_path / "server", REGISTRY, scheduler=dask.address)
    made.scheduler._crew = cluster.Cluster(dask.address, "draining")
    made.scheduler.start()
    yield made
    made.close()


def starts(dask: DaskProcesses, job: Job) -> int:
    file = dask.folder / "data" / f"started_{job.key[:8]}"
    return len(file.read_text().splitlines()) if file.exists() else 0


@pytest.mark.law
def test_a_worker_that_is_told_to_end_finishes_its_job_and_begins_no_other(dask, server):
    (worker,) = dask.workers
    job = server.submit(mode="slow", text="one")
    until(lambda: starts(dask, job) == 1)
    os.kill(worker.pid, signal.SIGTERM)
    other = server.submit(mode="slow", text="other")
    ended = server.ended(job)
    assert (ended.status, ended.attempts, starts(dask, job)) == ("successful", 1, 1)
    assert worker.wait(timeout=PATIENCE_S) == 0
    assert starts(dask, other) == 0
    dask.start_workers(nanny=False, preload=PRELOAD)
    assert server.ended(other).status == "successful"
    assert starts(dask, other) == 1


def test_a_worker_without_a_job_leaves_at_once_and_a_second_signal_ends_one_with_a_job(dask, server):
    (first,) = dask.workers
    dask.start_workers(nanny=False, preload=PRELOAD)
    dask.await_workers(2)
    first.send_signal(signal.SIGTERM)
    assert first.wait(timeout=PATIENCE_S) == 0
    second = dask.workers[-1]
    job = server.submit(mode="hang")
    until(lambda: starts(dask, job) == 1)
    second.send_signal(signal.SIGTERM)
    until(lambda: "worker drains" in (dask.folder / "worker_1.log").read_text())
    time.sleep(0.5)
    assert second.poll() is None, "its job hangs"
    second.send_signal(signal.SIGTERM)
    assert second.wait(timeout=PATIENCE_S) == -signal.SIGTERM
    server.submissions.dismiss(job.id)
