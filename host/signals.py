"""Signals of a process: its end after a time, and handlers that a library replaces.

Few imports: a child that answers one request needs nothing else of the host.
"""

from __future__ import annotations

import signal
from contextlib import contextmanager

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


def end_after(seconds: int) -> None:
    """End this process after so many seconds, whatever it does then."""
    alarm = getattr(signal, "alarm", None)
    if alarm is not None:
        alarm(seconds)
        return
    from host import windows  # noqa: PLC0415 (the system without alarms alone needs it)

    windows.end_after(seconds)


@contextmanager
def handlers_restored(names: Sequence[str]) -> Iterator[None]:
    """Restore the handlers of signals afterwards, by their names; a system may lack some of them."""
    handlers = {name: signal.getsignal(getattr(signal, name)) for name in names if hasattr(signal, name)}
    yield
    for name, handler in handlers.items():
        signal.signal(getattr(signal, name), handler)
