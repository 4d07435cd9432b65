"""The callers' side of the job table: submit, look, list, dismiss."""

from __future__ import annotations

import json
import uuid
from collections.abc import Sequence
from datetime import UTC, datetime, timedelta
from typing import Any

from sqlalchemy import Engine, bindparam, exists, select, update

from lineofaction.gearbox.problems import NoSuchJob
from service.access.holder import Holder
from service.project import COMMON
from service.queue.batch_progress import end_computations
from service.queue.entry import LIVE, BatchCase, Entry
from service.queue.job import ENDED, EVERY_JOB, Job, JobFilter, job_of, jobs_of_all_projects
from service.queue.pages import PageQuery
from service.queue.tables import computations, jobs, of_batch
from service.queue.terms import KEYLESS_CALLER, USUAL, Label, Terms
from service.queue.workload import states_of
from service.store.database import BRIEF_MS, instant, now, reading, writing
from service.store.results import USE_NOTED_EVERY_S, Mark
from service.store.retries import optional, retried

_FORMER = 200
"""Number of a caller's newest jobs among which the previous job of a process is sought."""


# composed once: composing the statements takes longer than running them
_RECENT = (
    select(jobs.c.id, jobs.c.created, jobs.c.computation_id)
    .where(jobs.c.caller == bindparam("caller"), jobs.c.project == bindparam("project"))
    .where(jobs.c.children == 0)
    .order_by(jobs.c.created.desc(), jobs.c.id.desc())
    .limit(_FORMER)
    .subquery()
)
_NEWEST = (
    select(_RECENT.c.id, computations.c.inputs)
    .join(computations, _RECENT.c.computation_id == computations.c.id)
    .where(computations.c.process == bindparam("process"))
    .order_by(_RECENT.c.created.desc(), _RECENT.c.id.desc())
    .limit(1)
)


class Submissions:
    """Jobs of the callers of one project; the queue limits the waiting computations of all projects."""

    def __init__(self, engine: Engine, queue_limit: int, project: str = COMMON) -> None:
        self._engine = engine
        self._queue_limit = queue_limit
        self._project = project

    def within(self, project: str) -> Submissions:
        """Return the submissions of another project."""
        return Submissions(self._engine, self._queue_limit, project)

    def submit(
        self,
        process: str,
        key: str,
        inputs: dict[str, Any],
        *,
        stored: bool,
        looked: str | None = None,
        caller: Holder = KEYLESS_CALLER,
        terms: Terms = USUAL,
        name: str | None = None,
    ) -> Job:
        """Enter a job; equal work that waits, runs or is `stored` already is shared.

        `looked` is the instant at which the store was searched. Parameters and errors as of `Entry.batch`.
        """
        work = BatchCase(key, inputs, stored)
        return self.find(self.entry(caller, terms).job(process, work, looked or now(), name))

    def entry(self, caller: Holder = KEYLESS_CALLER, terms: Terms = USUAL) -> Entry:
        """Return the entry of jobs and batches of a caller."""
        return Entry(self._engine, self._queue_limit, self._project, caller, terms)

    @retried
    def newest(self, caller: Holder, process: str) -> tuple[str, dict[str, Any]] | None:
        """Return identifier and normalized inputs of the newest of a caller's last 200 jobs of a process."""
        sought = {"caller": caller.name, "project": self._project, "process": process}
        with reading(self._engine) as connection:
            row = connection.execute(_NEWEST, sought).one_or_none()
        return None if row is None else (row.id, json.loads(row.inputs))

    @retried
    def find(self, identifier: str) -> Job:
        """Return a job; raises `NoSuchJob`."""
        row = None
        if _is_identifier(identifier):
            with reading(self._engine) as connection:
                row = connection.execute(self._jobs().where(jobs.c.id == identifier)).one_or_none()
        if row is None:
            raise NoSuchJob(f"There is no job {identifier!r}.")
        self._note_use(row)
        return job_of(row)

    @retried
    def children(self, parent: str) -> list[Job]:
        """Return the jobs of a batch, in order."""
        statement = self._jobs().where(jobs.c.parent == parent).order_by(jobs.c.place)
        with reading(self._engine) as connection:
            return [job_of(row) for row in connection.execute(statement)]

    @optional
    def _note_use(self, row: Any) -> None:
        """Note the time of use of an ended job and its batch, at most once an hour; a failure is ignored."""
        before = instant(datetime.now(UTC) - timedelta(seconds=USE_NOTED_EVERY_S))
        if row.state in ENDED and (row.asked or row.job_created) < before:
            with writing(self._engine, patience_ms=BRIEF_MS) as connection:
                used = jobs.c.id.in_([row.job_id, row.parent])
                connection.execute(update(jobs).where(used).values(asked=now()))

    @retried
    def page(self, limit: int, job_filter: JobFilter = EVERY_JOB, after: Mark | None = None) -> list[Job]:
        """Return up to `limit` wanted jobs behind the mark `after`, the newest first."""
        query = PageQuery(self._project, job_filter, limit, after)
        with reading(self._engine) as connection:
            return [job_of(row) for row in query.rows(connection)]

    def relabel(self, identifier: str, title: str | None, tags: Sequence[str] | None) -> Job:
        """Change title and tags of a job, ended or not; None leaves them. Raises `NoSuchJob`."""
        label = self.find(identifier).label
        changed = Label.of(label.title if title is None else title, label.tags if tags is None else tags)
        self._relabel(identifier, changed)
        return self.find(identifier)

    @retried
    def _relabel(self, identifier: str, label: Label) -> None:
        with writing(self._engine) as connection:
            connection.execute(update(jobs).where(jobs.c.id == identifier).values(**label.columns()))

    def dismiss(self, identifier: str) -> Job:
        """Dismiss a caller's job, or the jobs of a batch, unless ended; shared work goes on for others."""
        job = self.find(identifier)
        if not job.ended:
            self._dismiss(identifier)
        return self.find(identifier)

    @retried
    def _dismiss(self, identifier: str) -> None:
        """Dismiss a job, and of a batch its live jobs; end the computations that no other job needs."""
        with writing(self._engine, in_turn=True) as connection:
            condition = (jobs.c.id == identifier) | (jobs.c.parent == identifier)
            undismissed = jobs.c.dismissed.is_(None)
            live = select(computations.c.id).where(computations.c.state.in_(LIVE))
            goes_on = undismissed & jobs.c.computation_id.in_(live)
            connection.execute(update(jobs).where(condition, goes_on).values(dismissed=now()))
            has_other_job = exists().where(jobs.c.computation_id == computations.c.id, undismissed)
            owners = select(jobs.c.computation_id).where(condition)
            # the scheduler kills their workers; a batch ends by its jobs
            unwanted = computations.c.id.in_(owners) & ~has_other_job & computations.c.state.in_(LIVE)
            values = {"state": "dismissed", "message": "Cancelled."}
            end_computations(connection, unwanted & ~of_batch, values)

    def _jobs(self) -> Any:
        return jobs_of_all_projects().where(jobs.c.project == self._project)

    @retried
    def counts(self) -> dict[str, int]:
        """Return the number of computations of all projects by state."""
        with reading(self._engine) as connection:
            return states_of(connection)


def _is_identifier(text: str) -> bool:
    """Whether `text` can be the identifier of a job: a database may refuse other texts, as with a zero."""
    try:
        return str(uuid.UUID(text)) == text
    except ValueError:
        return False
