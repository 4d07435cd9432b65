"""The service with fake work as a process of its own.

Started as ``python fake_process.py DESCRIPTOR``: the socket to listen on, which its parent keeps, so that the
address outlives the process. Settings come from the environment. It loads none of the libraries that compute.
"""

import signal
import socket
import sys

import structlog
from service_fakes import REGISTRY

from lineofaction.cli.connections import http_server
from lineofaction.gearbox.problems import BadInput, DatabaseUnavailable
from service import app as application
from service.settings import load_settings


def serve(descriptor: int) -> None:
    application.warm_up = lambda: None
    app = application.create_app(load_settings(), REGISTRY)
    signal.signal(signal.SIGTERM, lambda _number, _frame: sys.exit(0))  # raised again when all is shut down
    with socket.socket(fileno=descriptor) as listener:
        http_server(app).run(sockets=[listener])


def main() -> None:
    """Serve; a database or Dask workers that are gone at the start are no defect."""
    structlog.configure(logger_factory=structlog.PrintLoggerFactory(sys.stderr))
    try:
        serve(int(sys.argv[1]))
    except (BadInput, DatabaseUnavailable) as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
