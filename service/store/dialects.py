"""All that differs between SQLite and PostgreSQL.

A turn is the right to write, in an order that all writers keep. Patience is the time that a writer waits.
"""

from __future__ import annotations

import math
import os
import sqlite3
import time
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, cast

from sqlalchemy import URL, Connection, Engine, NullPool, Table, create_engine, event, func, select, text
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import DBAPIError

from lineofaction.gearbox.problems import BadInput
from service.store.shortages import out_of_files, shortage
from service.store.writers import writers_of

CHANNEL = "loa_jobs"
"""Channel on which PostgreSQL notifies of a changed job, by the triggers of schema 0011."""
_POLL_S = 0.05
_SLICE_S = 0.25
PATIENCE_MS = 10_000
"""Milliseconds for which a transaction waits for others that write, unless it states another patience."""
_PRAGMAS = (
    f"PRAGMA busy_timeout={PATIENCE_MS}",  # first, since the other pragmas may wait for a lock, too
    "PRAGMA journal_mode=WAL",
    "PRAGMA synchronous=FULL",
    "PRAGMA foreign_keys=ON",
)
DEADLINE_S = 15.0
"""Seconds after which a statement is ended, longer than the patience of transactions that wait for a lock.
The option `deadline_s` of an engine sets another limit; for an upgrade there is none."""
_LOOK_EVERY = 20_000
"""Instructions of SQLite's machine between two looks at the clock: some milliseconds."""
_TURN = 0x6C6F61  # "loa": any number that all our processes know
_CONNECT_TIMEOUT_S = 5
_STALLED = (
    f"-c idle_in_transaction_session_timeout=30s -c lock_timeout={PATIENCE_MS} "
    f"-c statement_timeout={DEADLINE_S:g}s "
    "-c tcp_keepalives_idle=10 -c tcp_keepalives_interval=5 -c tcp_keepalives_count=3"
)
"""A stalled process must not hold rows for ever, nor let its callers wait for longer than a client does; the
locks of a machine that is gone end after half a minute."""
_SILENT: Mapping[str, Any] = {
    "keepalives_idle": 10,
    "keepalives_interval": 5,
    "keepalives_count": 3,
    "tcp_user_timeout": 20_000,
}
"""A network that swallows everything is noticed after half a minute, not after the system's quarter hour."""
_POOL: Mapping[str, Any] = {"pool_size": 5, "max_overflow": 15, "pool_timeout": 5.0, "pool_pre_ping": True}
RESTORE = (
    "Stop the service. Restore the database from its backup; or move it aside, for SQLite with its -wal and "
    "-shm, and rebuild the index of results with loa store reindex (docs/how-to/runbooks.md)."
)
_RIGHTS = "Give the service the right to write it, and for SQLite its folder."
ROOM = "Make room on its disk."
FILES = "Let the process open more files (ulimit -n, LimitNOFILE= of systemd), or end what holds them."
_DISK = "Look at its disk and at the log of the system."
_SQLITE_REMEDIES: Mapping[int, str] = {
    sqlite3.SQLITE_CORRUPT: RESTORE,
    sqlite3.SQLITE_NOTADB: RESTORE,
    sqlite3.SQLITE_PERM: _RIGHTS,
    sqlite3.SQLITE_READONLY: _RIGHTS,
    sqlite3.SQLITE_CANTOPEN: _RIGHTS,
    sqlite3.SQLITE_FULL: ROOM,
    sqlite3.SQLITE_IOERR: _DISK,
    sqlite3.SQLITE_PROTOCOL: _DISK,
}
_POSTGRESQL_REMEDIES: Mapping[str, str] = {
    "XX001": RESTORE,  # data corrupted
    "XX002": RESTORE,  # index corrupted
    "42P01": RESTORE,  # undefined table
    "25006": _RIGHTS,  # read-only transaction
    "42501": _RIGHTS,  # insufficient privilege
    "53100": ROOM,  # disk full
    "58030": _DISK,  # I/O error
}
_CANCELED = "57014"  # state of PostgreSQL: the statement exceeded its deadline, the only cause here
_LOCKED = "55P03"  # state of PostgreSQL: others held the lock for longer than lock_timeout


class _Commits(Protocol):
    """A connection that notices commits, for the thread that made it."""

    def received(self) -> bool:
        """Wait for a moment; return whether something was committed since the last call."""

    def close(self) -> None:
        """Close the connection."""


class _SqliteCommits:
    """The data version of a SQLite file, which changes with each commit of another connection."""

    def __init__(self, engine: Engine) -> None:
        self._connection = engine.raw_connection()
        self._version = self._data_version()

    def received(self) -> bool:
        """Compare the version after 50 ms; it is read in some microseconds."""
        time.sleep(_POLL_S)
        before, self._version = self._version, self._data_version()
        return self._version != before

    def _data_version(self) -> int:
        cursor = self._connection.cursor()
        try:
            return int(cursor.execute("PRAGMA data_version").fetchone()[0])
        finally:
            cursor.close()

    def close(self) -> None:
        self._connection.close()


class _PostgresCommits:
    """Notifications of a PostgreSQL server that a job changed."""

    def __init__(self, engine: Engine) -> None:
        pooled = engine.raw_connection()
        self._connection = cast(Any, pooled.driver_connection)
        pooled.detach()
        self._connection.autocommit = True
        self._connection.execute(f"LISTEN {CHANNEL}")

    def received(self) -> bool:
        """Wait for a notification, for at most 0.25 s."""
        return any(True for _ in self._connection.notifies(timeout=_SLICE_S, stop_after=1))

    def close(self) -> None:
        self._connection.close()


class _Dialect(Protocol):
    """The functions of a database beyond SQL that all understand, for the store and the job table."""

    upgrades_itself: bool

    def engine(self, url: URL, *, pooled: bool) -> Engine:
        """Return an engine; `pooled` keeps connections for the next transaction where that pays."""

    def insert(self, table: Table) -> sqlite.Insert | postgresql.Insert:
        """Return an insert that can state its action on a conflict."""

    def turn(
        self, engine: Engine, patience_ms: int | None, *, ahead: bool
    ) -> AbstractContextManager[int | None]:
        """Return a context that waits until this writer may begin, and gives the rest of its patience, ms.

        With `ahead` it goes before the waiting writers of this process. Raises `TurnTimeout`: the patience
        has ended.
        """

    def take_turn(self, connection: Connection) -> None:
        """Exclude all other transactions that take a turn, until this one ends."""

    def clock(self, connection: Connection) -> float:
        """Return the seconds since 1970 on the one clock that all users of the database read."""

    def commits(self, engine: Engine) -> _Commits:
        """Return a connection that notices commits."""

    def busy(self, error: DBAPIError) -> bool:
        """Whether others held a needed lock for too long."""

    def lost(self, error: DBAPIError) -> bool:
        """Whether a statement failed by a fault of the database, so that another attempt may succeed."""

    def late(self, error: DBAPIError) -> bool:
        """Whether the statement was ended by its deadline."""

    def remedy(self, error: DBAPIError, url: URL) -> str | None:
        """Return what a person must do before an attempt can succeed; None: nothing."""

    def folder(self, url: URL) -> Path | None:
        """Return the folder of this machine that the database writes to; None: it is on a server."""

    def check(self, connection: Connection) -> str | None:
        """Check the whole database if that is cheap; return the damage, or None."""


class _SQLite:
    """One file with a write-ahead log, synchronous FULL, and one writer at a time."""

    upgrades_itself = True

    def engine(self, url: URL, *, pooled: bool) -> Engine:
        if url.database:  # an empty file that only its owner reads; SQLite gives its log the same rights
            file = Path(url.database)
            file.parent.mkdir(parents=True, exist_ok=True)
            with suppress(OSError):  # SQLite's own error says why the file cannot be opened
                os.close(os.open(file, os.O_WRONLY | os.O_CREAT, 0o600))
        # no pool: nothing closes a pooled connection of a thread that has ended, and opening one is cheap
        engine = create_engine(url, poolclass=NullPool)
        event.listen(engine, "connect", _prepare)
        event.listen(engine, "begin", _begin)
        event.listen(engine, "before_cursor_execute", _set_deadline)
        return engine

    def insert(self, table: Table) -> sqlite.Insert:
        return sqlite.insert(table)

    @contextmanager
    def turn(self, engine: Engine, patience_ms: int | None, *, ahead: bool) -> Iterator[int]:
        patience_s = (PATIENCE_MS if patience_ms is None else patience_ms) / 1e3
        with writers_of(str(engine.url.database)).turn(patience_s, ahead=ahead) as left_s:
            yield round(1e3 * left_s)

    def take_turn(self, connection: Connection) -> None:
        """Do nothing: a writer has the whole file from its begin on (see `_begin`)."""

    def clock(self, connection: Connection) -> float:
        """Return the time of this machine, on which all users of the file run."""
        return time.time()

    def commits(self, engine: Engine) -> _Commits:
        return _SqliteCommits(engine)

    def busy(self, error: DBAPIError) -> bool:
        return any(word in str(error.orig) for word in ("locked", "busy"))

    def lost(self, _error: DBAPIError) -> bool:
        """Return False: a file is not reached through a network."""
        return False

    def late(self, error: DBAPIError) -> bool:
        return getattr(error.orig, "sqlite_errorcode", 0) == sqlite3.SQLITE_INTERRUPT

    def remedy(self, error: DBAPIError, url: URL) -> str | None:
        """Return the action by the primary result code, the low byte, or for a file that lost its tables."""
        if "no such table" in str(error.orig):
            return RESTORE
        code = getattr(error.orig, "sqlite_errorcode", 0) & 0xFF
        if code in (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_IOERR):  # its log and temporary files, too
            if out_of_files():
                return FILES
            if shortage(self.folder(url)):
                return ROOM
        return _SQLITE_REMEDIES.get(code)

    def folder(self, url: URL) -> Path | None:
        return Path(url.database).parent if url.database else None

    def check(self, connection: Connection) -> str | None:
        """Read every page, some 0.1 to 1 s for 100 MB."""
        verdict = str(connection.exec_driver_sql("PRAGMA quick_check(1)").scalar_one())
        return None if verdict == "ok" else verdict


@dataclass
class _Deadline:
    """The deadline of a connection's statement, on the monotonic clock."""

    at: float = math.inf

    def passed(self) -> bool:
        """Whether the deadline has passed; SQLite then ends the statement."""
        return time.monotonic() > self.at


def _set_deadline(connection: Connection, *_statement: object) -> None:
    """Set the deadline of a statement that begins."""
    deadline_s = connection.get_execution_options().get("deadline_s", DEADLINE_S)
    connection.info["deadline"].at = time.monotonic() + deadline_s


def _prepare(connection: Any, record: Any) -> None:
    """Prepare a new connection."""
    deadline = _Deadline()
    record.info["deadline"] = deadline
    connection.set_progress_handler(deadline.passed, _LOOK_EVERY)
    connection.isolation_level = None  # the driver begins no transactions: `_begin` does
    for pragma in _PRAGMAS:
        connection.execute(pragma)


def _begin(connection: Connection) -> None:
    """Begin a transaction; a writer locks at once, since to change from reading to writing may fail."""
    options = connection.get_execution_options()
    if (patience_ms := options.get("patience_ms")) is not None:  # the connection is not used again
        connection.exec_driver_sql(f"PRAGMA busy_timeout={patience_ms:d}")
    connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get("immediate", False) else "BEGIN")


class _PostgreSQL:
    """A server: many writers, read committed, rows and turns locked where it matters."""

    upgrades_itself = False

    def engine(self, url: URL, *, pooled: bool) -> Engine:
        """Return an engine on the server, without a connection yet.

        Raises `BadInput`: the driver is not installed.
        """
        arguments = {
            "connect_timeout": _CONNECT_TIMEOUT_S,
            "application_name": "lineofaction",
            "options": _STALLED,
            **_SILENT,
        }
        pool: Mapping[str, Any] = _POOL if pooled else {"poolclass": NullPool}
        try:
            engine = create_engine(url, connect_args=arguments, **pool)
        except ModuleNotFoundError:
            redacted_url = url.render_as_string(hide_password=True)
            tip = "Install it: pip install 'lineofaction[postgres]'."
            raise BadInput.of("database_url", redacted_url, "one whose driver is installed", tip) from None
        event.listen(engine, "begin", _begin_on_server)
        return engine

    def insert(self, table: Table) -> postgresql.Insert:
        return postgresql.insert(table)

    def turn(
        self, _engine: Engine, patience_ms: int | None, *, ahead: bool
    ) -> AbstractContextManager[int | None]:
        """Return without waiting: a server takes many writers at a time."""
        return nullcontext(patience_ms)

    def take_turn(self, connection: Connection) -> None:
        """Wait for the lock of turns; the end of the transaction releases it."""
        connection.execute(select(func.pg_advisory_xact_lock(_TURN)))

    def clock(self, connection: Connection) -> float:
        return float(connection.execute(text("SELECT extract(epoch FROM clock_timestamp())")).scalar_one())

    def commits(self, engine: Engine) -> _Commits:
        return _PostgresCommits(engine)

    def busy(self, error: DBAPIError) -> bool:
        return getattr(error.orig, "sqlstate", None) == _LOCKED

    def lost(self, error: DBAPIError) -> bool:
        """Whether the connection broke or was never made, or the server asks to try again.

        Classes of SQLSTATE: 08 connection, 40 rolled back (deadlock), 53 out of resources, 57P server ends.
        """
        state = getattr(error.orig, "sqlstate", None)
        if state is None:
            return type(error.orig).__name__ in ("OperationalError", "InterfaceError", "ConnectionTimeout")
        return error.connection_invalidated or state.startswith(("08", "40", "53", "57P"))

    def late(self, error: DBAPIError) -> bool:
        return getattr(error.orig, "sqlstate", None) == _CANCELED

    def remedy(self, error: DBAPIError, url: URL) -> str | None:
        return _POSTGRESQL_REMEDIES.get(getattr(error.orig, "sqlstate", None) or "")

    def folder(self, url: URL) -> Path | None:
        """Return None: the folder is the server's."""
        return None

    def check(self, _connection: Connection) -> str | None:
        """Return None: a server has tools and an administrator of its own (pg_amcheck)."""
        return None


def _begin_on_server(connection: Connection) -> None:
    """Set the patience and the deadline of a transaction, if they are requested, until it ends."""
    options = connection.get_execution_options()
    if (patience_ms := options.get("patience_ms")) is not None:
        connection.exec_driver_sql(f"SET LOCAL lock_timeout = {patience_ms:d}")
    if (deadline_s := options.get("deadline_s")) is not None:
        timeout_ms = 0 if math.isinf(deadline_s) else round(1e3 * deadline_s)  # 0: no deadline
        connection.exec_driver_sql(f"SET LOCAL statement_timeout = {timeout_ms:d}")


_DIALECTS: Mapping[str, _Dialect] = {"sqlite": _SQLite(), "postgresql": _PostgreSQL()}


def dialect_of(database: Engine | Connection | URL) -> _Dialect:
    """Return the dialect of the database."""
    if isinstance(database, URL):
        return _DIALECTS[database.get_backend_name()]
    return _DIALECTS[database.dialect.name]
