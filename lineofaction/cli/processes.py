"""Programs that run for long: their log and management port, ``loa work``, several serving processes.

Serving processes are forked from a process that has loaded the libraries, which they share. All accept
connections of the one socket, so that none is lost when one of them dies.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, closing, contextmanager
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import wait
from multiprocessing.process import BaseProcess
from types import FrameType

import structlog
from prometheus_client import generate_latest
from prometheus_client.multiprocess import MultiProcessCollector, mark_process_dead

from host import child_environment
from host.directories import keep_private
from lineofaction.cli.guard import leave
from lineofaction.gearbox.problems import Unexpected
from service.management.figures import process_registry
from service.management.server import ManagementServer, Vitals
from service.queue.machinery import Machinery, job_machinery
from service.queue.scheduler import Scheduler
from service.routes.warm_up import HEAVY
from service.settings import Settings, load_settings
from service.store import DirectoryLock
from service.store.database import shown
from service.store.deployment import Deployment, WriteCheck
from service.tracing.tracer import tracer
from service.worker.cluster import RemoteWork
from service.worker.process import default_registry


def log_to_standard_error() -> None:
    """Write one line of JSON per event to standard error."""
    structlog.configure(
        processors=[
            structlog.contextvars.merge_contextvars,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            structlog.processors.format_exc_info,
            structlog.processors.JSONRenderer(),
        ],
        logger_factory=structlog.PrintLoggerFactory(sys.stderr),
    )
    logging.basicConfig(level=logging.WARNING, stream=sys.stderr)


# The management port of a program, where the settings have one.


@contextmanager
def managed(settings: Settings, vitals: Vitals, metrics: Callable[[], bytes]) -> Iterator[str | None]:
    """Answer on the management port while the context lasts; yields its URL, None without one.

    Raises
    ------
    BadInput
        The port is taken.
    """
    if settings.management_port is None:
        yield None
        return
    with ManagementServer(settings.management_host, settings.management_port, vitals, metrics) as server:
        yield server.address


def announce_management(address: str | None) -> None:
    """Print where it is, below the line of the program itself."""
    if address is not None:
        print(f"lineofaction tells its health at {address}", flush=True)  # noqa: T201 (command line)


# ``loa work``.


def run_work(**options: object) -> None:
    """Run jobs until stopped by SIGTERM or SIGINT; workers end with the scheduler."""
    settings = load_settings(**options)
    keep_private()
    log_to_standard_error()
    lock = DirectoryLock(settings.data_directory)
    lock.acquire()
    stopped = threading.Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    try:
        _work(settings, stopped)
    finally:
        lock.release()
    leave()


def _work(settings: Settings, stopped: threading.Event) -> None:
    """Run jobs until `stopped`."""
    with closing(job_machinery(settings, default_registry())) as machinery:
        engine, store, scheduler = machinery.engine, machinery.store, machinery.scheduler
        writes = WriteCheck(Deployment(engine, store))
        registry = process_registry(engine, store, writes, scheduler, settings)
        with managed(settings, Vitals(scheduler, writes), partial(generate_latest, registry)) as where:
            scheduler.start()
            try:
                print(f"lineofaction works for {shown(engine)}", flush=True)  # noqa: T201 (command line)
                announce_management(where)
                stopped.wait()
            finally:
                scheduler.stop()
                tracer().flush()


# Several serving processes on one socket, and beside them the scheduler of their jobs.


LEAST_LIFE_S = 5.0
"""Processes that end earlier are replaced only after so long: what they lack may be there by then."""
STOPPING_S = 3.5
"""After which serving processes that do not stop are killed."""
_LOOK_S = 0.2
_APPLICATION = "service.app"
_METRICS = "PROMETHEUS_MULTIPROC_DIR"
"""Where prometheus-client keeps the figures of all processes, by its own name."""

Work = Callable[[], None]
"""What a process does; pickled on the way to it."""

logger = structlog.get_logger(__name__)


def serve_in_processes(settings: Settings, works: bool, serve: Work, announce: Work) -> None:
    """Let `settings.processes` processes `serve` until SIGTERM or SIGINT; if it `works`, a scheduler here.

    `announce` is called when the first of them are started.

    Raises
    ------
    BadInput, DatabaseUnavailable, StoreUnavailable
        As `job_machinery`, before a process is started.
    Unexpected
        The scheduler died: the service has to be started again.
    """
    stopped = threading.Event()

    def stop(_number: int, _frame: FrameType | None) -> None:
        stopped.set()

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    lock = DirectoryLock(settings.data_directory)
    if works:
        lock.acquire()
    metrics = tempfile.mkdtemp(prefix="loa-metrics-")
    os.environ.update(child_environment(**{_METRICS: metrics}))
    try:
        machinery = job_machinery(settings, default_registry(), works=works)
        with closing(machinery), _managed(settings, machinery, metrics) as where:
            processes = ServingProcesses(settings.processes, serve)
            machinery.scheduler.start()
            announce()
            announce_management(where)
            _supervise(processes, machinery.scheduler, stopped)
    finally:
        lock.release()
        shutil.rmtree(metrics, ignore_errors=True)
    if not stopped.is_set():
        raise Unexpected("scheduler")


def _managed(settings: Settings, machinery: Machinery, metrics: str) -> AbstractContextManager[str | None]:
    """Return the management port: health of the scheduler, sums of the figures in the folder `metrics`."""
    engine, store, scheduler = machinery.engine, machinery.store, machinery.scheduler
    writes = WriteCheck(Deployment(engine, store))
    registry = process_registry(engine, store, writes, scheduler, settings)
    MultiProcessCollector(registry, path=metrics)  # type: ignore[no-untyped-call]
    return managed(settings, Vitals(scheduler, writes), partial(generate_latest, registry))


def _supervise(
    processes: ServingProcesses, scheduler: Scheduler | RemoteWork, stopped: threading.Event
) -> None:
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
    """Processes that answer requests.

    Attributes
    ----------
    number : int
        How many there are to be.
    serve : callable
        What each does until it is stopped.
    """

    number: int
    serve: Work
    _alive: list[BaseProcess] = field(default_factory=list)
    _starts: deque[float] = field(default_factory=deque)

    def replace_dead(self) -> None:
        """Start what is missing; `number` starts are at least `LEAST_LIFE_S` apart."""
        for process in [process for process in self._alive if not process.is_alive()]:
            logger.warning("serving process ended", pid=process.pid, code=process.exitcode)
            mark_process_dead(process.pid, os.environ[_METRICS])  # type: ignore[no-untyped-call]
            self._alive.remove(process)
        while len(self._alive) < self.number:
            if len(self._starts) == self.number and time.monotonic() < self._starts[0] + LEAST_LIFE_S:
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
        """Wait until all have stopped; kill those that take too long."""
        end = time.monotonic() + STOPPING_S
        for process in self._alive:
            process.join(max(end - time.monotonic(), 0.0))
            if process.is_alive():
                logger.warning("serving process killed", pid=process.pid)
                process.kill()


def end_with_parent() -> None:
    """Let this process stop when the supervising process has ended, however that ended."""

    def heed() -> None:
        parent = multiprocessing.parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=heed, name="parent", daemon=True).start()
