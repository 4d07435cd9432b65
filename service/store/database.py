"""The database: a SQLite file or a PostgreSQL server, by URL."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import URL, Connection, Engine, MetaData, make_url
from sqlalchemy.exc import ArgumentError

from lineofaction.gearbox.problems import BadInput
from service.store.dialects import dialect_of
from service.store.schema import prepare_schema

metadata = MetaData()
BRIEF_MS = 100
"""Patience of those who can do without what they write."""

_DRIVERS = {"sqlite": "sqlite", "postgresql": "postgresql+psycopg"}


def open_database(where: Path | str, *, pooled: bool = True) -> Engine:
    """Return an engine on the database, its schema of this program.

    Parameters
    ----------
    where : Path or str
        A SQLite file, made if it does not exist, or a URL: ``sqlite:///FILE`` or ``postgresql://...``.
    pooled : bool
        Keep connections for the next transaction, where opening one costs much.

    Raises
    ------
    BadInput
        The URL is none, its driver is not installed, or the schema is another program's: a SQLite file is
        brought up to date by this call, a server by ``loa database upgrade``.
    DatabaseUnavailable
        The server does not answer.
    """
    engine = database_engine(where, pooled=pooled)
    try:
        prepare_schema(engine)
    except BaseException:
        engine.dispose()
        raise
    return engine


def database_engine(where: Path | str, *, pooled: bool = True) -> Engine:
    """Return an engine on the database, whatever its schema; raises `BadInput` as `open_database`."""
    url = _file_url(where) if isinstance(where, Path) else _url(where)
    return dialect_of(url).engine(url, pooled=pooled)


def _file_url(file: Path) -> URL:
    return URL.create("sqlite", database=str(file))


def _url(text: str) -> URL:
    """Read a URL; the driver is ours to choose."""
    try:
        url = make_url(text.replace("postgres://", "postgresql://", 1))
        return url.set(drivername=_DRIVERS[url.get_backend_name()])
    except (ArgumentError, KeyError, ValueError):
        bound = "a URL such as sqlite:////srv/loa.sqlite3 or postgresql://user:password@host/name"
        raise BadInput.of("database_url", "(not shown)", bound) from None


@contextmanager
def writing(engine: Engine, *, in_turn: bool = False, patience_ms: int | None = None) -> Iterator[Connection]:
    """Open a transaction that may write.

    With `in_turn` it is alone among all that take turns: what it has read stays so until it ends. Others
    rely on the rows they lock. It fails if others hold the database for longer than `patience_ms`, by default
    10 s.
    """
    with engine.execution_options(immediate=True, patience_ms=patience_ms).begin() as connection:
        if in_turn:
            dialect_of(connection).take_turn(connection)
        yield connection


@contextmanager
def reading(engine: Engine) -> Iterator[Connection]:
    """Open a transaction that reads."""
    with engine.begin() as connection:
        yield connection


def now() -> str:
    """Return this instant as RFC 3339 in UTC, sortable as text."""
    return instant(datetime.now(UTC))


def instant(time: datetime) -> str:
    """Return an instant in UTC as RFC 3339, sortable as text."""
    return time.isoformat(timespec="microseconds").replace("+00:00", "Z")
