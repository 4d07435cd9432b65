"""Limits of callers: requests of one caller per minute and at the same time, and the capacity for all.

A holder is a key of access, or `KEYLESS` for all callers without a key. Requests per minute are limited by a
bucket for each holder: it is refilled at the rate of the limit up to the limit, and a request takes one out.
"""

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
"""Seconds after which a refused caller may try again."""
KEYLESS = ""
"""Name of the holder that stands for all callers without a key."""

logger = structlog.get_logger(__name__)
_MINUTE_S = 60.0
_MAX_CONNECTIONS = 800
"""Largest number of connections of a server process, however many files it may open."""
_MIN_CONNECTIONS = 32
"""Least number of connections with which a server starts."""
_OTHER_FILES = 192
"""Open files that are no connections: up to four in each of the 40 threads of handlers, and others."""
_FILES_OF_A_WORKER = 4
"""Open files of a server process for each of its worker processes."""
RAISE = "Raise the limit of the process (ulimit -n, LimitNOFILE= of systemd)."


class Usage:
    """Counts of one kind by the names of their holders, in one event loop of one server process.

    Parameters
    ----------
    what : str
        Name of the kind, plural, in messages.
    in_all : int, optional
        Largest number of all holders together; None: no limit.
    """

    def __init__(self, what: str, in_all: int | None = None) -> None:
        self._what, self._in_all, self._counts = what, in_all, Counter[str]()

    def number(self, name: str) -> int:
        """Return the number that a holder has in use."""
        return self._counts[name]

    def refuse_beyond(self, name: str, maximum: int | None) -> None:
        """Raise `TooManyHeld` if a holder has `maximum`, `TooManyRequests` if all together have `in_all`."""
        if maximum is not None and self._counts[name] >= maximum:
            subject = "Callers without a key hold" if name == KEYLESS else f"Key {name!r} holds"
            text = f"{subject} {maximum} {self._what}, the limit. End one of them, or try again."
            raise TooManyHeld.after(_RETRY_S, text)
        if self._in_all is not None and self._counts.total() >= self._in_all:
            raise TooManyRequests(f"There are {self._in_all} {self._what} in all. Try again soon.")

    @contextmanager
    def one(self, name: str) -> Iterator[None]:
        """Count one more in use by a holder while the context lasts."""
        self._counts[name] += 1
        try:
            yield
        finally:
            self._counts[name] -= 1
            if not self._counts[name]:
                del self._counts[name]


class RateLimits:
    """The buckets of all keys, in the memory of one server process.

    `clock` returns seconds that never fall; tests replace it.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._lock = Lock()
        self._left: dict[str, tuple[float, float]] = {}  # by name: requests left, and the instant, s

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
        """Return the number of requests in a bucket now, and the instant, s; a new bucket is full."""
        instant = self._clock()
        left, last = self._left.get(name, (float(limit), instant))
        return min(limit, left + (instant - last) * limit / _MINUTE_S), instant


@dataclass(frozen=True)
class Capacity:
    """Capacity of one server process; the other limits are shares of its connections."""

    connections: int = _MAX_CONNECTIONS
    """Largest number of open HTTP connections with requests under way."""

    @property
    def comfortable_connections(self) -> int:
        """The number of connections beyond which the one that was idle for the longest time is closed."""
        return self.connections * 5 // 8

    @property
    def requests(self) -> int:
        """Largest number of requests that are answered, and of bodies that are awaited, at the same time."""
        return self.connections // 2

    @property
    def share(self) -> int:
        """Largest number of requests of one caller at the same time, by default: a key may state its own."""
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
