"""The watcher of jobs of a process, which notifies all followers of a job when its state changes."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field
from typing import Generic, TypeVar

import structlog
from sqlalchemy import Engine, case, func, select

from service.queue.job import AHEAD, Job, job_of, jobs_of_all_projects, mark_of
from service.queue.tables import computations, jobs
from service.store.database import reading
from service.store.dialects import dialect_of

REST_S = 0.2
"""Least seconds between two looks at the table, however often it changes."""
NET_S = 5.0
"""Seconds after which the table is read without notice of a commit: a dead connection brings no notice."""
_RETRY_S = 1.0
"""Seconds between attempts to reach a lost database."""

T = TypeVar("T")
Follower = Callable[[T | None], None]
logger = structlog.get_logger(__name__)


@dataclass
class _Followed(Generic[T]):
    """A job, the mark of its last known state, and its followers."""

    mark: str
    followers: list[Follower[T]] = field(default_factory=list)


class Watcher(Generic[T]):
    """Follows jobs in a thread that runs while there are followers, and waits for a lost database.

    `show` makes the state that followers get from a job; it is called once for all followers of the job.
    """

    def __init__(self, engine: Engine, show: Callable[[Job], T]) -> None:
        self._engine, self._show = engine, show
        self._jobs: dict[str, _Followed[T]] = {}
        self._lock, self._stopped = threading.Lock(), threading.Event()
        self._thread: threading.Thread | None = None
        self._new = False  # whether a follower joined since the last look

    @contextmanager
    def following(self, job: Job, follower: Follower[T]) -> Iterator[None]:
        """Call `follower` with each state after that of `job`, and with None at the end.

        It is called in the watcher's thread. States that follow each other within `REST_S` may be one.
        """
        with self._lock:
            followed = self._jobs.setdefault(job.id, _Followed(job.mark))
            if (
                followed.mark != job.mark
            ):  # of two followers one may be notified twice, but none misses a change
                followed.mark = ""
            followed.followers.append(follower)
            self._new = True
            if self._thread is None:
                self._stopped.clear()
                self._thread = threading.Thread(target=self._loop, name="watcher", daemon=True)
                self._thread.start()
        try:
            yield
        finally:
            with self._lock:
                followed.followers.remove(follower)
                if not followed.followers and self._jobs.get(job.id) is followed:
                    del self._jobs[job.id]

    def stop(self) -> None:
        """Notify all followers of the end (None), and end the thread."""
        with self._lock:
            thread = self._thread
            self._stopped.set()
            self._tell(list(self._jobs), None)
        if thread is not None:
            thread.join(_RETRY_S)  # it may wait for a database that is away

    def _loop(self) -> None:
        """Watch while followers exist; a failed look is repeated."""
        while self._goes_on():
            try:
                self._look()
                with closing(dialect_of(self._engine).commits(self._engine)) as commits:
                    self._look()  # commits before notices of commits were received
                    looked = time.monotonic()
                    while self._jobs and not self._stopped.is_set():
                        if commits.received() or self._new or time.monotonic() - looked > NET_S:
                            self._look()
                            looked = time.monotonic()
                            self._stopped.wait(REST_S)
            except Exception as error:  # noqa: BLE001 (the database may be back soon)
                logger.warning("jobs not watched", error=type(error).__name__)
                self._stopped.wait(_RETRY_S)

    def _goes_on(self) -> bool:
        """Whether anybody follows; if not, the next follower starts another thread."""
        with self._lock:
            if self._jobs and not self._stopped.is_set():
                return True
            self._thread = None
            return False

    def _look(self) -> None:
        """Notify the followers of jobs that changed or are gone."""
        self._new = False
        with self._lock:
            known = {identifier: followed.mark for identifier, followed in self._jobs.items()}
        instant = func.coalesce(jobs.c.dismissed, computations.c.updated)
        ahead = case((jobs.c.dismissed.is_(None), AHEAD))
        statement = select(jobs.c.id, instant, ahead).join(computations).where(jobs.c.id.in_(known))
        with reading(self._engine) as connection:
            marks = {row[0]: mark_of(row[1], row[2]) for row in connection.execute(statement)}
        changed = [identifier for identifier in marks if marks[identifier] != known[identifier]]
        for job in self._read(changed):
            state = self._show(job)
            with self._lock:
                if job.id in self._jobs:
                    self._jobs[job.id].mark = job.mark
                self._tell([job.id], state)
        with self._lock:
            gone = known.keys() - marks.keys()
            self._tell(gone, None)
            for identifier in gone:  # its followers are notified of the end once, not at every look
                self._jobs.pop(identifier, None)

    def _tell(self, identifiers: Collection[str], state: T | None) -> None:
        """Call the followers of jobs with a state; the caller has the lock."""
        for identifier in identifiers:
            if identifier in self._jobs:
                for follower in self._jobs[identifier].followers:
                    follower(state)

    def _read(self, identifiers: Collection[str]) -> list[Job]:
        if not identifiers:
            return []
        statement = jobs_of_all_projects().where(jobs.c.id.in_(identifiers))
        with reading(self._engine) as connection:
            return [job_of(row) for row in connection.execute(statement)]
