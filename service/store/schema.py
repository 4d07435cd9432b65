"""The schema of the database: its revisions, and its upgrade."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Connection, Engine, inspect, text

from lineofaction.gearbox.problems import BadInput
from service.store.dialects import RESTORE, dialect_of
from service.store.migrations import REVISIONS, USABLE_SINCE, migrate
from service.store.outages import retried, unusable

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


def _schema_numbers(connection: Connection) -> SchemaNumbers:
    """Read the numbers of a database; one of version 0.2.0 or older has the second alone."""
    tables = inspect(connection).get_table_names()
    oldest = _number(connection, _OLDEST) if _OLDEST in tables else None
    if NEWEST in tables:
        return SchemaNumbers(_number(connection, NEWEST), oldest)
    if oldest is None and _UNNUMBERED in tables:
        oldest = REVISIONS[0]
    return SchemaNumbers(oldest, oldest)


def _write_number(connection: Connection, table: str, number: str) -> None:
    key = f"CONSTRAINT {table}_pkc PRIMARY KEY (version_num)"
    connection.execute(text(f"CREATE TABLE IF NOT EXISTS {table} (version_num VARCHAR(32) NOT NULL, {key})"))
    connection.execute(text(f"DELETE FROM {table}"))
    connection.execute(text(f"INSERT INTO {table} (version_num) VALUES (:number)"), {"number": number})


def _number(connection: Connection, table: str) -> str | None:
    number = connection.execute(text(f"SELECT version_num FROM {table}")).scalar()
    return None if number is None else str(number)


class Schema:
    """The tables of one database.

    Parameters
    ----------
    engine : Engine
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    @retried
    def numbers(self) -> SchemaNumbers:
        """Return the numbers of the schema."""
        with self._engine.begin() as connection:
            return _schema_numbers(connection)

    def revision(self) -> str | None:
        """Return the number of the schema; None: there are no tables."""
        return self.numbers().newest

    @retried
    def check(self) -> None:
        """Look through the database, before it is worked on for long.

        Raises
        ------
        DatabaseDamaged
            Something in it is damaged; the notes of the error say where it is and what to do.
        """
        with self._engine.begin() as connection:
            fault = dialect_of(connection).check(connection)
        if fault is not None:
            raise unusable(self._engine, fault, RESTORE)

    @retried
    def upgrade(self) -> None:
        """Bring the tables up to date, all or nothing; processes that do so at the same time take turns.

        Programs of the version before may run meanwhile. A newer schema that this program can use stays.

        Raises
        ------
        BadInput
            The schema is newer, and this program cannot use it.
        """
        with self._engine.execution_options(immediate=True).begin() as connection:
            dialect_of(connection).take_turn(connection)
            numbers = _schema_numbers(connection)
            _refuse_newer(numbers, self._engine)
            if not numbers.usable:
                _migrate(connection, numbers.newest)


def prepare_schema(engine: Engine) -> None:
    """See to it that this program can use the tables: upgraded if the database is ours alone, refused if not.

    Raises
    ------
    BadInput
        The schema is newer and has more than additions, or is older and not ours to change.
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
    raise BadInput.of("database_url", shown(engine), bound, "Run loa database upgrade first.")


def shown(engine: Engine) -> str:
    """Return the URL without its password."""
    return engine.url.render_as_string(hide_password=True)


def _refuse_newer(numbers: SchemaNumbers, engine: Engine) -> None:
    """Raise if the schema is none that we know or can use."""
    if numbers.unknown and not numbers.usable:
        bound = f"of schema {REVISIONS[-1]} or older: it has {numbers.newest}"
        tip = "A newer lineofaction made it. Use that one, or another database."
        raise BadInput.of("database_url", shown(engine), bound, tip)


def _migrate(connection: Connection, revision: str | None) -> None:
    migrate(connection, revision)
    _write_number(connection, NEWEST, REVISIONS[-1])
    _write_number(connection, _OLDEST, USABLE_SINCE)
