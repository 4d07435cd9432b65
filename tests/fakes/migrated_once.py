"""The tables of a new SQLite database are made by migrations once, and from what these left afterwards.

Every service of a test has a database of its own. The laws of migrations are in
tests/unit/service/test_schema_upgrades.py, which overrides the fixture.
"""

from collections.abc import Iterator

import pytest
from sqlalchemy import Connection

from service.store import database

_statements: list[str] = []


@pytest.fixture(scope="module", autouse=True)
def migrated_once() -> Iterator[None]:
    migrate = database.migrate

    def copied(connection: Connection, revision: str | None) -> None:
        if revision is not None or connection.dialect.name != "sqlite":
            migrate(connection, revision)
        elif _statements:
            for statement in _statements:
                connection.exec_driver_sql(statement)
        else:
            migrate(connection, revision)
            _statements.extend(_content(connection))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(database, "migrate", copied)
        yield


def _content(connection: Connection) -> list[str]:
    """Return the statements that make the tables and rows of a SQLite database."""
    driver = connection.connection.driver_connection
    return [line for line in driver.iterdump() if line not in ("BEGIN TRANSACTION;", "COMMIT;")]
