"""The callers' side of the job table: submit, look, list, dismiss."""

from __future__ import annotations

import json
import uuid
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, Connection, Engine, func, insert, select, update

from service.problems import BadInput, NoSuchJob, QueueFull
from service.project import COMMON, address_of
from service.queue.caller import ANYBODY, Caller
from service.queue.cost_limit import extended
from service.queue.durations import end_computations
from service.queue.job import ENDED, Job, job_of, select_jobs
from service.queue.job_filter import EVERY_JOB, JobFilter
from service.queue.label import Label
from service.queue.priority import raised
from service.queue.tables import computations, jobs
from service.queue.terms import USUAL, Terms
from service.store import BRIEF_MS, Mark, behind, instant, now, optional, reading, retried, writing
from service.store.results import USE_NOTED_EVERY_S
from service.tracing.traceparent import TRACEPARENT
from service.version import solver_version

_LOOKED_AT = 500  # at a time, where durations are requested


class Submissions:
    """Jobs as the callers of one project see them.

    Parameters
    ----------
    engine : Engine
    queue_limit : int
        Computations of all projects that may wait.
    project : str
        There are no jobs but those of this project.
    """

    def __init__(self, engine: Engine, queue_limit: int, project: str = COMMON) -> None:
        self._engine = engine
        self._queue_limit = queue_limit
        self._project = project

    def within(self, project: str) -> Submissions:
        """Return the same for another project."""
        return Submissions(self._engine, self._queue_limit, project)

    def submit(
        self,
        process: str,
        key: str,
        inputs: dict[str, Any],
        *,
        stored: bool,
        looked: str | None = None,
        caller: Caller = ANYBODY,
        terms: Terms = USUAL,
        name: str | None = None,
    ) -> Job:
        """Enter a job; equal work that waits, runs or is `stored` already is shared.

        Parameters
        ----------
        process, key, inputs
            What to do; its name.
        stored : bool
            Whether the store was seen to have the result.
        looked : str, optional
            When that was requested: work that has ended since is shared too, its result being there by now.
        caller : Caller
        terms : Terms
        name : str, optional
            The caller's name for this request (``Idempotency-Key``): sent again, it is the same job, for as
            long as the job is kept.

        Raises
        ------
        BadInput
            The name stands for other work of this caller.
        QueueFull
            New work, and as many computations wait as the limit allows; or the caller has as many
            unfinished jobs as it may.
        """
        identifier = str(uuid.uuid4() if name is None else self._identifier(caller, process, name))
        address = address_of(self._project, key)
        ended = _ended_since(address, looked or now(), stored)
        self._submit(identifier, process, address, inputs, stored, ended, caller, terms)
        return self.find(identifier)

    @retried
    def _submit(
        self,
        identifier: str,
        process: str,
        key: str,
        inputs: dict[str, Any],
        stored: bool,
        ended: ColumnElement[bool],
        caller: Caller,
        terms: Terms,
    ) -> None:
        """Enter a job of this identifier, unless it is in already."""
        with writing(self._engine, in_turn=True) as connection:
            known = select(computations.c.key, computations.c.program).join(jobs)
            entered = connection.execute(known.where(jobs.c.id == identifier)).one_or_none()
            if entered is not None:
                if entered.program == solver_version():  # another program names the same work differently
                    _refuse_unless_same(entered.key, key)
                return
            if not stored:
                _refuse_if_busy(connection, caller)
            computation = _shared(connection, key, ended)
            if computation is None:
                if not stored:
                    self._refuse_if_full(connection)
                computation = _enter(connection, process, key, inputs, stored, terms)
            else:
                connection.execute(raised(computation, terms.priority))
                connection.execute(extended(computation, terms.max_cost_s))
            row = {"id": identifier, "computation_id": computation, "created": now(), "dismissed": None}
            row |= {"caller": caller.name, "project": self._project, "delivery": str(terms.delivery)}
            row |= {"differences": str(terms.differences), **terms.label.columns()}
            connection.execute(insert(jobs).values(**row))

    def _refuse_if_full(self, connection: Connection) -> None:
        """Raise if the queue is at its limit."""
        count = select(func.count()).select_from(computations).where(computations.c.state == "accepted")
        if connection.execute(count).scalar_one() >= self._queue_limit:
            raise QueueFull(f"{self._queue_limit} computations wait already. Try again later.")

    @retried
    def find(self, identifier: str) -> Job:
        """Return a job.

        Raises
        ------
        NoSuchJob
            There is none of this identifier.
        """
        row = None
        if _is_identifier(identifier):
            with reading(self._engine) as connection:
                row = connection.execute(self._jobs().where(jobs.c.id == identifier)).one_or_none()
        if row is None:
            raise NoSuchJob(f"There is no job {identifier!r}.")
        self._note_use(row)
        return job_of(row)

    @optional
    def _note_use(self, row: Any) -> None:
        """Note, once an hour, that an ended job was requested; nobody waits for that."""
        before = instant(datetime.now(UTC) - timedelta(seconds=USE_NOTED_EVERY_S))
        if row.state in ENDED and (row.asked or row.job_created) < before:
            with writing(self._engine, patience_ms=BRIEF_MS) as connection:
                connection.execute(update(jobs).where(jobs.c.id == row.job_id).values(asked=now()))

    def page(self, limit: int, job_filter: JobFilter = EVERY_JOB, after: Mark | None = None) -> list[Job]:
        """Return up to `limit` jobs that are wanted, the newest first, those behind the mark `after`."""
        matching: list[Job] = []
        size = _LOOKED_AT if job_filter.asks_duration else limit
        while True:
            looked_at = self._newest(size, job_filter, after)
            matching += [job for job in looked_at if job_filter.lasted(job)]
            if len(looked_at) < size or len(matching) >= limit:
                return matching[:limit]
            after = Mark(looked_at[-1].created, looked_at[-1].id)

    @retried
    def _newest(self, limit: int, job_filter: JobFilter, after: Mark | None) -> list[Job]:
        """Return jobs that meet what the database decides."""
        statement = self._jobs().where(*job_filter.conditions())
        if after is not None:
            statement = statement.where(behind(after, jobs.c.created, jobs.c.id))
        with reading(self._engine) as connection:
            rows = connection.execute(
                statement.order_by(jobs.c.created.desc(), jobs.c.id.desc()).limit(limit)
            )
            return [job_of(row) for row in rows]

    def relabel(self, identifier: str, title: str | None, tags: Sequence[str] | None) -> Job:
        """Change title and tags of a job, ended or not; None: they stay. Raises `NoSuchJob`."""
        label = self.find(identifier).label
        changed = Label.of(label.title if title is None else title, label.tags if tags is None else tags)
        self._relabel(identifier, changed)
        return self.find(identifier)

    @retried
    def _relabel(self, identifier: str, label: Label) -> None:
        """Write the label of a job."""
        with writing(self._engine) as connection:
            connection.execute(update(jobs).where(jobs.c.id == identifier).values(**label.columns()))

    def dismiss(self, identifier: str) -> Job:
        """Dismiss one caller's job, unless it ended; the work goes on while other jobs share it."""
        job = self.find(identifier)
        if not job.ended:
            self._dismiss(identifier)
        return self.find(identifier)

    @retried
    def _dismiss(self, identifier: str) -> None:
        """Dismiss a job, and its computation if no other wants that."""
        with writing(self._engine, in_turn=True) as connection:
            mine = jobs.c.id == identifier
            undismissed = jobs.c.dismissed.is_(None)
            connection.execute(update(jobs).where(mine, undismissed).values(dismissed=now()))
            owner = select(jobs.c.computation_id).where(mine).scalar_subquery()
            others = select(jobs.c.id).where(jobs.c.computation_id == owner, jobs.c.dismissed.is_(None))
            if connection.execute(others.limit(1)).first() is None:
                _abandon(connection, owner)

    def _jobs(self) -> Any:
        """Select the jobs of the project."""
        return select_jobs(self._project)

    def _identifier(self, caller: Caller, process: str, name: str) -> uuid.UUID:
        """Return the identifier of the job that a caller gives a name; another caller's is another."""
        named = [caller.name, process, name]
        return uuid.uuid5(_NAMES, json.dumps(named if self._project == COMMON else [self._project, *named]))

    @retried
    def counts(self) -> dict[str, int]:
        """Return how many computations of all projects are in each state."""
        statement = select(computations.c.state, func.count()).group_by(computations.c.state)
        with reading(self._engine) as connection:
            return {row[0]: row[1] for row in connection.execute(statement)}


_NAMES = uuid.UUID("4f5b2a0e-6c0f-4b7e-9a53-0d8f3a1c7e62")
"""Name space of the identifiers of jobs that their callers name."""


def _refuse_unless_same(entered: str, key: str) -> None:
    """Raise if a name that stands for some work is used for other work."""
    if entered != key:
        raise BadInput.of(
            "Idempotency-Key", None, "the name of one request", "Give a request with other inputs another."
        )


def _is_identifier(text: str) -> bool:
    """Whether `text` can be the identifier of a job; a database need not take all others."""
    try:
        return str(uuid.UUID(text)) == text
    except ValueError:
        return False


def _refuse_if_busy(connection: Connection, caller: Caller) -> None:
    """Raise if a caller has as many unfinished jobs as it may."""
    if caller.unfinished_jobs is None:
        return
    mine = (jobs.c.caller == caller.name, jobs.c.dismissed.is_(None))
    live = computations.c.state.in_(("accepted", "running"))
    count = select(func.count()).select_from(jobs.join(computations)).where(*mine, live)
    if connection.execute(count).scalar_one() >= caller.unfinished_jobs:
        raise QueueFull(
            f"Key {caller.name!r} has {caller.unfinished_jobs} unfinished jobs, its limit. "
            "Wait for one of them or dismiss it."
        )


def _ended_since(key: str, looked: str, stored: bool) -> ColumnElement[bool]:
    """Condition of computations that succeeded and whose result is there: all, or those of late."""
    succeeded = (computations.c.key == key) & (computations.c.state == "successful")
    return succeeded if stored else succeeded & (computations.c.finished >= looked)


def _shared(connection: Connection, key: str, ended: ColumnElement[bool]) -> str | None:
    """Return the computation of `key` that waits, runs or has `ended` with a result."""
    live = (computations.c.key == key) & computations.c.state.in_(("accepted", "running"))
    statement = select(computations.c.id).where(live | ended)
    return connection.execute(statement.order_by(computations.c.created.desc()).limit(1)).scalar()


def _enter(
    connection: Connection, process: str, key: str, inputs: dict[str, Any], stored: bool, terms: Terms
) -> str:
    """Enter a computation, ended at once if its result is stored."""
    identifier, instant = str(uuid.uuid4()), now()
    row: dict[str, Any] = {
        "id": identifier,
        "process": process,
        "key": key,
        "inputs": json.dumps(inputs),
        "priority": terms.priority,
        "max_cost_s": terms.max_cost_s,
        "state": "successful" if stored else "accepted",
        "message": "Taken from the store." if stored else "Waits for a worker.",
        "fraction": 1.0 if stored else 0.0,
        "created": instant,
        "updated": instant,
        "traceparent": TRACEPARENT.get(),
    }
    if stored:
        row |= {"started": instant, "finished": instant}
    connection.execute(insert(computations).values(**row))
    return identifier


def _abandon(connection: Connection, owner: Any) -> None:
    """End a computation that nobody wants; the scheduler kills its worker."""
    live = computations.c.state.in_(("accepted", "running"))
    values = {"state": "dismissed", "message": "Cancelled."}
    end_computations(connection, (computations.c.id == owner) & live, values)
