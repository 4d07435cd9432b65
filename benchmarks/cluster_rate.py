"""Cost of a task for a Dask scheduler: workers sleep as long as a task of a table computes."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.figures import Figure
from benchmarks.service_process import cpu_seconds
from model_studies.workers import ByDask, dask_workers

SUBJECT = "20 000 tasks by workers that sleep 0.3 s"
TARGET = 0.5
"""CPU time of the scheduler for a task, ms."""
CLUSTERS = (64, 512)
_TASKS = 20_000
_TASK_S = 0.3
"""CPU time of a task of a table of ten alignments (`shared_table`), s."""
_WORKERS = """
import asyncio, dask, sys
from distributed import Worker
dask.config.set({"distributed.admin.tick.interval": "1h", "distributed.worker.profile.enabled": False})
dask.config.set({"distributed.admin.system-monitor.interval": "1h"})
async def work(address, count):
    quiet = {"nthreads": 1, "memory_limit": 0, "dashboard": False}
    workers = [await Worker(address, name=str(number), **quiet) for number in range(count)]
    await asyncio.gather(*(worker.finished() for worker in workers))
asyncio.run(work(sys.argv[1], int(sys.argv[2])))
"""
"""Program of one process whose threads are workers. They sleep and do not watch themselves: two cores are
enough for 512 of them.
"""
_PATIENCE_S = 120.0
"""Longest time that a cluster takes to start, s."""


@dataclass(frozen=True)
class Rate:
    """Cost of all tasks of one cluster: CPU seconds of its scheduler and of the caller, wall seconds."""

    scheduler: float
    caller: float
    wall: float


def figures() -> list[Figure]:
    """Return the cost of a task to scheduler and caller, and where more workers cease to help."""
    return [figure for count in CLUSTERS for figure in _figures(count, measured(count))]


def _figures(count: int, rate: Rate) -> Iterator[Figure]:
    limit = TARGET if count == CLUSTERS[-1] else None
    yield Figure(SUBJECT, f"{count} workers: scheduler", 1e3 * rate.scheduler / _TASKS, "ms a task", limit)
    yield Figure(SUBJECT, f"{count} workers: caller", 1e3 * rate.caller / _TASKS, "ms a task")
    ideal = _TASKS * _TASK_S / count
    yield Figure(SUBJECT, f"{count} workers: wall time over that of sleep alone", rate.wall / ideal, "-")
    saturated = _TASK_S * _TASKS / rate.scheduler
    yield Figure(SUBJECT, f"workers that keep such a scheduler busy, by {count}", saturated, "-")


def measured(count: int) -> Rate:
    """Run all tasks on a cluster of that many workers."""
    with _cluster(count) as (workers, scheduler):
        before = cpu_seconds(scheduler), time.process_time(), time.perf_counter()
        results = list(workers.run(_sleep, _TASK_S, range(_TASKS)))
        after = cpu_seconds(scheduler), time.process_time(), time.perf_counter()
    if results != list(range(_TASKS)):
        raise RuntimeError("results are not those of the tasks, in their order")
    return Rate(*(end - begin for begin, end in zip(before, after, strict=True)))


def _sleep(seconds: float, item: int) -> int:
    time.sleep(seconds)
    return item


@contextmanager
def _cluster(count: int) -> Iterator[tuple[ByDask, int]]:
    """Provide a cluster of that many workers, and the process id of its scheduler."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as ends:
        file = Path(folder) / "scheduler.json"
        options = ["--no-dashboard", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", str(file)]
        scheduler = ends.enter_context(_started("-m", "dask", "scheduler", *options))
        _wait_for(lambda: file.exists() and file.stat().st_size > 0, scheduler)
        address = json.loads(file.read_text("utf-8"))["address"]
        sleepers = ends.enter_context(_started("-c", _WORKERS, address, str(count)))
        workers = dask_workers(address)
        ends.enter_context(workers.client)
        _wait_for(lambda: len(workers.client.nthreads()) >= count, sleepers)  # type: ignore[no-untyped-call]
        yield workers, scheduler.pid


@contextmanager
def _started(*words: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run Python on words; end it with the block, whatever it does."""
    process = subprocess.Popen([sys.executable, *words], stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(timeout=30.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _wait_for(ready: Callable[[], bool], process: subprocess.Popen[bytes]) -> None:
    """Wait until a process has made something ready; it may end or take too long."""
    started = time.monotonic()
    while not ready():
        if process.poll() is not None or time.monotonic() - started > _PATIENCE_S:
            raise RuntimeError(
                f"the cluster did not start within {_PATIENCE_S:g} s, or a process of it ended"
            )
        time.sleep(0.1)
