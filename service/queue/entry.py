"""Entries in the job table: who may make one, which computation it shares; one job, or a batch as a whole.

A *job* is the request of one caller; a *computation* is the work of one or several jobs. A computation is
live while it waits or runs. The *key* is the hash of the inputs, with the address of a project. A *batch* is
a job with others as its children.
"""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from sqlalchemy import ColumnElement, Connection, Engine, func, insert, select, update

from lineofaction.gearbox.problems import BadInput, QueueFull
from service.access.holder import Holder
from service.project import COMMON, address_of
from service.queue.batch_progress import batch_steps
from service.queue.differences import NOT_COMPARED, differences_between, differences_column
from service.queue.tables import BATCH, computations, jobs
from service.queue.terms import KEYLESS_CALLER, USUAL, Terms
from service.schemas.answers import Differences
from service.store.database import now, writing
from service.store.retries import retried
from service.tracing import TRACEPARENT
from service.version import solver_version

LIVE = ("accepted", "running")
"""States of a computation that waits or runs."""
_NAMES = uuid.UUID("4f5b2a0e-6c0f-4b7e-9a53-0d8f3a1c7e62")
"""Name space of the identifiers of jobs that their callers name."""


@dataclass(frozen=True)
class BatchCase:
    """The work of a job before it is entered."""

    key: str
    inputs: dict[str, Any]
    """Normalized inputs."""
    stored: bool = False
    """Whether the store was found to have the result."""
    cost: float = 1.0
    """Predicted cost, relative to the other cases of a batch."""


class Entry:
    """Enters jobs of one caller, alone or in batches. Equal work that waits, runs or is stored is shared.

    At most `queue_limit` computations may wait. The label in the terms of a batch is that of the whole.
    """

    def __init__(
        self,
        engine: Engine,
        queue_limit: int,
        project: str,
        caller: Holder = KEYLESS_CALLER,
        terms: Terms = USUAL,
    ) -> None:
        self._engine, self._queue_limit = engine, queue_limit
        self._project, self._caller, self._terms = project, caller, terms

    def job(self, process: str, work: BatchCase, looked: str, name: str | None = None) -> str:
        """Enter a job; return its identifier, or that of an equal job of the caller whose result it can take.

        Parameters and errors are those of `batch`.
        """
        return self._job(self._identifier(process, name), process, self._addressed_case(work), looked)

    def batch(self, process: str, cases: Sequence[BatchCase], looked: str, name: str | None = None) -> str:
        """Enter a batch with its jobs, all or none; return its identifier.

        `looked` is the time at which the store was searched for results: work that has ended since is shared
        too. `name` is the caller's for this request (``Idempotency-Key``): a repeated request enters nothing
        new. Raises `BadInput`: the name belongs to other work, or there are more new cases than may ever
        wait; `QueueFull`: too many computations wait now, or the caller has too many unfinished jobs.
        """
        identifier = self._identifier(f"batch of {process}", name)
        self._batch(identifier, process, [self._addressed_case(case) for case in cases], looked)
        return identifier

    def _identifier(self, what: str, name: str | None) -> str:
        """Return the identifier of a job: random, or of a named job the hash of caller and name."""
        if name is None:
            return str(uuid.uuid4())
        named = [self._caller.name, what, name]
        return str(
            uuid.uuid5(_NAMES, json.dumps(named if self._project == COMMON else [self._project, *named]))
        )

    def _addressed_case(self, work: BatchCase) -> BatchCase:
        return replace(work, key=address_of(self._project, work.key))

    @retried
    def _job(self, identifier: str, process: str, work: BatchCase, looked: str) -> str:
        """Enter a job of this identifier, unless it is there or an equal one answers; return the job's."""
        with writing(self._engine, in_turn=True) as connection:
            if _is_entered(connection, jobs.c.id == identifier, [work]):
                return identifier
            ended, terms = _ended_since(work, looked), self._terms
            if terms.reuse:
                conditions = (jobs.c.caller == self._caller.name, jobs.c.dismissed.is_(None))
                equal = select(jobs.c.id).join(computations).where(*conditions, jobs.c.stated == terms.stated)
                newest = equal.where(_live(work.key) | ended).order_by(jobs.c.created.desc()).limit(1)
                known: str | None = connection.execute(newest).scalar()
                if known is not None:
                    return known
            if not work.stored:
                _refuse_if_busy(connection, self._caller)
            computation = _shared_computation(connection, work.key, ended)
            if computation is None and not work.stored:
                _refuse_if_full(connection, self._queue_limit)
            row = {"id": identifier, "computation_id": self._joined(connection, process, work, computation)}
            row |= {"created": now(), "caller": self._caller.name, "project": self._project}
            connection.execute(insert(jobs).values(**row, **terms.columns()))
        return identifier

    def _joined(self, connection: Connection, process: str, work: BatchCase, shared: str | None) -> str:
        """Return the computation of a job: a new one, or the shared one with its terms widened for this job.

        A live computation that another version of the program entered becomes this version's: else the end
        of the other version's work would end this job too.
        """
        condition, table, terms = computations.c.id == shared, computations.c, self._terms
        if shared is None:
            state: dict[str, Any] = {"state": "accepted", "message": "Waits for a worker."}
            if work.stored:
                state = {"state": "successful", "message": "Taken from the store."}
                state |= {"fraction": 1.0, "started": now(), "finished": now()}
            state |= {"priority": terms.priority, "max_cost_s": terms.max_cost_s}
            values = {"traceparent": TRACEPARENT.get(), **state}
            return _entered(connection, process, work.key, work.inputs, **values)
        widen_terms(connection, shared, terms.priority, terms.max_cost_s)
        live = condition & table.state.in_(LIVE)
        connection.execute(update(computations).where(live).values(program=solver_version()))
        return shared

    @retried
    def _batch(self, identifier: str, process: str, cases: Sequence[BatchCase], looked: str) -> None:
        with writing(self._engine, in_turn=True) as connection:
            if _is_entered(connection, jobs.c.parent == identifier, cases):
                return
            shared = {
                case.key: _shared_computation(connection, case.key, _ended_since(case, looked))
                for case in cases
            }
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
        maximum = self._caller.unfinished_jobs
        if maximum is not None:
            _refuse_more(unfinished, maximum, "unfinished jobs of this key")
        if unfinished:
            _refuse_if_busy(connection, self._caller, unfinished)
        if waiting:
            _refuse_if_full(connection, self._queue_limit, len(waiting))

    def _enter(
        self,
        connection: Connection,
        identifier: str,
        process: str,
        cases: Sequence[BatchCase],
        shared: dict[str, str | None],
    ) -> None:
        """Enter the batch and its jobs; of equal jobs the first has the weight of their cost."""
        common = {"created": now(), "caller": self._caller.name, "project": self._project, **USUAL.columns()}
        initial_values = {"state": "running", "stage": "jobs", "started": now()}
        computation = _entered(connection, process, f"{BATCH}{identifier}", {}, **initial_values)
        batch = {"id": identifier, "computation_id": computation, "parent": None, "place": 0, "weight": 0.0}
        rows = [common | batch | {"children": len(cases)} | self._terms.label.columns()]
        names, counted = [str(uuid.uuid4()) for _ in cases], set[str]()
        for index, (case, differences) in enumerate(zip(cases, _differences(cases, names), strict=True)):
            if case.key not in counted:
                shared[case.key] = self._joined(connection, process, case, shared[case.key])
            weight = 0.0 if case.stored or case.key in counted else case.cost
            counted.add(case.key)
            row: dict[str, Any] = {"id": names[index], "computation_id": shared[case.key]}
            row |= {"parent": identifier, "place": index, "children": 0}
            row |= {"weight": weight, "differences": differences_column(differences)}
            rows.append(common | row)
        connection.execute(insert(jobs), rows)


def widen_terms(connection: Connection, shared: str, priority: int, limit: float | None) -> None:
    """Give a computation the higher priority, while it waits, and the higher limit (CPU s; None: none)."""
    condition, table = computations.c.id == shared, computations.c
    lower = condition & (table.state == "accepted") & (table.priority < priority)
    connection.execute(update(computations).where(lower).values(priority=priority))
    tighter = table.max_cost_s.is_not(None) if limit is None else table.max_cost_s < limit
    connection.execute(update(computations).where(condition, tighter).values(max_cost_s=limit))


def _is_entered(connection: Connection, which: ColumnElement[bool], works: Sequence[BatchCase]) -> bool:
    """Return whether jobs are entered; raises `BadInput`: the name belongs to other work of this program."""
    known = select(computations.c.key, computations.c.program).join(jobs)
    entered = connection.execute(known.where(which).order_by(jobs.c.place)).all()
    named_alike = all(row.program == solver_version() for row in entered)  # others name work differently
    if entered and named_alike and [row.key for row in entered] != [work.key for work in works]:
        remedy = "Give a request with other inputs another."
        raise BadInput.of("Idempotency-Key", None, "the name of one request", remedy)
    return entered != []


def _differences(cases: Sequence[BatchCase], names: Sequence[str]) -> Iterator[Differences]:
    """Yield the differences of each job of a batch from the one before it."""
    yield NOT_COMPARED
    for (before, case), name in zip(pairwise(cases), names, strict=False):
        yield differences_between(before.inputs, case.inputs, name)


def _refuse_more(number: int, maximum: int, of_what: str) -> None:
    if number > maximum:
        raise BadInput.of("jobs", f"{number} jobs", f"at most {maximum} {of_what}", "Split the batch.")


def _refuse_if_full(connection: Connection, limit: int, further: int = 1) -> None:
    """Raise if more computations wait than the queue may hold with so many `further` ones."""
    count = select(func.count()).select_from(computations).where(computations.c.state == "accepted")
    waiting = connection.execute(count).scalar_one()
    if waiting + further > limit:
        raise QueueFull(f"{waiting} computations wait already. Try again later.")


def _refuse_if_busy(connection: Connection, caller: Holder, further: int = 1) -> None:
    """Raise if a caller has more unfinished jobs than it may with so many `further` ones."""
    if caller.unfinished_jobs is None:
        return
    conditions = (jobs.c.caller == caller.name, jobs.c.dismissed.is_(None), jobs.c.children == 0)
    live = computations.c.state.in_(LIVE)
    count = select(func.count()).select_from(jobs.join(computations)).where(*conditions, live)
    if connection.execute(count).scalar_one() + further > caller.unfinished_jobs:
        raise QueueFull(
            f"Key {caller.name!r} has {caller.unfinished_jobs} unfinished jobs, its limit. "
            "Wait for one of them or dismiss it."
        )


def _ended_since(work: BatchCase, looked: str) -> ColumnElement[bool]:
    """Return the condition of computations that succeeded and have their result: all, or recent ones."""
    succeeded = (computations.c.key == work.key) & (computations.c.state == "successful")
    return succeeded if work.stored else succeeded & (computations.c.finished >= looked)


def _shared_computation(connection: Connection, key: str, ended: ColumnElement[bool]) -> str | None:
    """Return the computation of `key` that waits, runs or has `ended` with a result."""
    statement = select(computations.c.id).where(_live(key) | ended)
    return connection.execute(statement.order_by(computations.c.created.desc()).limit(1)).scalar()


def _live(key: str) -> ColumnElement[bool]:
    return (computations.c.key == key) & computations.c.state.in_(LIVE)


def _entered(connection: Connection, process: str, key: str, inputs: Any, **values: Any) -> str:
    """Enter a computation; return its identifier."""
    identifier, instant = str(uuid.uuid4()), now()
    row = {"id": identifier, "process": process, "key": key, "inputs": json.dumps(inputs)}
    connection.execute(insert(computations).values(**row, created=instant, updated=instant, **values))
    return identifier
