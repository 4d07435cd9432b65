"""The SQLite file: write-ahead log, synchronous FULL, immediate write transactions."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, MetaData, NullPool, create_engine, event

metadata = MetaData()

_PRAGMAS = (
    "PRAGMA journal_mode=WAL",
    "PRAGMA synchronous=FULL",
    "PRAGMA busy_timeout=10000",
    "PRAGMA foreign_keys=ON",
)


def open_database(file: Path) -> Engine:
    """Return an engine on the SQLite file, made with its tables if it does not exist."""
    file.parent.mkdir(parents=True, exist_ok=True)
    # no pool: a connection kept for a thread that has ended is closed by nobody, and opening one costs little
    engine = create_engine(f"sqlite:///{file}", poolclass=NullPool)
    event.listen(engine, "connect", _prepare)
    event.listen(engine, "begin", _begin)
    with writing(engine) as connection:
        metadata.create_all(connection)
    return engine


def _prepare(connection: Any, _record: object) -> None:
    """Set a new connection up: we begin transactions ourselves (see `_begin`)."""
    connection.isolation_level = None
    for pragma in _PRAGMAS:
        connection.execute(pragma)


def _begin(connection: Connection) -> None:
    """Begin; a writer takes the lock at once, since a lock upgrade in mid-transaction can only fail."""
    immediate = connection.get_execution_options().get("immediate", False)
    connection.exec_driver_sql("BEGIN IMMEDIATE" if immediate else "BEGIN")


@contextmanager
def writing(engine: Engine) -> Iterator[Connection]:
    """Open a transaction that may write."""
    with engine.execution_options(immediate=True).begin() as connection:
        yield connection


@contextmanager
def reading(engine: Engine) -> Iterator[Connection]:
    """Open a transaction that reads one consistent state."""
    with engine.begin() as connection:
        yield connection


def now() -> str:
    """Return this instant as RFC 3339 in UTC, sortable as text."""
    return datetime.now(UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")
