"""Calls to be made about jobs: rows in the database, claimed by one process at a time under a lease.

Which calls are due follows from the states of the jobs, so that none is lost with the process that ends one.
"""

from __future__ import annotations

import uuid
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, Connection, Engine, Select, and_, or_, select, update

from service.origin import Origin
from service.queue.job import ENDED, job_state
from service.queue.tables import computations, jobs, webhooks
from service.schemas.answers import WebhookState
from service.store.database import now, reading, writing
from service.store.dialects import dialect_of
from service.store.retries import retried

LEASE_S = 30.0
MAX_ATTEMPTS = 8
FIRST_PAUSE_S, GROWTH, LONGEST_PAUSE_S = 5.0, 4.0, 3600.0
"""Pause after the first failed attempt, s, factor from each pause to the next, and longest pause, s."""
EVENTS: Mapping[str, tuple[str, ...]] = {
    "inProgress": ("running",),
    "success": ("successful",),
    "failed": ("failed", "dismissed"),
}
"""The states of a job in which each call is made."""


@dataclass(frozen=True)
class Call:
    """A call that the holder of the `lease` must make, for the `attempts`-th time."""

    id: str
    job: str
    event: str
    uri: str
    attempts: int
    lease: str


class Calls:
    """The calls in a database."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    @retried
    def enter(self, job: str, uris: Mapping[str, str]) -> None:
        """Enter the calls about a job, by event, unless they are entered already."""
        rows = [
            {"id": f"{job}_{event}", "job": job, "event": event, "uri": uri, "origin": str(Origin.of(uri))}
            for event, uri in uris.items()
        ]
        with writing(self._engine) as connection:
            entry = dialect_of(connection).insert(webhooks)
            for row in rows:
                connection.execute(entry.values(**row, updated=now()).on_conflict_do_nothing())

    @retried
    def of(self, job: str) -> list[WebhookState]:
        """Return the calls about a job."""
        columns = (webhooks.c.event, webhooks.c.state, webhooks.c.attempts, webhooks.c.message)
        with reading(self._engine) as connection:
            rows = connection.execute(select(*columns).where(webhooks.c.job == job).order_by(webhooks.c.id))
            return [WebhookState.model_validate(row, from_attributes=True) for row in rows]

    @retried
    def project_of(self, job: str) -> str:
        """Return the project of a job about which calls are entered."""
        with reading(self._engine) as connection:
            return str(connection.execute(select(jobs.c.project).where(jobs.c.id == job)).scalar_one())

    def claim(self) -> Call | None:
        """Take the oldest call that is due; one at a time for each origin."""
        with reading(self._engine) as connection:
            if connection.execute(_due(connection).limit(1)).first() is None:
                return None
        return self._claim(uuid.uuid4().hex)

    @retried
    def _claim(self, lease: str) -> Call | None:
        """Take a call under a lease of this name, or return the call that this lease has already."""
        with writing(self._engine, in_turn=True) as connection:
            leased_call = select(webhooks).where(webhooks.c.lease == lease)
            row = connection.execute(leased_call).one_or_none()
            while row is None:
                due = connection.execute(_due(connection).limit(1)).first()
                if due is None:
                    return None
                this = webhooks.c.id == due.id
                if due.status in EVENTS[due.event]:
                    end = dialect_of(connection).clock(connection) + LEASE_S
                    values = {"lease": lease, "leased_until": end, "attempts": webhooks.c.attempts + 1}
                else:  # the job ended in another way, so that this call is never due
                    values = {"state": "skipped"}
                connection.execute(update(webhooks).where(this).values(updated=now(), **values))
                row = connection.execute(leased_call).one_or_none()
            return Call(row.id, row.job, row.event, row.uri, row.attempts, row.lease)

    def deliver(self, call: Call, message: str) -> None:
        """Note that the receiver accepted a call."""
        self._settle(call, {"state": "delivered", "message": message}, 0.0)

    def fail(self, call: Call, message: str, *, final: bool = False) -> None:
        """Note that a call failed: it is made again after a pause, a bounded number of times."""
        over = final or call.attempts >= MAX_ATTEMPTS
        pause = min(FIRST_PAUSE_S * GROWTH ** (call.attempts - 1), LONGEST_PAUSE_S)
        self._settle(call, {"state": "given up" if over else "waiting", "message": message}, pause)

    @retried
    def _settle(self, call: Call, values: dict[str, Any], pause: float) -> None:
        """Change a call and end its lease, unless another process has leased it since."""
        with writing(self._engine) as connection:
            due = dialect_of(connection).clock(connection) + pause
            still_leased = (webhooks.c.id == call.id) & (webhooks.c.lease == call.lease)
            values |= {"lease": "", "leased_until": 0.0, "due": due, "updated": now()}
            connection.execute(update(webhooks).where(still_leased).values(**values))


def _due(connection: Connection) -> Select[Any]:
    """Select the calls that are due, and those that never will be, the longest due first.

    A call waits while its origin is being called, and a call about the end of a job for that of its progress.
    """
    instant = dialect_of(connection).clock(connection)
    other = webhooks.alias()
    busy = (other.c.origin == webhooks.c.origin) & (other.c.leased_until > instant)
    earlier = (other.c.job == webhooks.c.job) & (other.c.event == "inProgress") & (other.c.state == "waiting")
    blocked = select(other.c.id).where(busy | (earlier & (webhooks.c.event != "inProgress"))).exists()
    status = job_state()
    never = status.in_(ENDED) & ~_has_event(status)  # the job ended without the event of the call
    return (
        select(webhooks.c.id, webhooks.c.event, status.label("status"))
        .select_from(webhooks.join(jobs, jobs.c.id == webhooks.c.job).join(computations))
        .where(webhooks.c.state == "waiting", webhooks.c.leased_until <= instant)
        .where(or_(and_(webhooks.c.due <= instant, _has_event(status)), never), ~blocked)
        .order_by(webhooks.c.due, webhooks.c.id)
    )


def _has_event(status: ColumnElement[Any]) -> ColumnElement[bool]:
    """Return the condition that the job is in a state of the call's event."""
    return or_(*(and_(webhooks.c.event == event, status.in_(EVENTS[event])) for event in EVENTS))
