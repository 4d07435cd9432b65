"""Requests per minute by key: a bucket that fills steadily and holds a minute's worth."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from threading import Lock

from service.access.holder import Holder

_MINUTE_S = 60.0


class RateLimits:
    """The buckets of all keys, in the memory of one server process.

    Parameters
    ----------
    clock : callable
        Seconds, steady; replaced by tests.
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
        instant = self._clock()
        with self._lock:
            left, last = self._left.get(key.name, (float(limit), instant))
            left = min(limit, left + (instant - last) * limit / _MINUTE_S)
            taken = left >= 1.0
            self._left[key.name] = (left - 1.0 if taken else left, instant)
        return 0 if taken else math.ceil((1.0 - left) * _MINUTE_S / limit)
