"""The end of a serving program by a signal, and its management port, where the settings have one."""

from __future__ import annotations

import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from types import FrameType

from service.management.server import ManagementServer
from service.management.vitals import Vitals
from service.settings import Settings

Work = Callable[[], None]
"""Function that a process runs; it is pickled on the way to the process."""


@contextmanager
def managed(settings: Settings, vitals: Vitals, metrics: Callable[[], bytes]) -> Iterator[Callable[[], None]]:
    """Answer on the management port in the context; yields a function that prints its URL, if it has one.

    Raises `BadInput`: the port is taken.
    """
    if settings.management_port is None:
        yield lambda: None
        return
    with ManagementServer(settings.management_host, settings.management_port, vitals, metrics) as server:
        yield partial(print, f"lineofaction tells its health at {server.address}", flush=True)


def at_stop(heed: Callable[[int, FrameType | None], None]) -> None:
    """Have a function called at SIGTERM and SIGINT."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, heed)
