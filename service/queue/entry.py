"""Entries in the job table: who may make one, and which computation it shares."""

from __future__ import annotations

import json
import uuid
from typing import Any

from sqlalchemy import ColumnElement, Connection, func, insert, select

from lineofaction.gearbox.problems import BadInput, QueueFull
from service.project import COMMON
from service.queue.tables import computations, jobs
from service.queue.terms import Caller, Terms
from service.store import now
from service.tracing.tracer import TRACEPARENT

LIVE = ("accepted", "running")
"""States of work that goes on."""
_NAMES = uuid.UUID("4f5b2a0e-6c0f-4b7e-9a53-0d8f3a1c7e62")
"""Name space of the identifiers of jobs that their callers name."""


def identifier_of(project: str, caller: Caller, process: str, name: str) -> uuid.UUID:
    """Return the identifier of the job that a caller gives a name; another caller's is another."""
    named = [caller.name, process, name]
    return uuid.uuid5(_NAMES, json.dumps(named if project == COMMON else [project, *named]))


def refuse_unless_same(entered: str, key: str) -> None:
    """Raise if a name that stands for some work is used for other work."""
    if entered != key:
        raise BadInput.of(
            "Idempotency-Key", None, "the name of one request", "Give a request with other inputs another."
        )


def refuse_if_full(connection: Connection, limit: int, further: int = 1) -> None:
    """Raise if more computations wait than the queue may hold with so many `further` ones."""
    count = select(func.count()).select_from(computations).where(computations.c.state == "accepted")
    waiting = connection.execute(count).scalar_one()
    if waiting + further > limit:
        raise QueueFull(f"{waiting} computations wait already. Try again later.")


def refuse_if_busy(connection: Connection, caller: Caller, further: int = 1) -> None:
    """Raise if a caller has more unfinished jobs than it may with so many `further` ones."""
    if caller.unfinished_jobs is None:
        return
    mine = (jobs.c.caller == caller.name, jobs.c.dismissed.is_(None), jobs.c.children == 0)
    live = computations.c.state.in_(LIVE)
    count = select(func.count()).select_from(jobs.join(computations)).where(*mine, live)
    if connection.execute(count).scalar_one() + further > caller.unfinished_jobs:
        raise QueueFull(
            f"Key {caller.name!r} has {caller.unfinished_jobs} unfinished jobs, its limit. "
            "Wait for one of them or dismiss it."
        )


def ended_since(key: str, looked: str, stored: bool) -> ColumnElement[bool]:
    """Condition of computations that succeeded and whose result is there: all, or those of late."""
    succeeded = (computations.c.key == key) & (computations.c.state == "successful")
    return succeeded if stored else succeeded & (computations.c.finished >= looked)


def shared_computation(connection: Connection, key: str, ended: ColumnElement[bool]) -> str | None:
    """Return the computation of `key` that waits, runs or has `ended` with a result."""
    statement = select(computations.c.id).where(_live(key) | ended)
    return connection.execute(statement.order_by(computations.c.created.desc()).limit(1)).scalar()


def equal_job(
    connection: Connection, key: str, ended: ColumnElement[bool], caller: Caller, stated: str
) -> str | None:
    """Return the caller's newest job of the `stated` inputs that waits, runs or has `ended` with a result."""
    theirs = (jobs.c.caller == caller.name, jobs.c.dismissed.is_(None), jobs.c.stated == stated)
    statement = select(jobs.c.id).join(computations).where(_live(key) | ended, *theirs)
    return connection.execute(statement.order_by(jobs.c.created.desc()).limit(1)).scalar()


def _live(key: str) -> ColumnElement[bool]:
    return (computations.c.key == key) & computations.c.state.in_(LIVE)


def enter_computation(
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
