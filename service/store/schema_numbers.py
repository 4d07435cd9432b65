"""The two numbers of a database's schema: of its tables, and of the oldest program that can use them."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, inspect, text

from service.store.migrations import REVISIONS, USABLE_SINCE

NEWEST = "schema_version"
"""The table with the number of the last step that was made."""
_OLDEST = "alembic_version"
"""The table with the number of the oldest schema whose program can use the tables: all that program reads."""
_UNNUMBERED = "computation"
"""A table that databases had before their schemas had numbers."""


@dataclass(frozen=True)
class SchemaNumbers:
    """What a database says of its schema.

    Attributes
    ----------
    newest : str or None
        Number of the last step that was made; None: there are no tables.
    usable_since : str or None
        Number of the oldest schema whose program can use the tables.
    """

    newest: str | None
    usable_since: str | None

    @property
    def ours(self) -> bool:
        """Whether the schema is this program's own."""
        return self.newest == REVISIONS[-1]

    @property
    def unknown(self) -> bool:
        """Whether a newer program made it."""
        return self.newest is not None and self.newest not in REVISIONS

    @property
    def usable(self) -> bool:
        """Whether this program can use it: its own, or a newer one that only added."""
        return self.ours or (self.unknown and self.usable_since in REVISIONS)


def schema_numbers(connection: Connection) -> SchemaNumbers:
    """Read the numbers of a database; one of version 0.2.0 or older has the second alone."""
    tables = inspect(connection).get_table_names()
    oldest = _number(connection, _OLDEST) if _OLDEST in tables else None
    if NEWEST in tables:
        return SchemaNumbers(_number(connection, NEWEST), oldest)
    if oldest is None and _UNNUMBERED in tables:
        oldest = REVISIONS[0]
    return SchemaNumbers(oldest, oldest)


def write_oldest(connection: Connection) -> None:
    """Write down the oldest schema whose program can use the tables of this one."""
    connection.execute(text(f"CREATE TABLE IF NOT EXISTS {_OLDEST} (version_num VARCHAR(32) NOT NULL)"))
    connection.execute(text(f"DELETE FROM {_OLDEST}"))
    connection.execute(
        text(f"INSERT INTO {_OLDEST} (version_num) VALUES (:number)"), {"number": USABLE_SINCE}
    )


def _number(connection: Connection, table: str) -> str | None:
    number = connection.execute(text(f"SELECT version_num FROM {table}")).scalar()
    return None if number is None else str(number)
