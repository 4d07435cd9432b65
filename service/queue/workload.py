"""The load as the database knows it, and how long computations took."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime

from sqlalchemy import Connection, Engine, func, select

from service.queue.tables import computations, durations, of_batch
from service.store.database import reading
from service.store.results import results
from service.store.retries import retried

BOUNDS_S = (1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0, math.inf)
"""Upper bounds of the classes of durations. Each class is stored by its bound, since another version may have
other bounds."""


def bound_of(seconds: float) -> str:
    """Return the upper bound of the class of a duration, as Prometheus writes it."""
    bound = next(bound for bound in BOUNDS_S if seconds <= bound)
    return "+Inf" if math.isinf(bound) else str(bound)


@dataclass(frozen=True)
class Durations:
    """Durations of the computations of one process with one outcome, from the first start to the end."""

    process: str
    outcome: str
    buckets: tuple[tuple[str, int], ...]
    """Upper bounds in seconds, the last one ``+Inf``, each with the number of computations up to it."""
    seconds: float
    """Sum of the durations."""
    attempts: int
    """Sum of the attempts."""


@dataclass(frozen=True)
class Workload:
    """The load at an instant."""

    states: dict[str, int]
    """Number of computations by state."""
    queue: dict[tuple[str, str], int]
    """Number of computations that wait or run, by state and process."""
    oldest_waiting_s: float
    """Age of the oldest waiting computation; 0: none waits."""
    durations: tuple[Durations, ...]
    results: tuple[tuple[str, int, int], ...]
    """Kind, number and bytes of the stored results."""


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
    """Count computations by state, without the rows that stand for batches."""
    statement = select(computations.c.state, func.count()).group_by(computations.c.state)
    all_rows = {row[0]: row[1] for row in connection.execute(statement)}
    batches = {row[0]: row[1] for row in connection.execute(statement.where(of_batch))}
    counts = {state: number - batches.get(state, 0) for state, number in all_rows.items()}
    return {state: number for state, number in counts.items() if number}


def _queue(connection: Connection) -> dict[tuple[str, str], int]:
    columns = (computations.c.state, computations.c.process)
    live = computations.c.state.in_(("accepted", "running")) & ~of_batch
    rows = connection.execute(select(*columns, func.count()).where(live).group_by(*columns))
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
        own_rows = [row for row in rows if (row.process, row.outcome) == (process, outcome)]
        # the classes of this version, and those of other versions that are stored
        bounds = sorted({bound_of(b) for b in BOUNDS_S} | {row.le for row in own_rows}, key=float)
        buckets = tuple(
            (bound, sum(row.number for row in own_rows if float(row.le) <= float(bound))) for bound in bounds
        )
        seconds, attempts = sum(row.seconds for row in own_rows), sum(row.attempts for row in own_rows)
        histograms.append(Durations(process, outcome, buckets, seconds, attempts))
    return tuple(histograms)


def _results(connection: Connection) -> tuple[tuple[str, int, int], ...]:
    statement = select(results.c.kind, func.count(), func.sum(results.c.size)).group_by(results.c.kind)
    rows = connection.execute(statement.order_by(results.c.kind))
    return tuple((row[0], row[1], int(row[2])) for row in rows)
