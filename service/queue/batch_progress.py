"""Progress of batches, which follows from their jobs, and the end of computations."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Connection, Row, Update, case, func, select, update

from service.queue.job import ENDED, job_state
from service.queue.tables import computations, durations, jobs, of_batch
from service.queue.workload import bound_of
from service.store.database import now
from service.store.dialects import dialect_of


@dataclass(frozen=True)
class Family:
    """The jobs of a batch: how many are in each state, and the share of their cost that is done."""

    states: dict[str, int]
    fraction: float

    @property
    def number(self) -> int:
        """The number of jobs of the batch."""
        return sum(self.states.values())

    @property
    def ended(self) -> int:
        """The number of ended jobs of the batch."""
        return sum(self.states.get(state, 0) for state in ENDED)

    def values(self) -> dict[str, Any]:
        """Return the values for the row of the batch."""
        failed, dismissed = self.states.get("failed", 0), self.states.get("dismissed", 0)
        text = f"{self.ended} of {self.number} jobs have ended"
        text += f", {failed} failed" if failed else ""
        text += f", {dismissed} dismissed" if dismissed else ""
        share = self.ended / max(self.number, 1)
        values = {"stage": "jobs", "stage_fraction": share, "message": f"{text}.", "fraction": self.fraction}
        if self.ended == self.number:
            state = next((state for state in ("dismissed", "failed") if self.states.get(state)), "successful")
            values |= {"state": state, "finished": now()}
        return values


EMPTY_FAMILY = Family({}, 1.0)
"""The jobs of a batch without jobs."""


def batch_steps(connection: Connection) -> list[Update]:
    """Return the updates of running batches whose jobs changed their states or made progress."""
    columns = (computations.c.id.label("row"), computations.c.message, computations.c.fraction)
    running = (computations.c.state == "running") & of_batch
    rows = connection.execute(
        select(jobs.c.id, *columns).select_from(jobs.join(computations)).where(running)
    ).all()
    families = _families(connection, [row.id for row in rows]) if rows else {}
    steps = []
    for row in rows:
        values = families.get(row.id, EMPTY_FAMILY).values()
        values["fraction"] = max(values["fraction"], row.fraction)
        if "state" in values or (values["message"], values["fraction"]) != (row.message, row.fraction):
            condition = (computations.c.id == row.row) & running
            steps.append(update(computations).where(condition).values(updated=now(), **values))
    return steps


def _families(connection: Connection, parents: list[str]) -> dict[str, Family]:
    """Count the jobs of batches by state, and add up their costs."""
    state = job_state()
    share = case((state.in_(ENDED), 1.0), else_=computations.c.fraction)
    sums = (
        func.count().label("number"),
        func.sum(jobs.c.weight).label("cost"),
        func.sum(jobs.c.weight * share).label("done"),
    )
    columns = (jobs.c.parent.label("batch"), state.label("job_state"))
    statement = select(*columns, *sums).select_from(jobs.join(computations))
    by_parent: dict[str, list[Any]] = {}
    grouped = statement.where(jobs.c.parent.in_(parents)).group_by(jobs.c.parent, state)
    for row in connection.execute(grouped).all():
        by_parent.setdefault(row.batch, []).append(row)
    families = {}
    for parent, rows in by_parent.items():
        cost = sum(row.cost for row in rows)
        fraction = sum(row.done for row in rows) / cost if cost else 1.0
        families[parent] = Family({row.job_state: row.number for row in rows}, fraction)
    return families


def end_computations(connection: Connection, which: ColumnElement[bool], values: dict[str, Any]) -> None:
    """End the computations that meet `which`, with the state in `values`, and count those that were started.

    `which` must exclude ended computations: a step that is repeated after its commit must not count twice.
    """
    instant = now()
    ended = update(computations).where(which).values(finished=instant, updated=instant, **values)
    columns = [computations.c[name] for name in ("process", "state", "started", "finished", "attempts")]
    for row in connection.execute(ended.returning(*columns)).all():
        if row.started is not None:
            _count(connection, row)


def _count(connection: Connection, row: Row[Any]) -> None:
    span = datetime.fromisoformat(row.finished) - datetime.fromisoformat(row.started)
    seconds = max(span.total_seconds(), 0.0)  # below zero where a clock was set back
    key = {"process": row.process, "outcome": row.state, "le": bound_of(seconds)}
    added = {"number": 1, "seconds": seconds, "attempts": row.attempts}
    statement = dialect_of(connection).insert(durations).values(**key, **added)
    more = {name: durations.c[name] + value for name, value in added.items()}
    connection.execute(statement.on_conflict_do_update(index_elements=list(key), set_=more))
