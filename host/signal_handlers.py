"""Signal handlers that a library changes as it starts."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Sequence
from contextlib import contextmanager


@contextmanager
def handlers_kept(names: Sequence[str]) -> Iterator[None]:
    """Restore the handlers of signals afterwards, by their names; a system may lack some of them."""
    handlers = {name: signal.getsignal(getattr(signal, name)) for name in names if hasattr(signal, name)}
    yield
    for name, handler in handlers.items():
        signal.signal(getattr(signal, name), handler)
