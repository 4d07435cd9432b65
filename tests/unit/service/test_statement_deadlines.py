"""Each statement ends by its deadline, on each database; what needs longer says so."""

import math
import time

import pytest
from sqlalchemy import Engine, text

from lineofaction.gearbox.problems import DatabaseUnavailable
from service.store import dialects
from service.store.database import database_engine, open_database
from service.store.retries import retried

ENDLESS = text("WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT count(*) FROM n")
LONG = text(
    "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 1000000) SELECT count(*) FROM n"
)


class Asking:
    """A user of a database."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self.attempts = 0

    @retried
    def ask(self) -> None:
        self.attempts += 1
        with self._engine.begin() as connection:
            connection.execute(ENDLESS).scalar()


def test_an_endless_question_ends_once_and_the_next_is_answered(machine):
    asking = Asking(machine.engine.execution_options(deadline_s=0.3))
    begin = time.monotonic()
    with pytest.raises(DatabaseUnavailable, match="has not answered in time"):
        asking.ask()
    assert asking.attempts == 1, "another attempt would take as long"
    assert 0.3 <= time.monotonic() - begin < 30.0
    with machine.engine.begin() as connection:
        assert connection.execute(text("SELECT 1")).scalar() == 1


def test_a_statement_without_a_word_has_the_usual_deadline(tmp_path, monkeypatch):
    monkeypatch.setattr(dialects, "DEADLINE_S", 0.02)
    engine = open_database(tmp_path / "index.sqlite3")
    with pytest.raises(DatabaseUnavailable):
        Asking(engine).ask()
    with engine.execution_options(deadline_s=math.inf).begin() as connection:
        assert connection.execute(LONG).scalar() == 1_000_000
    engine.dispose()


def test_a_server_has_the_usual_deadline(postgres):
    engine = database_engine(postgres.new_database())
    with engine.begin() as connection:
        assert connection.execute(text("SHOW statement_timeout")).scalar() == f"{dialects.DEADLINE_S:g}s"
    with engine.execution_options(deadline_s=math.inf).begin() as connection:
        assert connection.execute(text("SHOW statement_timeout")).scalar() == "0"
    engine.dispose()
