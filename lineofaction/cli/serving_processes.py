"""Serving processes on one socket, and the scheduler of their jobs in the process that starts them."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import signal
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess

import structlog
from prometheus_client import generate_latest
from prometheus_client.multiprocess import MultiProcessCollector, mark_process_dead

from host import child_environment
from lineofaction.cli.program_end import Work, at_stop, managed
from lineofaction.gearbox.problems import Unexpected
from service.directory_lock import DirectoryLock
from service.management.figures import process_registry
from service.management.vitals import Vitals
from service.queue.machinery import Machinery, job_machinery
from service.queue.scheduler import Scheduler
from service.routes.warm_up import HEAVY
from service.settings import Settings
from service.store.deployment import Deployment
from service.store.write_check import WriteCheck
from service.worker.process import default_registry

logger = structlog.get_logger(__name__)
MIN_LIFE_S = 5.0
"""Seconds before a process that ended soon after its start is replaced: the cause may be gone by then."""
STOPPING_S = 3.5
"""Seconds after which serving processes that do not stop are killed."""
_LOOK_S = 0.2
"""Seconds between two looks at the processes and the scheduler."""
_APPLICATION = "service.app"
_METRICS = "PROMETHEUS_MULTIPROC_DIR"
"""Environment variable of prometheus-client that names the folder of the figures of all processes."""


def _management_port(
    settings: Settings, machinery: Machinery, metrics: str
) -> AbstractContextManager[Callable[[], None]]:
    """Return a context in which the management port is open; its value is a function that announces the port.

    The port answers with the figures of all processes, which are in the folder `metrics`.
    """
    engine, store, scheduler = machinery.engine, machinery.store, machinery.scheduler
    writes = WriteCheck(Deployment(engine, store))
    registry = process_registry(engine, store, writes, scheduler, settings)
    MultiProcessCollector(registry, path=metrics)  # type: ignore[no-untyped-call]
    return managed(settings, Vitals(scheduler, writes), partial(generate_latest, registry))


def _until_stopped() -> threading.Event:
    """Return an event that SIGTERM and SIGINT set."""
    stopped = threading.Event()
    at_stop(lambda _number, _frame: stopped.set())
    return stopped


def serve_in_processes(settings: Settings, serve: Work, announce: Work) -> None:
    """Let `settings.processes` processes `serve` until SIGTERM or SIGINT, with their scheduler here.

    `announce` is called when the first of them are started. Raises `BadInput`, `DatabaseUnavailable`,
    `StoreUnavailable` as `job_machinery`, before a process is started; `Unexpected`: the scheduler died: the
    service has to be started again.
    """
    stopped = _until_stopped()
    lock = DirectoryLock(settings.data_directory)
    lock.acquire()
    metrics = tempfile.mkdtemp(prefix="loa-metrics-")
    # a fork server has the environment of the process that starts it
    os.environ.update(child_environment(**{_METRICS: metrics}))
    try:
        machinery = job_machinery(settings, default_registry())
        scheduler = machinery.scheduler
        assert scheduler is not None
        with closing(machinery), _management_port(settings, machinery, metrics) as announce_port:
            processes = ServingProcesses(settings.processes, serve)
            scheduler.start()
            announce()
            announce_port()
            _supervise(processes, scheduler, stopped)
    finally:
        lock.release()
        shutil.rmtree(metrics, ignore_errors=True)
    if not stopped.is_set():
        raise Unexpected("scheduler")


def _supervise(processes: ServingProcesses, scheduler: Scheduler, stopped: threading.Event) -> None:
    """Keep the processes alive until `stopped`, or the scheduler is dead; then stop all."""
    try:
        while not stopped.is_set() and scheduler.alive:
            processes.replace_dead()
            processes.wait(_LOOK_S)
    finally:
        processes.terminate()
        scheduler.stop()
        processes.join()


@dataclass
class ServingProcesses:
    """Processes that answer requests."""

    number: int
    """Number of processes that are to run."""
    serve: Work
    """Work of each process until it is stopped."""
    _alive: list[BaseProcess] = field(default_factory=list)
    _starts: deque[float] = field(default_factory=deque)

    def replace_dead(self) -> None:
        """Start the missing processes, but not more than `number` of them within `MIN_LIFE_S`."""
        for process in [process for process in self._alive if not process.is_alive()]:
            logger.warning("serving process ended", pid=process.pid, code=process.exitcode)
            mark_process_dead(process.pid, os.environ[_METRICS])  # type: ignore[no-untyped-call]
            self._alive.remove(process)
        while len(self._alive) < self.number:
            if len(self._starts) == self.number and time.monotonic() < self._starts[0] + MIN_LIFE_S:
                return
            self._starts = deque([*self._starts, time.monotonic()], maxlen=self.number)
            self._alive.append(self._started())

    def _started(self) -> BaseProcess:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload([_APPLICATION, *HEAVY])
        process = context.Process(target=self.serve)
        process.start()
        logger.info("serving process started", pid=process.pid)
        return process

    def wait(self, longest_s: float) -> None:
        """Wait until a process ends, or for so long."""
        wait([process.sentinel for process in self._alive], longest_s)

    def terminate(self) -> None:
        """Ask all to stop."""
        for process in self._alive:
            process.terminate()

    def join(self) -> None:
        """Wait until all processes have stopped; kill processes that take too long."""
        end = time.monotonic() + STOPPING_S
        for process in self._alive:
            process.join(max(end - time.monotonic(), 0.0))
            if process.is_alive():
                logger.warning("serving process killed", pid=process.pid)
                process.kill()


def end_with_parent() -> None:
    """Let this process stop when the supervising process has ended, however that ended."""

    def stop_after_parent() -> None:
        parent = multiprocessing.parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=stop_after_parent, name="parent", daemon=True).start()
