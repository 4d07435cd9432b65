"""Upgrades of the schema: nothing is lost, and what a newer program made is left alone."""

import hashlib
import json
import re
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from inspect import getsource as inspect_source
from pathlib import Path
from types import SimpleNamespace

import pytest
from command_line import loa
from fastapi.testclient import TestClient
from postgres_server import PostgresServer
from running_service import bench
from service_fakes import REGISTRY
from small_table import small_table
from sqlalchemy import Engine, inspect, text
from typer.testing import CliRunner

from fe_contact.ste import SteDatabase
from lineofaction.cli.commands import app
from lineofaction.gearbox.convert.answers import headline_json
from lineofaction.gearbox.problems import BadInput
from service.app import create_app
from service.routes import headlines
from service.settings import Settings
from service.store import migrations
from service.store.database import Schema, database_engine, metadata, open_database, writing
from service.store.migrations import REVISIONS, STEPS, USABLE_SINCE

OLD = """
CREATE TABLE computation (
    id VARCHAR NOT NULL, process VARCHAR NOT NULL, "key" VARCHAR NOT NULL, inputs TEXT NOT NULL,
    state VARCHAR NOT NULL, stage VARCHAR NOT NULL, stage_fraction FLOAT NOT NULL, fraction FLOAT NOT NULL,
    message TEXT NOT NULL, faults TEXT NOT NULL, reference VARCHAR NOT NULL, attempts INTEGER NOT NULL,
    created VARCHAR NOT NULL, started VARCHAR, finished VARCHAR, updated VARCHAR NOT NULL, PRIMARY KEY (id));
CREATE UNIQUE INDEX computation_in_flight ON computation ("key") WHERE state IN ('accepted', 'running');
CREATE INDEX computation_by_state ON computation (state, created);
CREATE TABLE result (
    "key" VARCHAR NOT NULL, kind VARCHAR NOT NULL, sha256 VARCHAR NOT NULL, size INTEGER NOT NULL,
    created VARCHAR NOT NULL, PRIMARY KEY ("key", kind));
CREATE TABLE job (
    id VARCHAR NOT NULL, computation_id VARCHAR NOT NULL, created VARCHAR NOT NULL, dismissed VARCHAR,
    PRIMARY KEY (id), FOREIGN KEY(computation_id) REFERENCES computation (id));
CREATE INDEX job_by_computation ON job (computation_id);
CREATE INDEX job_by_time ON job (created);
"""
"""The tables of a data directory before their schema had a number, as SQLite wrote them down."""

KEYS = ["ab" * 32, "cd" * 32, "ef" * 32]
TIME = "2026-11-01T00:00:00.000000Z"
IDENTIFIERS = [f"00000000-0000-4000-8000-00000000000{n}" for n in range(4)]


@pytest.fixture(scope="module", autouse=True)
def migrated_once():
    """Let migrations make all tables: they are what is tested here."""


def fill(file: Path, results: Path) -> None:
    """Make a data directory of the old schema: work that waits, runs and is done, and two results."""
    states = ["accepted", "running", "successful"]
    with closing(sqlite3.connect(file)) as old:
        old.executescript(OLD)
        for n, (key, state) in enumerate(zip(KEYS, states, strict=True)):
            facts = (f"c{n}", "fake", key, '{"wish": {}}', state, "", 0.0, 0.5, "m", "[]", "", n)
            old.execute(
                f"INSERT INTO computation VALUES ({','.join('?' * 16)})", (*facts, TIME, None, None, TIME)
            )
            old.execute("INSERT INTO job VALUES (?, ?, ?, NULL)", (IDENTIFIERS[n], f"c{n}", TIME))
        old.execute("INSERT INTO job VALUES (?, 'c2', ?, ?)", (IDENTIFIERS[3], TIME, TIME))
        for kind, suffix in (("database", ".nc"), ("ablation", ".json")):
            place = results / kind / KEYS[2][:2] / f"{KEYS[2]}{suffix}"
            place.parent.mkdir(parents=True)
            place.write_bytes(b"kept")
            digest = "79f076abdd19a752db7267bfff2f9022161d120dea919fdaca2ffdfc24ca8c96"
            facts = (KEYS[2], kind, digest, 4, TIME)
            old.execute("INSERT INTO result VALUES (?, ?, ?, ?, ?)", facts)
        old.commit()


def test_a_data_directory_without_numbers_is_upgraded_and_keeps_all(tmp_path):
    fill(tmp_path / "service.sqlite3", tmp_path / "results")
    machine = bench(tmp_path, REGISTRY)
    assert Schema(machine.engine).revision() == REVISIONS[-1]
    seen = [machine.submissions.find(identifier) for identifier in IDENTIFIERS]
    assert [job.status for job in seen] == ["accepted", "running", "successful", "dismissed"]
    assert [job.attempts for job in seen] == [0, 1, 2, 2]
    assert [job.key for job in seen] == [*KEYS, KEYS[2]]
    for kind in ("database", "ablation"):
        assert machine.store.verified(KEYS[2], kind).path.read_bytes() == b"kept"
    machine.scheduler.start()
    ended = [machine.ended(job) for job in seen[:2]]  # of the same inputs: one computes for both
    assert {(job.status, job.key == KEYS[2]) for job in ended} == {("successful", False)}
    machine.close()


def test_a_table_of_before_gets_its_headline_when_it_is_listed(tmp_path, monkeypatch):
    file, place = tmp_path / "service.sqlite3", tmp_path / "results" / "database" / KEYS[2][:2]
    fill(file, tmp_path / "results")
    table = small_table()
    table.to_netcdf(place / f"{KEYS[2]}.nc")
    content = (place / f"{KEYS[2]}.nc").read_bytes()
    with closing(sqlite3.connect(file)) as old:
        old.execute("UPDATE computation SET process = 'analyze'")
        facts = hashlib.sha256(content).hexdigest(), len(content)
        old.execute("UPDATE result SET sha256 = ?, size = ? WHERE kind = 'database'", facts)
        old.commit()
    read: list[SteDatabase] = []

    def noted(found):
        read.append(found)
        return headline_json(found)

    monkeypatch.setattr(headlines, "headline_json", noted)
    client = TestClient(create_app(Settings(data_directory=tmp_path)))
    for _ in range(2):
        listed = {job["jobID"]: job["headline"] for job in client.get("/v1/jobs").json()["jobs"]}
        assert {identifier for identifier, found in listed.items() if found} == {*IDENTIFIERS[2:]}
        expected = headline_json(table)
        assert {name: listed[IDENTIFIERS[2]][name] for name in expected} == expected
    assert len(read) == 1, "kept: the second list reads no table"


def test_a_table_that_cannot_be_read_is_listed_and_read_once(tmp_path, monkeypatch):
    fill(tmp_path / "service.sqlite3", tmp_path / "results")  # its table is no netCDF file
    with closing(sqlite3.connect(tmp_path / "service.sqlite3")) as old:
        old.execute("UPDATE computation SET process = 'analyze'")
        old.commit()
    noted: list[dict[str, object]] = []
    monkeypatch.setattr(headlines, "logger", SimpleNamespace(warning=lambda *_, **facts: noted.append(facts)))
    client = TestClient(create_app(Settings(data_directory=tmp_path)))
    for _ in range(2):
        found = client.get(f"/v1/jobs/{IDENTIFIERS[2]}").json()
        assert (found["status"], found["headline"]) == ("successful", None)
    assert [facts["key"] for facts in noted] == [KEYS[2]]


@pytest.fixture
def fresh(tmp_path, request):
    server: PostgresServer | None = request.getfixturevalue("postgres") if request.param else None
    engine = database_engine(server.new_database() if server else tmp_path / "new.sqlite3")
    yield engine
    engine.dispose()


both = pytest.mark.parametrize("fresh", [False, True], ids=["sqlite", "postgresql"], indirect=True)


@both
def test_upgrades_at_the_same_time_are_one(fresh):
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: Schema(fresh).upgrade(), range(4)))
    assert Schema(fresh).revision() == REVISIONS[-1]


@both
def test_the_steps_make_the_tables_that_the_program_declares(fresh):
    assert Schema(fresh).revision() is None
    Schema(fresh).upgrade()
    found = inspect(fresh)
    assert set(found.get_table_names()) == set(metadata.tables) | {"alembic_version", "schema_version"}
    for table in metadata.sorted_tables:
        columns = {column["name"]: column["nullable"] for column in found.get_columns(table.name)}
        assert columns == {column.name: column.nullable for column in table.columns}, table.name
        indices = {
            (i["name"], tuple(i["column_names"]), bool(i["unique"])) for i in found.get_indexes(table.name)
        }
        declared = {(i.name, tuple(c.name for c in i.columns), bool(i.unique)) for i in table.indexes}
        assert indices == declared, table.name


def number(engine: Engine, **numbers: str) -> None:
    with writing(engine) as connection:
        for table, stated in numbers.items():
            connection.execute(text(f"UPDATE {table} SET version_num = '{stated}'"))


@both
def test_a_newer_schema_that_only_adds_is_used_and_left_alone(fresh):
    """A former program starts, and starts again, on what the newer one has made."""
    Schema(fresh).upgrade()
    number(fresh, schema_version="9999")
    open_database(fresh.url.render_as_string(hide_password=False)).dispose()
    Schema(fresh).upgrade()
    assert Schema(fresh).revision() == "9999"


@both
def test_programs_that_lease_find_a_schema_that_they_do_not_know(fresh):
    """They compare this one number with their own steps, up to 0014: two owners would share the table."""
    Schema(fresh).upgrade()
    with fresh.begin() as connection:
        assert connection.execute(text("SELECT version_num FROM alembic_version")).scalars().all() == ["0015"]


@both
def test_a_newer_schema_is_refused_and_left_alone(fresh):
    Schema(fresh).upgrade()
    number(fresh, schema_version="9999", alembic_version="9998")
    url = fresh.url.render_as_string(hide_password=False)
    for refused in (lambda: open_database(url), Schema(fresh).upgrade):
        with pytest.raises(BadInput, match=f"of schema {REVISIONS[-1]} or older: it has 9999"):
            refused()
    assert Schema(fresh).revision() == "9999"


def test_a_step_that_fails_leaves_the_old_schema(tmp_path, monkeypatch):
    """All or nothing: the tables made before the failure are gone again."""

    def fail(_op):
        raise RuntimeError("in mid-upgrade")

    monkeypatch.setattr(migrations, "STEPS", {**migrations.STEPS, REVISIONS[-1]: fail})
    engine = database_engine(tmp_path / "index.sqlite3")
    with pytest.raises(RuntimeError):
        Schema(engine).upgrade()
    assert Schema(engine).revision() is None
    assert inspect(engine).get_table_names() == []


def test_steps_that_other_programs_live_through_only_add():
    """Programs from `USABLE_SINCE` on read and write what they did: tables and columns stay.

    Indexes, which no statement names, may go.
    """
    taking = re.compile(r"\.(?:drop_(?!index\b)|alter_column|rename_)\w*|DROP|RENAME")
    source = inspect_source(migrations)
    for former in REVISIONS[: REVISIONS.index(USABLE_SINCE) + 1]:
        source = source.replace(inspect_source(STEPS[former]), "")
    assert taking.findall(source) == []


@both
def test_rows_of_a_program_that_knows_no_newer_column_are_taken(fresh):
    Schema(fresh).upgrade()
    facts = "'c', 'fake', 'k', '{}', 'accepted', '', 0, 0, '', '[]', '', 0, '', ''"
    names = (
        "id, process, key, inputs, state, stage, stage_fraction, fraction, message, faults, reference,"
        "attempts, created, updated"
    )
    with writing(fresh) as connection:
        connection.execute(text(f"INSERT INTO computation ({names}) VALUES ({facts})"))
        job = (
            "INSERT INTO job (id, computation_id, created, caller, delivery) VALUES ('j', 'c', '', '', '{}')"
        )
        connection.execute(text(job))
        result = "INSERT INTO result (key, kind, sha256, size, created, file, used)"
        connection.execute(text(f"{result} VALUES ('k', 'database', '', 0, '', '', '')"))
        for table in ("computation", "job", "result"):
            assert connection.execute(text(f"SELECT count(*) FROM {table}")).scalar() == 1


def test_the_numbers_count_the_steps():
    """Steps behind a schema are those of larger numbers, compared as texts."""
    assert tuple(f"{number:04d}" for number in range(1, len(STEPS) + 1)) == REVISIONS


# ``loa database``: passwords are never shown.


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_a_new_database_is_made_and_then_up_to_date(kind, tmp_path, request, monkeypatch):
    monkeypatch.setenv("LOA_DATA_DIRECTORY", str(tmp_path))
    if kind == "postgresql":
        server: PostgresServer = request.getfixturevalue("postgres")
        url = server.new_database().replace("postgres@", "postgres:geheim@")
        monkeypatch.setenv("LOA_DATABASE_URL", url)
    run = CliRunner()
    before = run.invoke(app, ["database", "status", "--json"])
    assert (before.exit_code, json.loads(before.stdout)["schema"]) == (1, None)
    assert run.invoke(app, ["database", "upgrade"]).stdout.endswith(f"no tables -> {REVISIONS[-1]}\n")
    after = run.invoke(app, ["database", "status", "--json"])
    assert (after.exit_code, json.loads(after.stdout)["up_to_date"]) == (0, True)
    assert "geheim" not in before.output + after.output


def test_a_server_that_does_not_answer_is_said(tmp_path, monkeypatch):
    monkeypatch.setenv("LOA_DATABASE_URL", f"postgresql://loa:geheim@/loa?host={tmp_path}")
    answer = loa("database", "status")
    assert answer.exit_code == 4
    assert "The database cannot be reached" in answer.stderr
    assert "geheim" not in answer.output
