"""The service with fake work as processes of their own: all in one, serving only, or working only.

Started as ``python fake_process.py ROLE [DESCRIPTOR]``: DESCRIPTOR is the socket to listen on, which its
parent keeps, so that the address outlives the process. Settings come from the environment. None of them loads
the libraries that compute.
"""

from __future__ import annotations

import signal
import socket
import sys
import threading
from importlib import import_module
from importlib.util import find_spec

import structlog
from service_fakes import REGISTRY

from service.folders import DirectoryLock
from service.queue.scheduler import job_machinery
from service.settings import load_settings

OLD = find_spec("service.cli") is not None
"""Of 0.2 and before: the service was all that there was."""
DatabaseUnavailable = import_module(
    "service.problems" if OLD else "lineofaction.gearbox.problems"
).DatabaseUnavailable


def serve(works: bool, descriptor: int) -> None:
    http_server = import_module("service.cli.serve" if OLD else "lineofaction.cli.connections").http_server
    from service import app as application  # noqa: PLC0415 (start-up time: working needs no web framework)

    application.warm_up = lambda: None
    app = application.create_app(load_settings(), REGISTRY, works=works)
    signal.signal(signal.SIGTERM, lambda _number, _frame: sys.exit(0))  # raised again when all is shut down
    with socket.socket(fileno=descriptor) as listener:
        http_server(app).run(sockets=[listener])


def work() -> None:
    settings, stopped = load_settings(), threading.Event()
    DirectoryLock(settings.data_directory).acquire()
    signal.signal(signal.SIGTERM, lambda _number, _frame: stopped.set())
    machinery = job_machinery(settings, REGISTRY)
    machinery.scheduler.start()
    stopped.wait()
    machinery.scheduler.stop()
    machinery.close()


def main() -> None:
    """Do as the arguments say; a database that is gone at the start is no defect."""
    structlog.configure(logger_factory=structlog.PrintLoggerFactory(sys.stderr))
    try:
        if sys.argv[1] == "work":
            work()
        else:
            serve(sys.argv[1] == "all", int(sys.argv[2]))
    except DatabaseUnavailable as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
