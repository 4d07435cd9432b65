"""The callers' side of the job table: submit, look, list, dismiss."""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from itertools import pairwise
from typing import Any

from sqlalchemy import ColumnElement, Connection, Engine, exists, insert, select, update

from lineofaction.gearbox.problems import BadInput, NoSuchJob
from service.project import COMMON, address_of
from service.queue.cost_limit import extended
from service.queue.differences import NOT_COMPARED, Differences
from service.queue.entry import (
    LIVE,
    ended_since,
    enter_computation,
    equal_job,
    identifier_of,
    refuse_if_busy,
    refuse_if_full,
    refuse_unless_same,
    shared_computation,
)
from service.queue.job import ENDED, EVERY_JOB, Job, JobFilter, job_of, select_jobs
from service.queue.tables import computations, jobs
from service.queue.terms import ANYBODY, AS_IT_IS, NO_LABEL, USUAL, Caller, Label, Terms, raised
from service.queue.workload import FOR_EVER, HELD, batch_steps, end_computations, states_of
from service.store import BRIEF_MS, Mark, behind, instant, now, optional, reading, retried, writing
from service.store.results import USE_NOTED_EVERY_S
from service.version import solver_version

# The entry of a batch in the job table: one job and those in it, all or none.


@dataclass(frozen=True)
class BatchCase:
    """One job of a batch before it is entered.

    Attributes
    ----------
    key, inputs
        What to do; its name.
    stored : bool
        Whether the store was seen to have the result.
    cost : float
        What it is predicted to cost beside the others.
    """

    key: str
    inputs: dict[str, Any]
    stored: bool = False
    cost: float = 1.0


class BatchEntry:
    """Enters batches of one caller.

    Parameters
    ----------
    engine : Engine
    queue_limit : int
        Computations that may wait.
    project : str
        In which the batch and its jobs are.
    caller : Caller
    terms : Terms
        The label is that of the batch, the rest holds for its jobs.
    """

    def __init__(
        self, engine: Engine, queue_limit: int, project: str, caller: Caller = ANYBODY, terms: Terms = USUAL
    ) -> None:
        self._engine, self._queue_limit = engine, queue_limit
        self._project, self._caller, self._terms = project, caller, terms

    def submit(self, process: str, cases: Sequence[BatchCase], looked: str, name: str | None = None) -> str:
        """Enter a batch with its jobs, all or none; return its identifier. Equal work is shared.

        Parameters
        ----------
        process : str
        cases : sequence of BatchCase
        looked : str
            When the store was asked for results: work that has ended since is shared too.
        name : str, optional
            The caller's name for this request (``Idempotency-Key``): sent again, it is the same batch.

        Raises
        ------
        BadInput
            The name stands for another batch, or there are more new cases than may ever wait.
        QueueFull
            There is no room for all of them now.
        """
        kind = f"batch of {process}"
        named = None if name is None else identifier_of(self._project, self._caller, kind, name)
        identifier = str(named or uuid.uuid4())
        ours = [replace(case, key=address_of(self._project, case.key)) for case in cases]
        self._submit(identifier, process, ours, looked)
        return identifier

    @retried
    def _submit(self, identifier: str, process: str, cases: Sequence[BatchCase], looked: str) -> None:
        """Enter a batch of this identifier, unless it is in already."""
        with writing(self._engine, in_turn=True) as connection:
            known = select(computations.c.key, computations.c.program).join(jobs)
            entered = connection.execute(
                known.where(jobs.c.parent == identifier).order_by(jobs.c.place)
            ).all()
            if entered:
                if all(row.program == solver_version() for row in entered):
                    keys = " ".join(row.key for row in entered)
                    refuse_unless_same(keys, " ".join(case.key for case in cases))
                return
            shared = {case.key: _shared(connection, case, looked) for case in cases}
            self._refuse_beyond_limits(connection, cases, shared)
            self._enter(connection, identifier, process, cases, shared)
            for step in batch_steps(connection):
                connection.execute(step)

    def _refuse_beyond_limits(
        self, connection: Connection, cases: Sequence[BatchCase], shared: dict[str, str | None]
    ) -> None:
        """Raise if there is no room for the batch, now or ever."""
        waiting = {case.key for case in cases if shared[case.key] is None and not case.stored}
        unfinished = sum(not case.stored for case in cases)
        _refuse_more(len(waiting), self._queue_limit, "new cases: so many may wait (LOA_QUEUE_LIMIT)")
        most = self._caller.unfinished_jobs
        if most is not None:
            _refuse_more(unfinished, most, "unfinished jobs of this key")
        if unfinished:
            refuse_if_busy(connection, self._caller, unfinished)
        if waiting:
            refuse_if_full(connection, self._queue_limit, len(waiting))

    def _enter(
        self,
        connection: Connection,
        identifier: str,
        process: str,
        cases: Sequence[BatchCase],
        shared: dict[str, str | None],
    ) -> None:
        """Enter the batch and its jobs; the first of equal ones bears their cost."""
        common = {"created": now(), "caller": self._caller.name, "delivery": str(AS_IT_IS)}
        common |= {"project": self._project, "differences": str(NOT_COMPARED), **NO_LABEL.columns()}
        rows = [
            _entered_batch(connection, identifier, process, len(cases)) | common | self._terms.label.columns()
        ]
        names, counted = [str(uuid.uuid4()) for _ in cases], set[str]()
        for place, (case, apart) in enumerate(zip(cases, _differences(cases, names), strict=True)):
            computation = shared[case.key]
            if computation is None:
                computation = enter_computation(
                    connection, process, case.key, case.inputs, case.stored, self._terms
                )
                shared[case.key] = computation
            elif case.key not in counted:
                connection.execute(raised(computation, self._terms.priority))
                connection.execute(extended(computation, self._terms.max_cost_s))
            weight = 0.0 if case.stored or case.key in counted else case.cost
            counted.add(case.key)
            row = {"id": names[place], "computation_id": computation, "parent": identifier, "place": place}
            rows.append(common | row | {"children": 0, "weight": weight, "differences": str(apart)})
        connection.execute(insert(jobs), rows)


def _entered_batch(connection: Connection, identifier: str, process: str, children: int) -> dict[str, Any]:
    """Enter what stands for the computation of a batch; return the row of its job."""
    instant, computation = now(), str(uuid.uuid4())
    row = {"id": computation, "process": process, "key": f"batch {identifier}", "inputs": json.dumps({})}
    row |= {"state": "running", "lease": HELD, "message": "", "stage": "jobs"}
    row |= {"created": instant, "started": instant, "updated": instant}
    connection.execute(insert(computations).values(**row, leased_until=FOR_EVER))
    job = {"id": identifier, "computation_id": computation, "parent": None, "place": 0}
    return job | {"children": children, "weight": 0.0}


def _differences(cases: Sequence[BatchCase], names: Sequence[str]) -> Iterator[Differences]:
    """Yield what sets each job of a batch apart from the one before it."""
    yield NOT_COMPARED
    for (before, case), name in zip(pairwise(cases), names, strict=False):
        yield Differences.between(before.inputs, case.inputs, name)


def _shared(connection: Connection, case: BatchCase, looked: str) -> str | None:
    """Return the computation that a case shares, None if there is none yet."""
    return shared_computation(connection, case.key, ended_since(case.key, looked, case.stored))


def _refuse_more(number: int, most: int, of_what: str) -> None:
    """Raise if a batch has more of something than there can ever be room for."""
    if number > most:
        raise BadInput.of("jobs", f"{number} jobs", f"at most {most} {of_what}", "Split the batch.")


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
        identifier = str(
            uuid.uuid4() if name is None else identifier_of(self._project, caller, process, name)
        )
        address = address_of(self._project, key)
        ended = ended_since(address, looked or now(), stored)
        return self.find(self._submit(identifier, process, address, inputs, stored, ended, caller, terms))

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
    ) -> str:
        """Enter a job of this identifier, unless it is in already or an equal one answers; return which."""
        with writing(self._engine, in_turn=True) as connection:
            known = select(computations.c.key, computations.c.program).join(jobs)
            entered = connection.execute(known.where(jobs.c.id == identifier)).one_or_none()
            if entered is not None:
                if entered.program == solver_version():  # another program names the same work differently
                    refuse_unless_same(entered.key, key)
                return identifier
            equal = equal_job(connection, key, ended, caller, terms.stated) if terms.reuse else None
            if equal is not None:
                return equal
            if not stored:
                refuse_if_busy(connection, caller)
            computation = shared_computation(connection, key, ended)
            if computation is None:
                if not stored:
                    refuse_if_full(connection, self._queue_limit)
                computation = enter_computation(connection, process, key, inputs, stored, terms)
            else:
                connection.execute(raised(computation, terms.priority))
                connection.execute(extended(computation, terms.max_cost_s))
            row = {"id": identifier, "computation_id": computation, "created": now(), "caller": caller.name}
            connection.execute(insert(jobs).values(**row, project=self._project, **terms.columns()))
        return identifier

    def batches(self, caller: Caller = ANYBODY, terms: Terms = USUAL) -> BatchEntry:
        """Return what enters batches of a caller, whose label is that of `terms`."""
        return BatchEntry(self._engine, self._queue_limit, self._project, caller, terms)

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

    @retried
    def children(self, parent: str) -> list[Job]:
        """Return the jobs of a batch, in order."""
        statement = self._jobs().where(jobs.c.parent == parent).order_by(jobs.c.place)
        with reading(self._engine) as connection:
            return [job_of(row) for row in connection.execute(statement)]

    @optional
    def _note_use(self, row: Any) -> None:
        """Note, once an hour, that an ended job, and its batch, was requested; nobody waits for that."""
        before = instant(datetime.now(UTC) - timedelta(seconds=USE_NOTED_EVERY_S))
        if row.state in ENDED and (row.asked or row.job_created) < before:
            with writing(self._engine, patience_ms=BRIEF_MS) as connection:
                used = jobs.c.id.in_([row.job_id, row.parent])
                connection.execute(update(jobs).where(used).values(asked=now()))

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
        with writing(self._engine) as connection:
            connection.execute(update(jobs).where(jobs.c.id == identifier).values(**label.columns()))

    def dismiss(self, identifier: str) -> Job:
        """Dismiss one caller's job, or those of a batch, unless it ended; shared work goes on for others."""
        job = self.find(identifier)
        if not job.ended:
            self._dismiss(identifier)
        return self.find(identifier)

    @retried
    def _dismiss(self, identifier: str) -> None:
        """Dismiss a job with the unended ones of its batch, and the computations that no other wants."""
        with writing(self._engine, in_turn=True) as connection:
            mine = (jobs.c.id == identifier) | (jobs.c.parent == identifier)
            undismissed = jobs.c.dismissed.is_(None)
            live = select(computations.c.id).where(computations.c.state.in_(LIVE))
            goes_on = undismissed & jobs.c.computation_id.in_(live)
            connection.execute(update(jobs).where(mine, goes_on).values(dismissed=now()))
            wanted = exists().where(jobs.c.computation_id == computations.c.id, undismissed)
            owners = select(jobs.c.computation_id).where(mine)
            _abandon(connection, computations.c.id.in_(owners) & ~wanted)

    def _jobs(self) -> Any:
        return select_jobs(self._project)

    @retried
    def counts(self) -> dict[str, int]:
        """Return how many computations of all projects are in each state."""
        with reading(self._engine) as connection:
            return states_of(connection)


def _is_identifier(text: str) -> bool:
    """Whether `text` can be the identifier of a job; a database need not take all others."""
    try:
        return str(uuid.UUID(text)) == text
    except ValueError:
        return False


def _abandon(connection: Connection, unwanted: ColumnElement[bool]) -> None:
    """End computations that nobody wants; the scheduler kills their workers. A batch ends by its jobs."""
    live = computations.c.state.in_(LIVE) & (computations.c.lease != HELD)
    values = {"state": "dismissed", "message": "Cancelled."}
    end_computations(connection, unwanted & live, values)
