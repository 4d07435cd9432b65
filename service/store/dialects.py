"""All that differs between SQLite and PostgreSQL; steps that outlast a lost connection."""

from __future__ import annotations

import errno
import functools
import math
import os
import shutil
import sqlite3
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar, cast

import structlog
from sqlalchemy import URL, Connection, Engine, NullPool, Table, create_engine, event, func, select, text
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from tenacity import RetryCallState, Retrying, retry_if_exception, stop_after_attempt, stop_after_delay
from tenacity.wait import wait_exponential, wait_random

from lineofaction.gearbox.problems import (
    BadInput,
    Busy,
    DatabaseDamaged,
    DatabaseUnavailable,
    NoSpace,
    OutOfFiles,
)
from service.store.writers import TurnTimeout, writers_of

# Space on the disks that are written to, and files that this process may still open.


LEAST_FREE = 16_000_000
"""Bytes below which a folder counts as full: four times the longest body of a submission, which the database
writes more than once."""

CHANNEL = "loa_jobs"
"""What PostgreSQL notifies on when a job changed; the triggers of schema 0011 do."""
_POLL_S = 0.05
_SLICE_S = 0.25
PATIENCE_MS = 10_000
"""How long a transaction waits for others that write, if it says nothing else."""
_PRAGMAS = (
    f"PRAGMA busy_timeout={PATIENCE_MS}",  # first: the others may have to wait too
    "PRAGMA journal_mode=WAL",
    "PRAGMA synchronous=FULL",
    "PRAGMA foreign_keys=ON",
)
DEADLINE_S = 15.0
"""A statement that works for longer is ended: longer than the patience of those who wait for a lock. By the
option `deadline_s` of an engine another one, of an upgrade for example none."""
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
_CANCELED = "57014"  # by the deadline of the statement: nobody else cancels ours
_LOCKED = "55P03"  # by others, for longer than lock_timeout
_ATTEMPTS = 6
_PATIENCE_S = 5.0
"""After which a step is not tried again: one attempt may have waited for a lock as long as it may."""
_FIRST_WAIT_S, _LONGEST_WAIT_S = 0.05, 1.0
_KINDS: Mapping[str, tuple[str, type[DatabaseUnavailable]]] = {
    ROOM: ("no space", NoSpace),
    FILES: ("out of files", OutOfFiles),
}
"""Event of the log and error by what is to be done, where the database itself is sound."""
P = ParamSpec("P")
R = TypeVar("R")
logger = structlog.get_logger(__name__)


def shortage(folder: Path | None) -> str:
    """Return that there is no space left in a folder, in a sentence without its name; empty if there is."""
    with suppress(OSError):  # what cannot be looked at is told by who writes there
        free = LEAST_FREE if folder is None else shutil.disk_usage(folder).free
        if free < LEAST_FREE:
            state = (
                f"{free / 1e6:.3g} MB are free where the service writes, and it needs {LEAST_FREE / 1e6:g} MB"
            )
            return f"There is no space left: {state}. Make room on its disk."
    return ""


def out_of_files() -> bool:
    """Whether neither this process nor the system opens one more file."""
    try:
        os.close(os.open(os.devnull, os.O_RDONLY))
    except OSError as error:
        return error.errno in (errno.EMFILE, errno.ENFILE)
    return False


# News that something was committed to a database, by whichever process, without a question for rows.


class _Commits(Protocol):
    """A connection of its own that hears of commits; of the thread that made it alone."""

    def heard(self) -> bool:
        """Wait for a moment; return whether something was committed since the last call."""

    def close(self) -> None:
        """Close the connection."""


class _SqliteCommits:
    """The data version of a SQLite file, which changes with each commit of another connection."""

    def __init__(self, engine: Engine) -> None:
        self._connection = engine.raw_connection()
        self._version = self._data_version()

    def heard(self) -> bool:
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

    def heard(self) -> bool:
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
        """Return an insert that can say what happens on a conflict."""

    def turn(
        self, engine: Engine, patience_ms: int | None, *, ahead: bool
    ) -> AbstractContextManager[int | None]:
        """Wait until this process may begin to write; enter to what is left of the patience, ms.

        With `ahead` it is the next one of this process. Raises `TurnTimeout`: the patience has ended.
        """

    def take_turn(self, connection: Connection) -> None:
        """Let this transaction be the only one of those that take turns, until it ends."""

    def clock(self, connection: Connection) -> float:
        """Return the seconds since 1970 on the one clock that all users of the database read."""

    def commits(self, engine: Engine) -> _Commits:
        """Return a connection that hears of commits."""

    def busy(self, error: DBAPIError) -> bool:
        """Whether others held what is needed for too long."""

    def lost(self, error: DBAPIError) -> bool:
        """Whether the database, not the statement, is why it failed: another attempt may succeed."""

    def late(self, error: DBAPIError) -> bool:
        """Whether the statement was ended by its deadline."""

    def remedy(self, error: DBAPIError, url: URL) -> str | None:
        """Return what a person has to do before any attempt can succeed; None if it is not that."""

    def folder(self, url: URL) -> Path | None:
        """Return the folder of this machine that it writes to; None: it is elsewhere."""

    def check(self, connection: Connection) -> str | None:
        """Look through the whole database where that is cheap; return what is damaged, None if nothing is."""


class _SQLite:
    """One file with a write-ahead log, synchronous FULL, and one writer at a time."""

    upgrades_itself = True

    def engine(self, url: URL, *, pooled: bool) -> Engine:
        if url.database:  # an empty file of its owner's alone; SQLite gives its log the same rights
            file = Path(url.database)
            file.parent.mkdir(parents=True, exist_ok=True)
            with suppress(OSError):  # SQLite tells why it cannot be opened
                os.close(os.open(file, os.O_WRONLY | os.O_CREAT, 0o600))
        # no pool: a connection kept for a thread that has ended is closed by nobody, and opening one is cheap
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
        """Do nothing: who writes is alone from the start (see `_begin`)."""

    def clock(self, connection: Connection) -> float:
        """Return the machine's time: all users are on it."""
        return time.time()

    def commits(self, engine: Engine) -> _Commits:
        return _SqliteCommits(engine)

    def busy(self, error: DBAPIError) -> bool:
        return any(word in str(error.orig) for word in ("locked", "busy"))

    def lost(self, _error: DBAPIError) -> bool:
        """Deny it: a file is not reached through a network."""
        return False

    def late(self, error: DBAPIError) -> bool:
        return getattr(error.orig, "sqlite_errorcode", 0) == sqlite3.SQLITE_INTERRUPT

    def remedy(self, error: DBAPIError, url: URL) -> str | None:
        """Tell by the primary result code; a file that was replaced by an empty one has no tables."""
        if "no such table" in str(error.orig):
            return RESTORE
        code = getattr(error.orig, "sqlite_errorcode", 0) & 0xFF
        if code in (sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_IOERR):  # of files beside its own, too
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
    """When the statement of a connection has to have ended, on the monotonic clock."""

    at: float = math.inf

    def passed(self) -> bool:
        """Whether it is too late; SQLite then ends the statement."""
        return time.monotonic() > self.at


def _set_deadline(connection: Connection, *_statement: object) -> None:
    """Let a statement that begins have ended in time."""
    deadline_s = connection.get_execution_options().get("deadline_s", DEADLINE_S)
    connection.info["deadline"].at = time.monotonic() + deadline_s


def _prepare(connection: Any, record: Any) -> None:
    """Set a new connection up: we begin transactions ourselves (see `_begin`)."""
    deadline = record.info["deadline"] = _Deadline()
    connection.set_progress_handler(deadline.passed, _LOOK_EVERY)
    connection.isolation_level = None
    for pragma in _PRAGMAS:
        connection.execute(pragma)


def _begin(connection: Connection) -> None:
    """Begin; a writer takes the lock at once, since a lock upgrade in mid-transaction can only fail."""
    options = connection.get_execution_options()
    if (patience_ms := options.get("patience_ms")) is not None:  # the connection is not used again
        connection.exec_driver_sql(f"PRAGMA busy_timeout={patience_ms:d}")
    connection.exec_driver_sql("BEGIN IMMEDIATE" if options.get("immediate", False) else "BEGIN")


class _PostgreSQL:
    """A server: many writers, read committed, rows and turns locked where it matters."""

    upgrades_itself = False

    def engine(self, url: URL, *, pooled: bool) -> Engine:
        """Return an engine on the server; it is not spoken to yet.

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
            shown = url.render_as_string(hide_password=True)
            tip = "Install it: pip install 'lineofaction[postgres]'."
            raise BadInput.of("database_url", shown, "one whose driver is installed", tip) from None
        event.listen(engine, "begin", _begin_on_server)
        return engine

    def insert(self, table: Table) -> postgresql.Insert:
        return postgresql.insert(table)

    def turn(
        self, _engine: Engine, patience_ms: int | None, *, ahead: bool
    ) -> AbstractContextManager[int | None]:
        """Wait for nobody: many write at a time."""
        return nullcontext(patience_ms)

    def take_turn(self, connection: Connection) -> None:
        """Wait for the lock that all who take turns need; the transaction's end gives it back."""
        connection.execute(select(func.pg_advisory_xact_lock(_TURN)))

    def clock(self, connection: Connection) -> float:
        return float(connection.execute(text("SELECT extract(epoch FROM clock_timestamp())")).scalar_one())

    def commits(self, engine: Engine) -> _Commits:
        return _PostgresCommits(engine)

    def busy(self, error: DBAPIError) -> bool:
        return getattr(error.orig, "sqlstate", None) == _LOCKED

    def lost(self, error: DBAPIError) -> bool:
        """Whether the connection broke or never was, or the server asks to try again.

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
        """Return none: a server has its own."""
        return None

    def check(self, _connection: Connection) -> str | None:
        """Find nothing: a server has tools and an administrator of its own (pg_amcheck)."""
        return None


def _begin_on_server(connection: Connection) -> None:
    """Wait for locks but briefly, or work for longer, if requested; the transaction's end undoes it."""
    options = connection.get_execution_options()
    if (patience_ms := options.get("patience_ms")) is not None:
        connection.exec_driver_sql(f"SET LOCAL lock_timeout = {patience_ms:d}")
    if (deadline_s := options.get("deadline_s")) is not None:
        timeout_ms = 0 if math.isinf(deadline_s) else round(1e3 * deadline_s)  # 0: none
        connection.exec_driver_sql(f"SET LOCAL statement_timeout = {timeout_ms:d}")


_DIALECTS: Mapping[str, _Dialect] = {"sqlite": _SQLite(), "postgresql": _PostgreSQL()}


def dialect_of(database: Engine | Connection | URL) -> _Dialect:
    """Return what is particular to the database."""
    if isinstance(database, URL):
        return _DIALECTS[database.get_backend_name()]
    return _DIALECTS[database.dialect.name]


def _is_lost(error: BaseException, database: Engine) -> bool:
    """Whether `error` says that the database cannot be reached or asks to try again."""
    if not isinstance(error, DBAPIError) or _remedy_of(error, database) is not None:
        return False
    return dialect_of(database).lost(error)


def _is_busy(error: BaseException, database: Engine) -> bool:
    """Whether `error` says that others have had the database, or all connections to it, for too long."""
    if isinstance(error, DBAPIError):
        return dialect_of(database).busy(error)
    return isinstance(error, PoolTimeout | TurnTimeout)


def _remedy_of(error: BaseException, database: Engine) -> str | None:
    """Return what a person has to do if `error` says that the database cannot be used as it is."""
    return dialect_of(database).remedy(error, database.url) if isinstance(error, DBAPIError) else None


# Steps that outlast a lost connection: tried again for a while, then refused for the caller to try later.


class _OnDatabase(Protocol):
    """An object that works on a database."""

    _engine: Engine


S = TypeVar("S", bound=_OnDatabase)


def retried(step: Callable[Concatenate[S, P], R]) -> Callable[Concatenate[S, P], R]:
    """Let a method outlast a lost connection.

    The method may be run again after its transaction was committed, when the answer to that was lost: a
    second run must change nothing.

    Raises
    ------
    DatabaseUnavailable
        The database has not come back after about two seconds.
    Busy
        Others hold what is needed for too long.
    DatabaseDamaged
        It has to be mended first: damaged, read-only. Not tried again.
    NoSpace, OutOfFiles
        Its disk is full, or this process may open no more files. Not tried again.
    """

    @functools.wraps(step)
    def run(self: S, *args: P.args, **kwargs: P.kwargs) -> R:
        engine = self._engine
        attempts = Retrying(
            retry=retry_if_exception(lambda error: _is_lost(error, engine) or _is_busy(error, engine)),
            stop=stop_after_attempt(_ATTEMPTS) | stop_after_delay(_PATIENCE_S),
            wait=wait_exponential(_FIRST_WAIT_S, _LONGEST_WAIT_S) + wait_random(0.0, _FIRST_WAIT_S),
            before_sleep=_note,
            reraise=True,
        )
        try:
            return attempts(step, self, *args, **kwargs)
        except SQLAlchemyError as error:
            outage = outage_of(error, engine)
            if outage is None:
                raise
            raise outage from error

    return cast(Callable[Concatenate[S, P], R], run)


def outage_of(error: SQLAlchemyError, engine: Engine) -> DatabaseUnavailable | None:
    """Return the message about an error of the database itself; None: it is the statement's."""
    if _is_busy(error, engine):
        return Busy("Others write, and have not ended in time. Nothing was changed. Try again later.")
    if _is_lost(error, engine):
        return DatabaseUnavailable("The database cannot be reached. Try again later.")
    if isinstance(error, DBAPIError) and dialect_of(engine).late(error):
        text = "The database has not answered in time. Ask for less of a list, or try again later."
        return DatabaseUnavailable(text)
    remedy = _remedy_of(error, engine)
    return None if remedy is None else unusable(engine, str(getattr(error, "orig", error)), remedy)


def unusable(engine: Engine, fault: str, remedy: str) -> DatabaseUnavailable:
    """Return the error of a database that somebody has to see to; the log alone says where it is."""
    where = engine.url.render_as_string(hide_password=True)
    event, kind = _KINDS.get(remedy, ("database damaged", DatabaseDamaged))
    logger.error(event, database=where, error=fault, remedy=remedy)
    error = kind(f"{kind.title}: {fault}.")
    error.add_note(f"{where}: {remedy}")
    return error


def optional(step: Callable[Concatenate[S, P], None]) -> Callable[Concatenate[S, P], None]:
    """Let a method pass without effect when the database is lost or busy: its caller goes on without."""

    @functools.wraps(step)
    def run(self: S, *args: P.args, **kwargs: P.kwargs) -> None:
        try:
            step(self, *args, **kwargs)
        except SQLAlchemyError as error:
            away = _is_lost(error, self._engine) or _is_busy(error, self._engine)
            if not away and _remedy_of(error, self._engine) is None:
                raise

    return cast(Callable[Concatenate[S, P], None], run)


def _note(state: RetryCallState) -> None:
    outcome = state.outcome
    error = outcome.exception() if outcome is not None else None
    logger.warning("database lost", attempt=state.attempt_number, error=type(error).__name__)
