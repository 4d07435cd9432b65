"""The server, ``loa serve``: in one process or several; its log and management port.

Serving processes are forked from a process that has loaded the libraries, which they share. All accept
connections of the one socket, so that none is lost when one of them dies.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import shutil
import signal
import socket
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
from typing import TYPE_CHECKING, NoReturn

import structlog
from prometheus_client import generate_latest
from prometheus_client.multiprocess import MultiProcessCollector, mark_process_dead

from host import child_environment
from host.directories import keep_private
from lineofaction.gearbox.problems import BadInput, Unexpected
from service.access.capacity import capacity
from service.access.identities import open_identities
from service.folders import DirectoryLock
from service.management.figures import process_registry
from service.management.server import ManagementServer, Vitals
from service.queue.scheduler import Machinery, Scheduler, job_machinery
from service.reading.reader import require_confinement
from service.routes.warm_up import HEAVY
from service.settings import Settings, load_settings, note_former_settings
from service.store.deployment import Deployment, WriteCheck
from service.worker.process import default_registry

if TYPE_CHECKING:
    from lineofaction.cli.connections import Server

logger = structlog.get_logger(__name__)
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
def _managed(
    settings: Settings, vitals: Vitals, metrics: Callable[[], bytes]
) -> Iterator[Callable[[], None]]:
    """Answer on the management port while the context lasts; yields what prints its URL, if there is one.

    Raises `BadInput`: the port is taken.
    """
    if settings.management_port is None:
        yield lambda: None
        return
    with ManagementServer(settings.management_host, settings.management_port, vitals, metrics) as server:
        yield partial(print, f"lineofaction tells its health at {server.address}", flush=True)


def _managed_work(
    settings: Settings, machinery: Machinery, sums: str
) -> AbstractContextManager[Callable[[], None]]:
    """Return the management port of the scheduler; `sums`: the folder of the figures of all processes."""
    engine, store, scheduler = machinery.engine, machinery.store, machinery.scheduler
    writes = WriteCheck(Deployment(engine, store))
    registry = process_registry(engine, store, writes, scheduler, settings)
    MultiProcessCollector(registry, path=sums)  # type: ignore[no-untyped-call]
    return _managed(settings, Vitals(scheduler, writes), partial(generate_latest, registry))


def _at_stop(heed: Callable[[int, FrameType | None], None]) -> None:
    """Have a function called at SIGTERM and SIGINT."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, heed)


def _until_stopped() -> threading.Event:
    """Return what is set at SIGTERM and SIGINT."""
    stopped = threading.Event()
    _at_stop(lambda _number, _frame: stopped.set())
    return stopped


def _leave() -> NoReturn:
    """End a process with success whose work is done, without the interpreter's own end.

    That frees module after module, for 0.7 CPU s once both libraries are loaded: several seconds beside
    twenty busy processes, in which a supervisor waits.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


# ``loa serve``.


def run_serve(**options: object) -> None:
    """Serve until stopped by SIGTERM or SIGINT; workers end with it."""
    settings = load_settings(**options)
    keep_private()
    log_to_standard_error()
    note_former_settings()
    open_identities(settings)  # refused before a socket is opened
    if settings.require_confinement:
        require_confinement()
    with _listener(settings) as listener:
        if settings.processes > 1:
            capacity(settings.workers)  # refused before a process is started
            _serve_in_processes(settings, partial(_serve, settings, listener), partial(_announce, listener))
            _leave()
        server = _server(settings)
        _at_stop(_stopped)
        with _managed(settings, server.vitals, server.metrics) as announce_management:
            _announce(listener)
            announce_management()
            server.run(sockets=[listener])


def _serve(settings: Settings, listener: socket.socket) -> None:
    """Serve as one of several processes, until stopped or until the one that supervises them is gone."""
    _at_stop(_stopped)
    _end_with_parent()
    log_to_standard_error()
    _server(settings, works=False).run(sockets=[listener])


def _server(settings: Settings, *, works: bool = True) -> Server:
    """Return the server of this process."""
    from lineofaction.cli.connections import http_server  # noqa: PLC0415 (start-up time)
    from service.app import create_app  # noqa: PLC0415 (start-up time)

    return http_server(create_app(settings, works=works))


def _announce(listener: socket.socket) -> None:
    """Print the address; who reads it may connect, and is answered as soon as the app has started."""
    listener.listen()
    host, port = listener.getsockname()[:2]
    name = f"[{host}]" if ":" in host else host
    print(f"lineofaction serves at http://{name}:{port}", flush=True)  # noqa: T201 (this is the command line)


def _stopped(_number: int, _frame: FrameType | None) -> NoReturn:
    """End with success: uvicorn raises the signal again after it has shut everything down."""
    _leave()


def _listener(settings: Settings) -> socket.socket:
    """Return a socket bound to the address, so that a port in use is reported before anything starts."""
    family, kind, protocol, _, address = socket.getaddrinfo(
        settings.host, settings.port, type=socket.SOCK_STREAM
    )[0]
    listener = socket.socket(family, kind, protocol)
    listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listener.bind(address)
    except OSError as error:
        listener.close()
        suggestion = f"{error.strerror}. Choose another with --port, or 0 for a free one."
        raise BadInput.of("port", settings.port, "a free port", suggestion) from None
    return listener


# Several serving processes on one socket, and beside them the scheduler of their jobs.


def _serve_in_processes(settings: Settings, serve: Work, announce: Work) -> None:
    """Let `settings.processes` processes `serve` until SIGTERM or SIGINT, with their scheduler here.

    `announce` is called when the first of them are started. Raises `BadInput`, `DatabaseUnavailable`,
    `StoreUnavailable` as `job_machinery`, before a process is started; `Unexpected`: the scheduler died: the
    service has to be started again.
    """
    stopped = _until_stopped()
    lock = DirectoryLock(settings.data_directory)
    lock.acquire()
    metrics = tempfile.mkdtemp(prefix="loa-metrics-")
    os.environ.update(child_environment(**{_METRICS: metrics}))
    try:
        machinery = job_machinery(settings, default_registry())
        scheduler = machinery.scheduler
        assert scheduler is not None
        with closing(machinery), _managed_work(settings, machinery, metrics) as announce_management:
            processes = ServingProcesses(settings.processes, serve)
            scheduler.start()
            announce()
            announce_management()
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
    """How many there are to be."""
    serve: Work
    """What each does until it is stopped."""
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


def _end_with_parent() -> None:
    """Let this process stop when the supervising process has ended, however that ended."""

    def heed() -> None:
        parent = multiprocessing.parent_process()
        assert parent is not None
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)

    threading.Thread(target=heed, name="parent", daemon=True).start()
