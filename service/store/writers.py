"""The writers of one SQLite file in this process, which take turns in the order of their arrival.

SQLite lets one writer in at a time, and every other tries again after a pause: which of many is next is
chance, and some never are. In a queue a writer waits only for those before it. Between processes SQLite's
lock still decides, but at most one writer of each process tries.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from threading import Lock

from sqlalchemy.exc import SQLAlchemyError


class TurnTimeout(SQLAlchemyError):
    """A writer's turn has not come within its patience."""


class WriterQueue:
    """The queue of writers for all threads of a process: one writes, the others wait."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._occupied = False
        self._waiting: deque[Lock] = deque()
        """A lock of each writer that waits, which is freed when its turn comes."""

    @contextmanager
    def turn(self, patience_s: float, *, ahead: bool = False) -> Iterator[float]:
        """Wait for the turn, and hold it in the context; yield the rest of the patience, s.

        With `ahead` this writer is the next one. Raises `TurnTimeout`: no turn within `patience_s`.
        """
        end = time.monotonic() + patience_s
        self._enter(patience_s, ahead)
        try:
            yield max(end - time.monotonic(), 0.0)
        finally:
            self._leave()

    def _enter(self, patience_s: float, ahead: bool) -> None:
        with self._lock:
            if not self._occupied:
                self._occupied = True
                return
            signal = Lock()  # taken until `_leave` frees it
            signal.acquire()
            (self._waiting.appendleft if ahead else self._waiting.append)(signal)
        if not signal.acquire(timeout=patience_s):
            self._give_up(signal)

    def _give_up(self, signal: Lock) -> None:
        """Leave the queue, unless the turn has come at the last moment."""
        with self._lock:
            if signal in self._waiting:
                self._waiting.remove(signal)
                raise TurnTimeout("Others write, and have not ended in time.")

    def _leave(self) -> None:
        """Let the next one write."""
        with self._lock:
            if self._waiting:
                self._waiting.popleft().release()
            else:
                self._occupied = False


@cache
def writers_of(file: str) -> WriterQueue:
    """Return the queue of a file, the same for all that open it in this process."""
    return WriterQueue()
