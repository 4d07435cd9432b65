"""The version of the tables: read, compared with what this program knows, and brought up to date."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sqlalchemy import Connection, Engine, inspect, text

from service.problems import BadInput
from service.store.dialects import RESTORE, dialect_of
from service.store.migrations import REVISIONS
from service.store.outages import damaged, retried

if TYPE_CHECKING:
    from alembic.config import Config

_UNNUMBERED = "computation"  # a table that databases had before their schemas had numbers


class Schema:
    """The tables of one database.

    Parameters
    ----------
    engine : Engine
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    @retried
    def revision(self) -> str | None:
        """Return the number of the schema; None: there are no tables."""
        with self._engine.begin() as connection:
            return _revision(connection)

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
            raise damaged(self._engine, fault, RESTORE)

    @retried
    def upgrade(self) -> None:
        """Bring the tables up to date, all or nothing; processes that do so at the same time take turns.

        Raises
        ------
        BadInput
            The schema is newer than this program.
        """
        with self._engine.execution_options(immediate=True).begin() as connection:
            dialect_of(connection).take_turn(connection)
            revision = _revision(connection)
            _refuse_newer(revision, self._engine)
            if revision != REVISIONS[-1]:
                _migrate(connection, revision)


def prepare_schema(engine: Engine) -> None:
    """See to it that the tables are this program's: upgraded if the database is ours alone, refused if not.

    Raises
    ------
    BadInput
        The schema is newer, or older and not ours to change.
    """
    schema = Schema(engine)
    revision = schema.revision()
    if revision == REVISIONS[-1]:
        return
    if dialect_of(engine).upgrades_itself:
        schema.upgrade()
        return
    _refuse_newer(revision, engine)
    state = "it has no tables" if revision is None else f"it has {revision}"
    bound = f"of schema {REVISIONS[-1]}: {state}"
    raise BadInput.of("database_url", shown(engine), bound, "Run loa database upgrade first.")


def shown(engine: Engine) -> str:
    """Return the URL without its password."""
    return engine.url.render_as_string(hide_password=True)


def _revision(connection: Connection) -> str | None:
    """Read the number of the schema."""
    tables = inspect(connection).get_table_names()
    if "alembic_version" in tables:
        revision = connection.execute(text("SELECT version_num FROM alembic_version")).scalar()
        return None if revision is None else str(revision)
    return REVISIONS[0] if _UNNUMBERED in tables else None


def _refuse_newer(revision: str | None, engine: Engine) -> None:
    """Raise if the schema is none that we know."""
    if revision is not None and revision not in REVISIONS:
        bound = f"of schema {REVISIONS[-1]} or older: it has {revision}"
        tip = "A newer lineofaction made it. Use that one, or another database."
        raise BadInput.of("database_url", shown(engine), bound, tip)


def _migrate(connection: Connection, revision: str | None) -> None:
    """Run the steps from `revision` to ours in the connection's transaction."""
    from alembic import command  # noqa: PLC0415 (start-up time: seldom needed)

    config = _config(connection)
    if revision is not None and not inspect(connection).has_table("alembic_version"):
        command.stamp(config, revision)
    command.upgrade(config, REVISIONS[-1])


def _config(connection: Connection) -> Config:
    """Return alembic's configuration."""
    from alembic.config import Config  # noqa: PLC0415 (start-up time: seldom needed)

    config = Config()
    folder = str(Path(__file__).with_name("migrations")).replace("%", "%%")
    config.set_main_option("script_location", folder)
    config.set_main_option("path_separator", "os")
    config.attributes["connection"] = connection
    return config
