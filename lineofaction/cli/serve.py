"""``loa serve``."""

from __future__ import annotations

import asyncio
import signal
import socket
from functools import partial
from types import FrameType
from typing import NoReturn

import uvicorn
from fastapi import FastAPI

from host.directories import keep_private
from lineofaction.cli.bounded_http import BoundedHttp
from lineofaction.cli.interrupt import leave
from lineofaction.cli.log import log_to_standard_error
from lineofaction.cli.managed import announce_management, managed
from lineofaction.cli.serving_processes import end_with_parent, serve_in_processes
from lineofaction.gearbox.problems import BadInput
from service.access import open_identities
from service.access.capacity import capacity
from service.app import create_app
from service.management.vitals import EventLoop, Vitals
from service.routes.context import Context
from service.settings import Settings, load_settings

_STOPPING_S = 2
_KEPT_S = 75
"""How long an idle connection is kept: longer than by clients (5 s) and proxies (60 s). If the server closed
first, a request that is on its way just then would be answered with a reset."""


def run_serve(*, works: bool = True, **options: object) -> None:
    """Serve until stopped by SIGTERM or SIGINT; workers, if it `works`, end with it."""
    settings = load_settings(**options)
    keep_private()
    log_to_standard_error()
    open_identities(settings)  # refused before a socket is opened
    with _listener(settings) as listener:
        if settings.processes > 1:
            capacity(settings.workers if works else 0)  # refused before a process is started
            serve_in_processes(
                settings, works, partial(_serve, settings, listener), partial(_announce, listener)
            )
            leave()
        app = create_app(settings, works=works)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, _stopped)
        server = http_server(app)
        with managed(settings, server.vitals, app.state.metrics.text) as where:
            _announce(listener)
            announce_management(where)
            server.run(sockets=[listener])


def _serve(settings: Settings, listener: socket.socket) -> None:
    """Serve as one of several processes, until stopped or until the one that supervises them is gone."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _stopped)
    end_with_parent()
    log_to_standard_error()
    http_server(create_app(settings, works=False)).run(sockets=[listener])


def http_server(app: FastAPI) -> _Server:
    """Return the server of an app."""
    config = uvicorn.Config(
        app,
        http=BoundedHttp,
        ws="none",
        log_config=None,
        access_log=False,
        timeout_graceful_shutdown=_STOPPING_S,
        timeout_keep_alive=_KEPT_S,
        lifespan="on",
    )
    return _Server(config, app.state.context)


class _Server(uvicorn.Server):
    """Tells those who wait for a live answer at once that the service stops; the rest have time to end.

    Attributes
    ----------
    vitals : Vitals
        Of the process that it serves in.
    """

    def __init__(self, config: uvicorn.Config, context: Context) -> None:
        super().__init__(config)
        self._context, self._loop = context, EventLoop()
        self.vitals = Vitals(context.scheduler, context.writes, self._loop.fault)

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Begin to serve."""
        self._loop.loop = asyncio.get_running_loop()
        await super().startup(sockets)

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """End the workers that somebody waits for, then what uvicorn ends."""
        await asyncio.to_thread(self._context.stop_waiting)
        await super().shutdown(sockets)


def _announce(listener: socket.socket) -> None:
    """Print the address; who reads it may connect, and is answered as soon as the app has started."""
    listener.listen()
    host, port = listener.getsockname()[:2]
    name = f"[{host}]" if ":" in host else host
    print(f"lineofaction serves at http://{name}:{port}", flush=True)  # noqa: T201 (this is the command line)


def _stopped(_number: int, _frame: FrameType | None) -> NoReturn:
    """End with success: uvicorn raises the signal again after it has shut everything down."""
    leave()


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
