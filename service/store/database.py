"""The database: a SQLite file or a PostgreSQL server, by URL; its schema and upgrade."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from sqlalchemy import URL, Connection, Engine, MetaData, inspect, make_url, text
from sqlalchemy.exc import ArgumentError

from lineofaction.gearbox.problems import BadInput
from service.store.dialects import RESTORE, dialect_of
from service.store.migrations import REVISIONS, USABLE_SINCE, migrate
from service.store.retries import retried, unusable

NEWEST = "schema_version"
"""The table with the number of the last step that was made."""
_OLDEST = "alembic_version"
"""The table with the number of the oldest schema whose program can use the tables: all that program reads."""
_UNNUMBERED = "computation"
"""Table of databases whose schema had no number."""

metadata = MetaData()
BRIEF_MS = 100
"""Longest wait for the database of transactions that may fail without harm, ms."""
_DRIVERS = {"sqlite": "sqlite", "postgresql": "postgresql+psycopg"}


@dataclass(frozen=True)
class _SchemaNumbers:
    """Numbers of the schema as the database states them."""

    newest: str | None
    """Number of the last step that was made; None: the database has no tables."""
    usable_since: str | None
    """Number of the oldest schema whose program can use the tables."""

    @property
    def ours(self) -> bool:
        """Whether the schema is that of this program."""
        return self.newest == REVISIONS[-1]

    @property
    def unknown(self) -> bool:
        """Whether a newer program made the schema."""
        return self.newest is not None and self.newest not in REVISIONS

    @property
    def usable(self) -> bool:
        """Whether this program can use the schema: it is its own, or a newer one with additions only."""
        return self.ours or (self.unknown and self.usable_since in REVISIONS)


def _schema_numbers(connection: Connection) -> _SchemaNumbers:
    """Read the numbers of a database; up to version 0.2.0 it has only the table `_OLDEST`, or no number."""
    tables = inspect(connection).get_table_names()
    oldest = _number(connection, _OLDEST) if _OLDEST in tables else None
    if NEWEST in tables:
        return _SchemaNumbers(_number(connection, NEWEST), oldest)
    if oldest is None and _UNNUMBERED in tables:
        oldest = REVISIONS[0]
    return _SchemaNumbers(oldest, oldest)


def _write_number(connection: Connection, table: str, number: str) -> None:
    key = f"CONSTRAINT {table}_pkc PRIMARY KEY (version_num)"
    connection.execute(text(f"CREATE TABLE IF NOT EXISTS {table} (version_num VARCHAR(32) NOT NULL, {key})"))
    connection.execute(text(f"DELETE FROM {table}"))
    connection.execute(text(f"INSERT INTO {table} (version_num) VALUES (:number)"), {"number": number})


def _number(connection: Connection, table: str) -> str | None:
    number = connection.execute(text(f"SELECT version_num FROM {table}")).scalar()
    return None if number is None else str(number)


class Schema:
    """The tables of one database."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    @retried
    def numbers(self) -> _SchemaNumbers:
        """Return the numbers of the schema."""
        with self._engine.begin() as connection:
            return _schema_numbers(connection)

    def revision(self) -> str | None:
        """Return the number of the schema; None: there are no tables."""
        return self.numbers().newest

    @retried
    def check(self) -> None:
        """Check the integrity of the database, before long work on it.

        Raises `DatabaseDamaged`, whose notes say where the damage is and what to do.
        """
        with self._engine.execution_options(deadline_s=math.inf).begin() as connection:
            fault = dialect_of(connection).check(connection)
        if fault is not None:
            raise unusable(self._engine, fault, RESTORE)

    @retried
    def upgrade(self) -> None:
        """Bring the tables up to date, all or nothing; processes that do so at the same time take turns.

        A newer schema that this program can use stays.

        Raises `BadInput`: the schema is newer, and this program cannot use it.
        """
        with self._engine.execution_options(immediate=True, deadline_s=math.inf).begin() as connection:
            dialect_of(connection).take_turn(connection)
            numbers = _schema_numbers(connection)
            _refuse_newer(numbers, self._engine)
            if not numbers.usable:
                migrate(connection, numbers.newest)
                _write_number(connection, NEWEST, REVISIONS[-1])
                _write_number(connection, _OLDEST, USABLE_SINCE)


def _prepare_schema(engine: Engine) -> None:
    """Make the tables usable for this program: a SQLite file is upgraded, a server's database is not.

    Raises `BadInput`: the schema is newer with more than additions, or an older one of a server.
    """
    schema = Schema(engine)
    numbers = schema.numbers()
    if numbers.usable:
        return
    if dialect_of(engine).upgrades_itself:
        schema.upgrade()
        return
    _refuse_newer(numbers, engine)
    state = "it has no tables" if numbers.newest is None else f"it has {numbers.newest}"
    bound = f"of schema {REVISIONS[-1]}: {state}"
    raise BadInput.of("database_url", redacted_url(engine), bound, "Run loa database upgrade first.")


def redacted_url(engine: Engine) -> str:
    """Return the URL without its password."""
    return engine.url.render_as_string(hide_password=True)


def _refuse_newer(numbers: _SchemaNumbers, engine: Engine) -> None:
    if numbers.unknown and not numbers.usable:
        bound = f"of schema {REVISIONS[-1]} or older: it has {numbers.newest}"
        tip = "A newer lineofaction made it. Use that one, or another database."
        raise BadInput.of("database_url", redacted_url(engine), bound, tip)


def open_database(where: Path | str, *, pooled: bool = True) -> Engine:
    """Return an engine on the database, whose schema this program can use.

    This call upgrades a SQLite file; ``loa database upgrade`` upgrades the database of a server. Raises
    `BadInput`: no URL, its driver is not installed, or the schema is another program's;
    `DatabaseUnavailable`: the server does not answer.

    Parameters
    ----------
    where : Path or str
        A SQLite file, made if it does not exist, or a URL: ``sqlite:///FILE`` or ``postgresql://...``.
    pooled : bool
        Keep connections for the next transaction, where opening one costs much.
    """
    engine = database_engine(where, pooled=pooled)
    try:
        _prepare_schema(engine)
    except BaseException:
        engine.dispose()
        raise
    return engine


def database_engine(where: Path | str, *, pooled: bool = True) -> Engine:
    """Return an engine on the database, whatever its schema; raises `BadInput` as `open_database`."""
    url = URL.create("sqlite", database=str(where)) if isinstance(where, Path) else _url(where)
    return dialect_of(url).engine(url, pooled=pooled)


def _url(text: str) -> URL:
    """Read a URL; its driver is replaced by the one that this program uses."""
    try:
        url = make_url(text.replace("postgres://", "postgresql://", 1))
        return url.set(drivername=_DRIVERS[url.get_backend_name()])
    except (ArgumentError, KeyError, ValueError):
        bound = "a URL such as sqlite:////srv/loa.sqlite3 or postgresql://user:password@host/name"
        raise BadInput.of("database_url", "(not shown)", bound) from None


@contextmanager
def writing(
    engine: Engine, *, in_turn: bool = False, patience_ms: int | None = None, ahead: bool = False
) -> Iterator[Connection]:
    """Open a transaction that may write.

    With `in_turn` no other transaction of that kind runs at the same time, so what it has read from the
    tables does not change until it ends; other transactions rely on locks of rows. It fails if others lock
    the database for longer than `patience_ms`, by default `PATIENCE_MS`. With `ahead` it is the next one of
    those that wait in this process.
    """
    dialect = dialect_of(engine)
    with ExitStack() as stack:
        connection = stack.enter_context(engine.connect())  # before the turn: opening it takes a while
        left_ms = stack.enter_context(dialect.turn(engine, patience_ms, ahead=ahead))
        connection.execution_options(immediate=True, patience_ms=left_ms)
        stack.enter_context(connection.begin())
        if in_turn:
            dialect.take_turn(connection)
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
