"""Durations of computations: a histogram in the database, in which each is counted when it ends.

It is kept apart from the computations, so that it never falls when those are removed, and is the same for all
services of one database.
"""

from __future__ import annotations

import math
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, Connection, Row, update

from service.queue.tables import computations, durations
from service.store import dialect_of, now

BOUNDS_S = (1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0, math.inf)
"""Upper bounds of the classes; another program version may have others, each class is kept by its bound."""


def end_computations(connection: Connection, which: ColumnElement[bool], values: dict[str, Any]) -> None:
    """End computations with the state in `values`, and count those that had begun.

    A step that is repeated after its transaction was committed must find none of them with `which`.
    """
    instant = now()
    ended = update(computations).where(which).values(finished=instant, updated=instant, **values)
    facts = (
        computations.c.process,
        computations.c.state,
        computations.c.started,
        computations.c.finished,
        computations.c.attempts,
    )
    for row in connection.execute(ended.returning(*facts)).all():
        if row.started is not None:
            _count(connection, row)


def _count(connection: Connection, row: Row[Any]) -> None:
    span = datetime.fromisoformat(row.finished) - datetime.fromisoformat(row.started)
    seconds = max(span.total_seconds(), 0.0)  # machines' clocks differ
    key = {"process": row.process, "outcome": row.state, "le": bound_of(seconds)}
    insert = dialect_of(connection).insert(durations)
    statement = insert.values(**key, number=1, seconds=seconds, attempts=row.attempts)
    more = {
        "number": durations.c.number + 1,
        "seconds": durations.c.seconds + seconds,
        "attempts": durations.c.attempts + row.attempts,
    }
    connection.execute(statement.on_conflict_do_update(index_elements=list(key), set_=more))


def bound_of(seconds: float) -> str:
    """Return the upper bound of the class of a duration, as Prometheus writes it."""
    bound = next(bound for bound in BOUNDS_S if seconds <= bound)
    return "+Inf" if math.isinf(bound) else str(bound)
