"""The status of a job, as the client reports it."""

from __future__ import annotations

import math
import time
from asyncio import CancelledError
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

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
"""Errors while a service is away or busy, which jobs outlast."""
STOPS = (KeyboardInterrupt, CancelledError)
"""Exceptions by which the caller stops an operation."""
AWAY_PAUSE_S = 0.5
"""Seconds before a service that was away is asked again."""
_GROWTH = 1.1
"""Ratio of a pause to the pause before: the end of a job is then seen late by about a tenth of the time
waited."""


@dataclass(frozen=True)
class JobState:
    """State of a job."""

    id: str
    process: str
    status: str
    message: str
    stage: str
    """`id`, `process`, `status`, `message`, `stage`: Members of the service's status document of these names.
    """
    progress: int
    """Progress of the whole job in per cent."""
    stage_progress: int
    """Progress of the stage in per cent."""
    warnings: tuple[dict[str, Any], ...] = ()
    """Implausible inputs: check, field, value, unit, message; empty in lists of jobs."""
    created: str = ""
    started: str = ""
    finished: str = ""
    """`created`, `started`, `finished`: RFC 3339, UTC; empty before."""
    title: str = ""
    tags: tuple[str, ...] = ()
    """Tags that the submission gave the job."""
    subject: str = ""
    """Subject of the job in words."""
    differences: tuple[dict[str, Any], ...] = ()
    """The first inputs that differ from the inputs of the caller's job before it of the same process, or from
    the defaults: field, before, value.
    """
    priority: int = 0
    remaining_s: float | None = None
    """Seconds that a running job still needs, by its pace; None: not known."""
    ahead: int | None = None
    """Number of computations before a job that waits, those that run included; None: it does not wait."""
    parent: str = ""
    """The batch that the job is in; empty: none."""
    place: int = 0
    children: int = 0
    """`place`, `children`: Place in the batch; number of jobs of a batch."""

    @property
    def ended(self) -> bool:
        """Whether the job has ended."""
        return self.status in ("successful", "failed", "dismissed")

    @property
    def activity(self) -> str:
        """The job's present activity: its stage while it runs, else waits, done, failed or dismissed."""
        if self.status == "running":
            return self.stage or "starts"
        if self.ahead:
            return f"waits behind {self.ahead} job{'' if self.ahead == 1 else 's'}"
        return {"accepted": "waits", "successful": "done"}.get(self.status, self.status)

    @property
    def time_left(self) -> str:
        """The time that a running job still needs, as ``12 s left``; empty if it is not known."""
        seconds = self.remaining_s
        if seconds is None or self.ended:
            return ""
        minutes = round(seconds / 60.0)
        if seconds < 100.0:
            return f"{seconds:.0f} s left"
        return f"{minutes} min left" if minutes < 100 else f"{minutes / 60.0:.1f} h left"

    def __str__(self) -> str:
        """Return a line: ``analyze: contact, 58 %, 12 s left``."""
        running = (f"{self.progress} %", self.time_left) if self.status == "running" else ()
        return ", ".join(part for part in (f"{self.process}: {self.activity}", *running) if part)

    @classmethod
    def cached(cls, process: str) -> JobState:
        """Return the state of a result from the client's cache; it is no job of the service."""
        return cls("", process, "successful", "Taken from the cache.", "", 100, 100)

    @classmethod
    def from_json(cls, document: dict[str, Any]) -> JobState:
        """Read a status document."""
        names = ("status", "message", "stage", "progress", "stage_progress")
        warnings = tuple(document.get("warnings") or ())
        known: dict[str, Any] = {name: document[name] for name in names}
        known |= {
            name: document.get(name) or "" for name in ("created", "started", "finished", "title", "subject")
        }
        known |= {"priority": document.get("priority", 0)}
        known |= {"tags": tuple(document.get("tags") or ())}
        known |= {"differences": tuple((document.get("differences") or {}).get("first", ()))}
        known |= {name: document.get(name) for name in ("remaining_s", "ahead")}
        known |= {"parent": document.get("parentID") or ""}
        known |= {name: document.get(name, 0) for name in ("place", "children")}
        return cls(document["jobID"], document["processID"], **known, warnings=warnings)


Watch = Callable[[JobState], None]
"""A function that is called with every state of a job that is seen."""


@dataclass(frozen=True)
class Result:
    """Address of a result: its content hash, its kind (the name of the output), its path on the service."""

    key: str
    kind: str
    href: str

    @classmethod
    def from_json(cls, document: dict[str, Any]) -> Result:
        """Read the one result of a job."""
        ((kind, reference),) = document.items()
        return cls(reference["hash"], kind, reference["href"])


class OfflineWarning(UserWarning):
    """A result is from the cache because no service answers."""


@dataclass(frozen=True)
class Pace:
    """Intervals between looks at a job, and the time limit."""

    interval: float
    """Seconds between the first two looks; the pauses grow by a tenth each."""
    longest: float
    """Seconds of the longest pause (or `interval`, if that is longer)."""
    timeout: float
    """Seconds to wait at most."""
    patience: float
    """Seconds for which the service may be away; jobs outlast its restart."""
    answered: float = -math.inf
    """When it answered last, on the monotonic clock: it is not waited for if it never did."""

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
    begin, answered, pause = time.monotonic(), pace.answered, pace.interval
    try:
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
    except STOPS as stop:
        note_continuing(stop, job)
        raise


def note_continuing(error: BaseException, job: str) -> None:
    """Note on an error, once, that it does not end a job."""
    note = f"Job {job} continues at the service. Repeat the request to join it."
    if note not in getattr(error, "__notes__", ()):
        error.add_note(note)


def outlasting(once: Callable[[], Steps[T]], patience: float) -> Steps[T]:
    """Return the value of `once`, which runs again while the service is away, for `patience` seconds."""
    begin = time.monotonic()
    while True:
        try:
            return (yield from once())
        except AWAY:
            if time.monotonic() - begin > patience:
                raise
        yield Pause(AWAY_PAUSE_S)
