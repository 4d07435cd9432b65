"""One server owns a job table: by a lock that the system or the database lifts when the server dies."""

from __future__ import annotations

import os
from contextlib import ExitStack, suppress
from pathlib import Path

from sqlalchemy import Connection, Engine, text
from sqlalchemy.exc import SQLAlchemyError

from lineofaction.gearbox.problems import BadInput
from service.folders import locked
from service.store.database import redacted_url
from service.store.dialects import dialect_of
from service.store.retries import retried

_LOCK = text("SELECT pg_try_advisory_lock(:ours, CAST(CAST('computation' AS regclass) AS oid)::int4)")
_OURS = {"ours": 0x6C6F61}
"""First key of the lock, "loa"; the second is the table: a database may have several, by their schemas."""


class Ownership:
    """The lock on the job table of a database, used by one thread at a time.

    For SQLite it is a lock on a file beside the database, which lasts as long as the process. For PostgreSQL
    it is an advisory lock of a separate session. It ends with the session, also by a restart of the database
    or a broken network. Then `lost` is true, and the lock may be acquired again.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._file: int | None = None
        self._session: Connection | None = None

    @retried
    def acquire(self) -> None:
        """Take the lock, unless this process has it already.

        Raises `BadInput`: another server has it; `DatabaseUnavailable`: the database does not answer.
        """
        if not self.lost() or (self._lock_file() if self._is_file else self._lock_session()):
            return
        bound = "free: another server works on its jobs"
        tip = "One server owns a job table. Stop that server, or choose another database."
        raise BadInput.of("database_url", redacted_url(self._engine), bound, tip)

    def lost(self) -> bool:
        """Whether this process does not have the lock, or its session does not answer any more."""
        if self._is_file:
            return self._file is None
        if self._session is not None:
            with suppress(SQLAlchemyError):
                self._session.execute(text("SELECT 1"))
                return False
            self.release()
        return True

    def release(self) -> None:
        """Give the lock back."""
        if self._file is not None:
            os.close(self._file)
        if self._session is not None:
            self._session.close()
        self._file = self._session = None

    @property
    def _is_file(self) -> bool:
        return self._engine.dialect.name == "sqlite"

    def _lock_file(self) -> bool:
        self._file = locked(Path(f"{self._engine.url.database}.owner"))
        return self._file is not None

    def _lock_session(self) -> bool:
        """Open a session that is in no pool, and request the lock in it."""
        unpooled = dialect_of(self._engine).engine(self._engine.url, pooled=False)
        with ExitStack() as closing:  # closes the session, unless it has the lock
            session = closing.enter_context(
                unpooled.connect().execution_options(isolation_level="AUTOCOMMIT")
            )
            if session.execute(_LOCK, _OURS).scalar_one():
                self._session = session
                closing.pop_all()
        return self._session is not None
