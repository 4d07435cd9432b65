"""The load as the database knows it, how far batches are, and how long computations took."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import ColumnElement, Connection, Engine, Row, Update, case, func, select, update

from service.queue.job import ENDED, job_state
from service.queue.tables import computations, durations, jobs, of_batch
from service.store.database import now, reading
from service.store.dialects import dialect_of, retried
from service.store.results import results

# Batches: how far one is follows from the jobs in it.

BOUNDS_S = (1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0, math.inf)
"""Upper bounds of the classes; another program version may have others, each class is kept by its bound."""


@dataclass(frozen=True)
class Family:
    """The jobs of a batch: how many are in each state, and the share of their cost that is done."""

    states: dict[str, int]
    fraction: float

    @property
    def number(self) -> int:
        """Return how many jobs there are."""
        return sum(self.states.values())

    @property
    def ended(self) -> int:
        """Return how many have ended."""
        return sum(self.states.get(state, 0) for state in ENDED)

    def values(self) -> dict[str, Any]:
        """Return what the row of the batch is to hold."""
        failed, dismissed = self.states.get("failed", 0), self.states.get("dismissed", 0)
        text = f"{self.ended} of {self.number} jobs have ended"
        text += f", {failed} failed" if failed else ""
        text += f", {dismissed} dismissed" if dismissed else ""
        share = self.ended / max(self.number, 1)
        values = {"stage": "jobs", "stage_fraction": share, "message": f"{text}.", "fraction": self.fraction}
        if self.ended == self.number:
            state = "dismissed" if dismissed else "failed" if failed else "successful"
            values |= {"state": state, "finished": now()}
        return values


NOBODY = Family({}, 1.0)


def batch_steps(connection: Connection) -> list[Update]:
    """Return the changes of those batches that go on and whose jobs have moved."""
    facts = (computations.c.id.label("row"), computations.c.message, computations.c.fraction)
    held = (computations.c.state == "running") & of_batch
    rows = connection.execute(
        select(jobs.c.id, *facts).select_from(jobs.join(computations)).where(held)
    ).all()
    families = _families(connection, [row.id for row in rows]) if rows else {}
    steps = []
    for row in rows:
        values = families.get(row.id, NOBODY).values()
        values["fraction"] = max(values["fraction"], row.fraction)
        if "state" in values or (values["message"], values["fraction"]) != (row.message, row.fraction):
            mine = (computations.c.id == row.row) & held
            steps.append(update(computations).where(mine).values(updated=now(), **values))
    return steps


def _families(connection: Connection, parents: list[str]) -> dict[str, Family]:
    """Count the jobs of batches by state, and add up what they cost."""
    state = job_state()
    done = case((state.in_(ENDED), 1.0), else_=computations.c.fraction)
    sums = (func.count(), func.sum(jobs.c.weight), func.sum(jobs.c.weight * done))
    statement = select(jobs.c.parent, state, *sums).select_from(jobs.join(computations))
    found: dict[str, list[Any]] = {}
    grouped = statement.where(jobs.c.parent.in_(parents)).group_by(jobs.c.parent, state)
    for row in connection.execute(grouped).all():
        found.setdefault(row[0], []).append(row)
    families = {}
    for parent, rows in found.items():
        weight = sum(row[3] for row in rows)
        fraction = sum(row[4] for row in rows) / weight if weight else 1.0
        families[parent] = Family({row[1]: row[2] for row in rows}, fraction)
    return families


def end_computations(connection: Connection, which: ColumnElement[bool], values: dict[str, Any]) -> None:
    """End computations with the state in `values`, and count those that had begun.

    A step that is repeated after its transaction was committed must find none of them with `which`.
    """
    instant = now()
    ended = update(computations).where(which).values(finished=instant, updated=instant, **values)
    facts = [computations.c[name] for name in ("process", "state", "started", "finished", "attempts")]
    for row in connection.execute(ended.returning(*facts)).all():
        if row.started is not None:
            _count(connection, row)


def _count(connection: Connection, row: Row[Any]) -> None:
    span = datetime.fromisoformat(row.finished) - datetime.fromisoformat(row.started)
    seconds = max(span.total_seconds(), 0.0)  # a clock was set
    key = {"process": row.process, "outcome": row.state, "le": bound_of(seconds)}
    added = {"number": 1, "seconds": seconds, "attempts": row.attempts}
    statement = dialect_of(connection).insert(durations).values(**key, **added)
    more = {name: durations.c[name] + value for name, value in added.items()}
    connection.execute(statement.on_conflict_do_update(index_elements=list(key), set_=more))


def bound_of(seconds: float) -> str:
    """Return the upper bound of the class of a duration, as Prometheus writes it."""
    bound = next(bound for bound in BOUNDS_S if seconds <= bound)
    return "+Inf" if math.isinf(bound) else str(bound)


@dataclass(frozen=True)
class Durations:
    """Computations of one process that ended in one way: seconds from first start to end, and attempts.

    The buckets say how many took at most so many seconds (the last bound is ``+Inf``).
    """

    process: str
    outcome: str
    buckets: tuple[tuple[str, int], ...]
    seconds: float
    attempts: int


@dataclass(frozen=True)
class Workload:
    """The load at an instant.

    Computations by state, those that wait or run by state and process, the age of the oldest waiting one (0:
    none does), and results as kind, number and bytes.
    """

    states: dict[str, int]
    queue: dict[tuple[str, str], int]
    oldest_waiting_s: float
    durations: tuple[Durations, ...]
    results: tuple[tuple[str, int, int], ...]


class WorkloadReader:
    """Reads the load."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    @retried
    def read(self) -> Workload:
        """Return the load now; raises `DatabaseUnavailable`."""
        with reading(self._engine) as connection:
            return Workload(
                states_of(connection),
                _queue(connection),
                _oldest_waiting_s(connection),
                _durations(connection),
                _results(connection),
            )


def states_of(connection: Connection) -> dict[str, int]:
    """Count computations by state; what stands for a batch is none."""
    statement = select(computations.c.state, func.count()).group_by(computations.c.state)
    all_rows = {row[0]: row[1] for row in connection.execute(statement)}
    batches = {row[0]: row[1] for row in connection.execute(statement.where(of_batch))}
    counts = {state: number - batches.get(state, 0) for state, number in all_rows.items()}
    return {state: number for state, number in counts.items() if number}


def _queue(connection: Connection) -> dict[tuple[str, str], int]:
    facts = (computations.c.state, computations.c.process)
    live = computations.c.state.in_(("accepted", "running")) & ~of_batch
    rows = connection.execute(select(*facts, func.count()).where(live).group_by(*facts))
    return {(row[0], row[1]): row[2] for row in rows}


def _oldest_waiting_s(connection: Connection) -> float:
    waiting = select(func.min(computations.c.created)).where(computations.c.state == "accepted")
    oldest = connection.execute(waiting).scalar()
    if oldest is None:
        return 0.0
    return max((datetime.now(UTC) - datetime.fromisoformat(oldest)).total_seconds(), 0.0)


def _durations(connection: Connection) -> tuple[Durations, ...]:
    rows = connection.execute(select(durations).order_by(durations.c.process, durations.c.outcome)).all()
    names = dict.fromkeys((row.process, row.outcome) for row in rows)
    histograms = []
    for process, outcome in names:
        mine = [row for row in rows if (row.process, row.outcome) == (process, outcome)]
        bounds = sorted({bound_of(b) for b in BOUNDS_S} | {row.le for row in mine}, key=float)
        buckets = tuple(
            (bound, sum(row.number for row in mine if float(row.le) <= float(bound))) for bound in bounds
        )
        seconds, attempts = sum(row.seconds for row in mine), sum(row.attempts for row in mine)
        histograms.append(Durations(process, outcome, buckets, seconds, attempts))
    return tuple(histograms)


def _results(connection: Connection) -> tuple[tuple[str, int, int], ...]:
    statement = select(results.c.kind, func.count(), func.sum(results.c.size)).group_by(results.c.kind)
    rows = connection.execute(statement.order_by(results.c.kind))
    return tuple((row[0], row[1], int(row[2])) for row in rows)
