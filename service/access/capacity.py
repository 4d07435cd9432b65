"""Limits of callers: requests of one caller per minute and at the same time, and the capacity for all."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Lock

import structlog

from host import max_open_files
from lineofaction.gearbox.problems import BadInput, TooManyHeld, TooManyRequests
from service.access.holder import Holder
from service.access.quotas import Quota

_RETRY_S = 1
NOBODY = ""
"""Name of the holder that stands for all callers without a key."""

logger = structlog.get_logger(__name__)
_MINUTE_S = 60.0
_MAX_CONNECTIONS = 800
_MIN_CONNECTIONS = 32
_OTHER_FILES = 192
"""Kept for all else: up to four files in each of the 40 threads of handlers, pipes to workers, the rest."""
_FILES_OF_A_WORKER = 4
RAISE = "Raise the limit of the process (ulimit -n, LimitNOFILE= of systemd)."


class Usage:
    """Counts of one kind by the names of their holders, in one event loop of one server process.

    Parameters
    ----------
    what : str
        The kind, plural.
    in_all : int, optional
        Most of all holders together.
    """

    def __init__(self, what: str, in_all: int | None = None) -> None:
        self._what, self._in_all, self._counts = what, in_all, Counter[str]()

    def number(self, name: str) -> int:
        """Return the number that a holder has in use."""
        return self._counts[name]

    def refuse_beyond(self, name: str, maximum: int | None) -> None:
        """Raise `TooManyHeld` if a holder has `maximum`, `TooManyRequests` if all together have theirs."""
        if maximum is not None and self._counts[name] >= maximum:
            subject = "Callers without a key hold" if name == NOBODY else f"Key {name!r} holds"
            text = f"{subject} {maximum} {self._what}, the limit. End one of them, or try again."
            raise TooManyHeld.after(_RETRY_S, text)
        if self._in_all is not None and self._counts.total() >= self._in_all:
            raise TooManyRequests(f"There are {self._in_all} {self._what} in all. Try again soon.")

    @contextmanager
    def one(self, name: str) -> Iterator[None]:
        """Hold one more while the context lasts."""
        self._counts[name] += 1
        try:
            yield
        finally:
            self._counts[name] -= 1
            if not self._counts[name]:
                del self._counts[name]


class RateLimits:
    """The buckets of all keys, in the memory of one server process.

    `clock`: seconds, steady; replaced by tests.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = Lock()
        self._left: dict[str, tuple[float, float]] = {}

    def wait_s(self, key: Holder) -> int:
        """Take one request out of the bucket of a holder; return 0, or the seconds until there is one."""
        limit = key.requests_per_minute
        if limit is None:
            return 0
        with self._lock:
            left, instant = self._level(key.name, limit)
            granted = left >= 1.0
            self._left[key.name] = (left - 1.0 if granted else left, instant)
        return 0 if granted else math.ceil((1.0 - left) * _MINUTE_S / limit)

    def quota(self, key: Holder) -> Quota | None:
        """Return the quota of a holder and its remainder; None: no limit."""
        limit = key.requests_per_minute
        if limit is None:
            return None
        with self._lock:
            left, _ = self._level(key.name, limit)
        full_s = math.ceil((limit - left) * _MINUTE_S / limit)
        return Quota("requests", limit, int(left), window_s=int(_MINUTE_S), full_s=full_s)

    def _level(self, name: str, limit: int) -> tuple[float, float]:
        """Return the requests in a bucket now, and the instant."""
        instant = self._clock()
        left, last = self._left.get(name, (float(limit), instant))
        return min(limit, left + (instant - last) * limit / _MINUTE_S), instant


@dataclass(frozen=True)
class Capacity:
    """Capacity of one server process.

    `connections`: most open HTTP connections with requests under way.
    """

    connections: int = _MAX_CONNECTIONS

    @property
    def comfortable_connections(self) -> int:
        """The number of connections beyond which the connection that has been idle for longest is closed."""
        return self.connections * 5 // 8

    @property
    def requests(self) -> int:
        """Requests answered at once, and bodies awaited at once."""
        return self.connections // 2

    @property
    def share(self) -> int:
        """Requests of one caller answered at once, and bodies awaited, where its key says nothing else."""
        return self.requests // 4


def capacity(workers: int) -> Capacity:
    """Return the capacity of this process next to its worker processes.

    Raises `BadInput`: it may open too few files to serve at all.
    """
    files = max_open_files()
    reserved = _OTHER_FILES + _FILES_OF_A_WORKER * workers
    if files - reserved < _MIN_CONNECTIONS:
        bound = (
            f"at least {reserved + _MIN_CONNECTIONS}, and {reserved + _MAX_CONNECTIONS} for all connections"
        )
        raise BadInput.of("open files", int(files), bound, RAISE)
    bearable = Capacity(int(min(files - reserved, _MAX_CONNECTIONS)))
    if bearable.connections < _MAX_CONNECTIONS:
        limits = {"connections": bearable.connections, "requests": bearable.requests, "share": bearable.share}
        logger.warning("limits lowered", open_files=int(files), **limits, remedy=RAISE)
    return bearable
