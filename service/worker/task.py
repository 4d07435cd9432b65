"""A job as the task of a Dask worker, which starts the same child process for it as a server does."""

from __future__ import annotations

import os
import select
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
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
_LOOK_S, _TELL_S = 0.1, 0.5
"""Seconds between two looks whether the job is still wanted, and between two reports."""
_LOG_BYTES = 1_000_000
_launchers: list[Launcher] = []
_launching = threading.Lock()


@dataclass(frozen=True)
class Done:
    """End of a job on a worker: outcome and use of its child, the files of its products, its log."""

    outcome: Outcome
    usage: Usage | None
    compliance_reads: CacheReads
    warnings: tuple[str, ...]
    contents: tuple[bytes, ...]
    log: bytes


@cache
def program() -> str:
    """Return the versions that server and workers must share, and the missing packages."""
    needed = (*MODULES["analysis"], *MODULES["service"])
    missing = [name for name in needed if find_spec(name) is None]
    lacks = f" without {', '.join(missing)}" if missing else ""
    return f"lineofaction {solver_version()}, Python {'.'.join(python_version_tuple()[:2])}{lacks}"


def do_job(line: bytes, files: Mapping[str, bytes], topic: str, expected_program: str) -> Done | None:
    """Do an order in a child process, with the contents of the stored results it reads; None: it is unwanted.

    Events of the topic report how far it is. A worker of another `program` than the wanted one does nothing.
    """
    if program() != expected_program:
        text = (
            f"The Dask worker has {program()}, the service {expected_program}: start workers of that version."
        )
        return Done(Outcome(failure=text, lost=True), None, CacheReads(), (), (), b"")
    from distributed import get_worker  # noqa: PLC0415 (an extra)

    worker = get_worker()
    with TemporaryDirectory(prefix="job-", dir=worker.local_directory) as name:
        folder = Path(name)
        order = _local_order(WorkOrder.from_line(line), files, folder, worker)
        launch = partial(_launch, order.entry.partition(":")[0], Path(worker.local_directory) / "warm.log")
        child = Worker(order, folder / "log", launch)
        try:
            if not _followed(child, order, worker, topic):
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
    of_worker = machine_memory_mb() if limit is None else int(limit / BYTES_PER_MB)
    return replace(
        order,
        workspace=folder / "work",
        data_directory=data,
        scheduler=worker.scheduler.address,
        stored={key: folder / "stored" / key for key in files},
        memory_limit_mb=order.memory_limit_mb or max(MIN_MEMORY_MB, of_worker // worker.state.nthreads),
    )


def _launch(module: str, log: Path, ends: Ends) -> ChildProcess:
    """Fork from the warm process of this worker; its threads take turns."""
    with _launching:
        if not _launchers:
            modules = [module, "service.worker.simulation_work"]
            _launchers.append(Launcher(WORK, modules, log, logger.warning))
        return _launchers[0].launch(ends)


def _followed(child: Worker, order: WorkOrder, worker: distributed.Worker, topic: str) -> bool:
    """Report until the child ends; whether it did, and was wanted until then."""
    from distributed import secede  # noqa: PLC0415 (an extra)

    key, tell = worker.get_current_task(), _Telling(worker, topic, child)
    seceded = False
    while True:
        select.select([child.channel], [], [], _LOOK_S)
        steps, ended = child.listen()
        tell(steps, key)
        if ended:
            return True
        if not _wanted(worker, key):
            return False
        if not seceded and (order.workspace / PARTS).exists():
            secede()  # type: ignore[no-untyped-call]  # its thread does parts of jobs now, of this one too
            seceded = True


def _wanted(worker: distributed.Worker, key: Any) -> bool:
    task = worker.state.tasks.get(key)
    running = task is not None and task.state in ("executing", "long-running")
    return running and worker.status.name not in ("closing", "closed", "failed")


class _Telling:
    """Reports by events of Dask: steps, age and cost of a child, at most every `_TELL_S`."""

    def __init__(self, worker: distributed.Worker, topic: str, child: Worker) -> None:
        self._tell: Callable[[Any], None] = partial(worker.log_event, topic)
        self._child, self._steps, self._reported = child, list[Step](), 0.0
        self._begin = f"{child.pid} {time.time()} {worker.address}"

    def __call__(self, steps: list[Step], key: Any) -> None:
        self._steps += steps
        if time.monotonic() - self._reported < _TELL_S:
            return
        message = {"task": key, "begin": self._begin, "age": self._child.age, "spent": self._child.spent()}
        self._tell(message | {"steps": [list(step) for step in self._steps]})
        self._steps, self._reported = [], time.monotonic()
