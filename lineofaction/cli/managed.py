"""The management port of a program, where the settings have one."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from service.management.server import ManagementServer
from service.management.vitals import Vitals
from service.settings import Settings


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
