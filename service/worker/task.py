"""A job as the task of a Dask worker, which starts the same child process for it as a server does.

A job is wanted as long as the scheduler of Dask has its task with this worker: a server cancels the task of a
job that nobody needs.
"""

from __future__ import annotations

import os
import select
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path
from platform import python_version_tuple
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import structlog

from fe_contact.cache_reads import CacheReads
from host.children.launcher import ChildProcess, Ends, Launcher
from host.directories import data_home
from host.extras import MODULES
from service.settings import MIN_MEMORY_MB
from service.version import solver_version
from service.worker.order import PARTS, Outcome, WorkOrder
from service.worker.usage import BYTES_PER_MB, Usage, machine_memory_mb
from service.worker.worker import WORK, Step, Worker

if TYPE_CHECKING:
    import distributed

logger = structlog.get_logger(__name__)
_CHECK_S, _REPORT_S = 0.1, 0.5
"""Seconds between two checks whether the job is still wanted, and least seconds between two reports."""
_LOG_BYTES = 1_000_000
"""Largest part of the log, from its end, that is sent to the server."""
_launchers: list[Launcher] = []
"""The launcher of this worker process, which all its threads share; empty before the first job."""
_launching = threading.Lock()
"""Lock of a thread that starts the launcher or a child."""


@dataclass(frozen=True)
class Done:
    """End of a job on a worker, as it is sent to the server."""

    outcome: Outcome
    usage: Usage | None = None
    """CPU time and memory that the child used; None: no child was started."""
    compliance_reads: CacheReads = field(default_factory=CacheReads)
    warnings: tuple[str, ...] = ()
    contents: tuple[bytes, ...] = ()
    """Contents of the files of the products, in the order of `outcome.products`."""
    log: bytes = b""
    """End of the child's log."""


@cache
def program() -> str:
    """Return the versions that server and workers must share, and the missing packages."""
    needed = (*MODULES["analysis"], *MODULES["service"])
    missing = [name for name in needed if find_spec(name) is None]
    lacks = f" without {', '.join(missing)}" if missing else ""
    return f"lineofaction {solver_version()}, Python {'.'.join(python_version_tuple()[:2])}{lacks}"


def do_job(line: bytes, files: Mapping[str, bytes], topic: str, wanted: str) -> Done | None:
    """Run an order in a child process and return its end; None: the job is no longer wanted.

    `line` is the order as text. `files` are the contents, by key, of the stored results that the job reads.
    Events under `topic` report its progress. `wanted` is the `program` of the server: a worker of another one
    runs nothing and returns a failure.
    """
    if program() != wanted:
        text = f"The Dask worker has {program()}, the service {wanted}: start workers of that version."
        return Done(Outcome(failure=text, lost=True))
    from distributed import get_worker  # noqa: PLC0415 (an extra)

    worker = get_worker()
    with TemporaryDirectory(prefix="job-", dir=worker.local_directory) as name:
        folder = Path(name)
        order = _local_order(WorkOrder.from_line(line), files, folder, worker)
        launch = partial(_launch, order.entry.partition(":")[0], Path(worker.local_directory) / "warm.log")
        child = Worker(order, folder / "log", launch)
        try:
            if not _awaited(child, order, worker, topic):
                return None
            outcome = child.finish()
        finally:
            child.kill()
        contents = tuple(product.file.read_bytes() for product in outcome.products)
        log = (folder / "log").read_bytes()[-_LOG_BYTES:]
        return Done(outcome, child.usage, child.compliance_reads, tuple(child.warnings), contents, log)


def _local_order(
    order: WorkOrder, files: Mapping[str, bytes], folder: Path, worker: distributed.Worker
) -> WorkOrder:
    """Return an order with folders of this machine, and its share of the memory of the worker."""
    for part in ("work", "stored"):
        (folder / part).mkdir()
    for key, content in files.items():
        (folder / "stored" / key).write_bytes(content)
    data = Path(os.environ.get("LOA_DATA_DIRECTORY") or data_home())
    data.mkdir(mode=0o700, parents=True, exist_ok=True)
    limit = worker.memory_manager.memory_limit
    worker_memory_mb = machine_memory_mb() if limit is None else int(limit / BYTES_PER_MB)
    share_mb = max(MIN_MEMORY_MB, worker_memory_mb // worker.state.nthreads)
    return replace(
        order,
        workspace=folder / "work",
        data_directory=data,
        scheduler=worker.scheduler.address,
        stored={key: folder / "stored" / key for key in files},
        memory_limit_mb=order.memory_limit_mb or share_mb,
    )


def _launch(module: str, log: Path, ends: Ends) -> ChildProcess:
    """Start a child by the launcher of this worker, a process with loaded modules; one thread at a time."""
    with _launching:
        if not _launchers:
            modules = [module, "service.worker.simulation_work"]
            _launchers.append(Launcher(WORK, modules, log, logger.warning))
        return _launchers[0].launch(ends)


def _awaited(child: Worker, order: WorkOrder, worker: distributed.Worker, topic: str) -> bool:
    """Report progress until the child ends, and return True; return False once the job is not wanted."""
    from distributed import secede  # noqa: PLC0415 (an extra)

    key, reports = worker.get_current_task(), _Reports(worker, topic, child)
    seceded = False
    while True:
        select.select([child.channel], [], [], _CHECK_S)
        steps, ended = child.listen()
        reports.add(steps, key)
        if ended:
            return True
        if not _wanted(worker, key):
            return False
        if not seceded and (order.workspace / PARTS).exists():
            # the job is split into tasks: its thread is free to do some of them, or others
            secede()
            seceded = True


def _wanted(worker: distributed.Worker, key: Any) -> bool:
    """Return whether Dask still has the task with this worker, and the worker goes on."""
    task = worker.state.tasks.get(key)
    running = task is not None and task.state in ("executing", "long-running")
    return running and worker.status.name not in ("closing", "closed", "failed")


class _Reports:
    """Reports by events of Dask: steps, age and cost of a child, at most one every `_REPORT_S`."""

    def __init__(self, worker: distributed.Worker, topic: str, child: Worker) -> None:
        self._send: Callable[[Any], None] = partial(worker.log_event, topic)
        self._child, self._steps, self._reported = child, list[Step](), 0.0
        self._begin = f"{child.pid} {time.time()} {worker.address}"  # identifies this run of the task

    def add(self, steps: list[Step], key: Any) -> None:
        """Add steps to the next report, and send it if it is due."""
        self._steps += steps
        if time.monotonic() - self._reported < _REPORT_S:
            return
        message = {"task": key, "begin": self._begin, "age": self._child.age, "spent": self._child.spent()}
        self._send(message | {"steps": [list(step) for step in self._steps]})
        self._steps, self._reported = [], time.monotonic()
