"""``loa serve``: the server, in one process or several, and its log.

Serving processes are forked from a process that has loaded the libraries, which they share. All accept
connections of the one socket, so that none is lost when one of them dies.
"""

from __future__ import annotations

import logging
import os
import socket
import sys
from functools import partial
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

import structlog

from host.directories import keep_private
from lineofaction.cli.program_end import at_stop, managed
from lineofaction.cli.serving_processes import end_with_parent, serve_in_processes
from lineofaction.gearbox.problems import BadInput
from service.access.capacity import capacity
from service.access.identities import open_identities
from service.reading.reader import require_confinement
from service.settings import Settings, load_settings, note_former_settings

if TYPE_CHECKING:
    from lineofaction.cli.connections import Server

logger = structlog.get_logger(__name__)


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


def _leave() -> NoReturn:
    """End this process with success, without the cleanup of the interpreter.

    The cleanup frees module after module, for 0.7 CPU s once both libraries are loaded: several seconds on a
    machine with twenty busy processes, in which a supervisor waits.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(0)


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
            serve_in_processes(settings, partial(_serve, settings, listener), partial(_announce, listener))
            _leave()
        server = _server(settings)
        at_stop(_stopped)
        with managed(settings, server.vitals, server.metrics) as announce_management:
            _announce(listener)
            announce_management()
            server.run(sockets=[listener])


def _serve(settings: Settings, listener: socket.socket) -> None:
    """Serve as one of several processes, until stopped or until the one that supervises them is gone."""
    at_stop(_stopped)
    end_with_parent()
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
