"""News that something was committed to a database, by whichever process, without a question for rows."""

from __future__ import annotations

import time
from typing import Any, Protocol, cast

from sqlalchemy import Engine

CHANNEL = "loa_jobs"
"""What PostgreSQL notifies on when a job changed; the triggers of schema 0011 do."""
_POLL_S = 0.05
_SLICE_S = 0.25


class Commits(Protocol):
    """A connection of its own that hears of commits; of the thread that made it alone."""

    def heard(self) -> bool:
        """Wait for a moment; return whether something was committed since the last call."""

    def close(self) -> None:
        """Close the connection."""


class SqliteCommits:
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
        """Read the version."""
        cursor = self._connection.cursor()
        try:
            return int(cursor.execute("PRAGMA data_version").fetchone()[0])
        finally:
            cursor.close()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()


class PostgresCommits:
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
        """Close the connection."""
        self._connection.close()
