"""The filter of a list of jobs (OGC API - Processes 1.0, clause 12.2)."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Protocol

from sqlalchemy import ColumnElement

from service.queue.job import job_state
from service.queue.label import labeled
from service.queue.tables import computations, jobs


class Timed(Protocol):
    """A computation that has begun or ended, RFC 3339."""

    @property
    def started(self) -> str | None:
        """When it began."""

    @property
    def finished(self) -> str | None:
        """When it ended."""


@dataclass(frozen=True)
class JobFilter:
    """Conditions that a job has to meet.

    Attributes
    ----------
    processes, statuses : tuple[str, ...]
        One of these; empty: any.
    earliest, latest : str or None
        Of its creation, RFC 3339 in UTC with microseconds.
    shortest_s, longest_s : float or None
        Of the time it has run; a job that has not begun has none.
    tags, words : tuple[str, ...]
        All of these tags; all of these words in the title, in any case.
    parent : str or None
        The batch whose jobs are wanted; None: batches, and jobs of none.
    """

    processes: tuple[str, ...] = ()
    statuses: tuple[str, ...] = ()
    earliest: str | None = None
    latest: str | None = None
    shortest_s: float | None = None
    longest_s: float | None = None
    tags: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    parent: str | None = None

    def conditions(self) -> list[ColumnElement[bool]]:
        """Return what the database decides: all but the time run."""
        within = jobs.c.parent.is_(None) if self.parent is None else jobs.c.parent == self.parent
        conditions = [within, *labeled(self.tags, self.words)]
        if self.processes:
            conditions.append(computations.c.process.in_(self.processes))
        if self.statuses:
            conditions.append(job_state().in_(self.statuses))
        if self.earliest is not None:
            conditions.append(jobs.c.created >= self.earliest)
        if self.latest is not None:
            conditions.append(jobs.c.created <= self.latest)
        return conditions

    @property
    def asks_duration(self) -> bool:
        """Whether jobs have to be looked at one by one."""
        return self.shortest_s is not None or self.longest_s is not None

    def lasted(self, job: Timed) -> bool:
        """Whether the time a job has run is within bounds."""
        if not self.asks_duration:
            return True
        if job.started is None:
            return False
        end = datetime.now(UTC) if job.finished is None else datetime.fromisoformat(job.finished)
        seconds = (end - datetime.fromisoformat(job.started)).total_seconds()
        low = 0.0 if self.shortest_s is None else self.shortest_s
        return low <= seconds and (self.longest_s is None or seconds <= self.longest_s)


EVERY_JOB = JobFilter()
