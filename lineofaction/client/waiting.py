"""Waiting for a job: at growing intervals, through restarts of its service."""

from __future__ import annotations

import math
import time
from asyncio import CancelledError
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from lineofaction.client.status import JobState
from lineofaction.client.steps import Pause, Steps
from lineofaction.gearbox.problems import (
    DatabaseUnavailable,
    StillRunning,
    StoreUnavailable,
    TryLater,
    Unreachable,
)

T = TypeVar("T")
AWAY = (Unreachable, DatabaseUnavailable, StoreUnavailable, TryLater)
"""Raised while a service is away or busy, which jobs outlast."""
STOPS = (KeyboardInterrupt, CancelledError)
"""Raised where the caller stops an operation."""
AWAY_PAUSE_S = 0.5
"""Before a service that was away is asked again."""
_GROWTH = 1.1
"""Of each pause over the last: what is seen late is then about a tenth of the time waited."""


@dataclass(frozen=True)
class Pace:
    """Intervals between looks at a job, and the time limit.

    Attributes
    ----------
    interval : float
        Seconds between the first two looks; the pauses grow by a tenth each.
    longest : float
        Seconds of the longest pause (or `interval`, if that is longer).
    timeout : float
        Seconds to wait at most.
    patience : float
        Seconds for which the service may be away; jobs outlast its restart.
    answered : float
        When it answered last, on the monotonic clock: it is not waited for if it never did.
    """

    interval: float
    longest: float
    timeout: float
    patience: float
    answered: float = -math.inf

    def longer(self, pause: float) -> float:
        """Return the pause after a pause."""
        return max(min(pause * _GROWTH, self.longest), self.interval)


def ended(job: str, look: Callable[[], Steps[JobState]], pace: Pace) -> Steps[JobState]:
    """Return the state in which a job ended.

    Raises
    ------
    StillRunning
        It did not end within the time; it continues.
    ServiceError
        What `look` raises; that the service is away, only if it has never answered or not for too long.
    """
    try:
        return (yield from _ended(job, look, pace))
    except STOPS as stop:
        note_continuing(stop, job)
        raise


def note_continuing(error: BaseException, job: str) -> None:
    """Note on an error, once, that it does not end a job."""
    note = f"Job {job} continues at the service. Repeat the request to join it."
    if note not in getattr(error, "__notes__", ()):
        error.add_note(note)


def outlasting(once: Callable[[], Steps[T]], patience: float) -> Steps[T]:
    """Return what `once` returns, which is run again while the service is away, for `patience` seconds."""
    begin = time.monotonic()
    while True:
        try:
            return (yield from once())
        except AWAY:
            if time.monotonic() - begin > patience:
                raise
        yield Pause(AWAY_PAUSE_S)


def _ended(job: str, look: Callable[[], Steps[JobState]], pace: Pace) -> Steps[JobState]:
    begin, answered, pause = time.monotonic(), pace.answered, pace.interval
    while True:
        try:
            state = yield from look()
            if state.ended:
                return state
            answered = time.monotonic()
        except AWAY:
            if time.monotonic() - answered > pace.patience:
                raise
        left = pace.timeout - (time.monotonic() - begin)
        if left <= 0.0:
            text = f"Job {job} did not end within {pace.timeout:g} s. It continues; check again later."
            raise StillRunning(text)
        yield Pause(min(pause, left))
        pause = pace.longer(pause)
