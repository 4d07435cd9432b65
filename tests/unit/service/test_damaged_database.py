"""A database that has to be mended: said at the start and at every request, and nobody waits for it."""

import resource
import shutil
import sqlite3
import threading
from collections.abc import Callable
from pathlib import Path

import pytest
import structlog
from command_line import loa
from fastapi.testclient import TestClient
from running_service import until
from service_fakes import EXECUTION, REGISTRY
from sqlalchemy import event
from sqlalchemy.exc import OperationalError
from structlog.testing import LogCapture

from lineofaction.gearbox.problems import (
    EXIT_FAILED,
    DatabaseDamaged,
    DatabaseUnavailable,
    NoSpace,
    OutOfFiles,
)
from service.app import create_app
from service.settings import Settings
from service.store import write_check
from service.store.database import Schema, database_engine
from service.store.deployment import NOTE
from service.store.retries import outage_of
from service.store.shortages import out_of_files
from service.store.write_check import WriteCheck

PAGE = 4096


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    directory = tmp_path_factory.mktemp("sound")
    with TestClient(create_app(Settings(data_directory=directory), REGISTRY, works=False)) as client:
        for number in range(8):
            job = client.post(EXECUTION, json={"inputs": {"wish": {"text": f"no more wanted {number}"}}})
            client.delete(job.headers["location"])
    return directory


@pytest.fixture
def directory(tmp_path, sound):
    return shutil.copytree(sound, tmp_path / "data")


@pytest.fixture
def client(directory, monkeypatch):
    """A client of an app on it, which tries at each question whether it can write."""
    monkeypatch.setattr("service.store.write_check.VALID_S", 0.0)
    with TestClient(create_app(Settings(data_directory=directory), REGISTRY)) as found:
        yield found


def damage(file: Path, kind: str) -> None:
    content = file.read_bytes()
    harmed = {
        "garbage": b"garbage!" * (len(content) // 8),
        "cut off": content[: 3 * PAGE],
        "bad pages": content[: 2 * PAGE] + b"\xa5" * (len(content) - 2 * PAGE),
        "one bad page": content[: -3 * PAGE] + b"\xa5" * PAGE + content[-2 * PAGE :],
    }
    file.write_bytes(harmed[kind])


def writable(client: TestClient) -> dict[str, float]:
    lines = client.get("/metrics").text.splitlines()
    return {line.split('"')[1]: float(line.split()[-1]) for line in lines if line.startswith("loa_writable{")}


def refused(client: TestClient, what: str) -> None:
    """See that a submission is refused for what the database has, at once and without a second attempt."""
    structlog.configure(processors=[log := LogCapture()])
    answer = client.post(EXECUTION, json={"inputs": {"wish": {"text": "new"}}})
    assert answer.headers["content-type"] == "application/problem+json"
    assert (answer.status_code, answer.json()["type"]) == (503, "urn:lineofaction:problem:database-damaged")
    assert what in answer.json()["detail"] and "retry-after" not in answer.headers
    assert "sqlite3" not in answer.text  # where it is, is for the log
    events = [entry["event"] for entry in log.entries]
    assert "database damaged" in events and "database lost" not in events
    ready = client.get("/ready")
    assert ready.status_code == 503 and what in ready.json()["detail"]
    assert writable(client) == {"database": 0.0, "results": writable(client)["results"]}


@pytest.mark.parametrize("kind", ["garbage", "cut off", "bad pages", "one bad page"])
def test_the_start_names_the_damage_and_the_way_to_restore(directory, kind):
    file = directory / "service.sqlite3"
    damage(file, kind)
    with pytest.raises(DatabaseDamaged, match="cannot be used") as caught:
        create_app(Settings(data_directory=directory), REGISTRY)
    (note,) = caught.value.__notes__
    assert str(file) in note and "backup" in note and "loa store reindex" in note
    assert create_app(Settings(data_directory=directory / "other"), REGISTRY)


def test_a_start_does_not_wait_for_a_long_look_and_what_it_finds_makes_unready(directory, monkeypatch):
    damage(directory / "service.sqlite3", "one bad page")
    found, look = threading.Event(), Schema.check

    def late(schema):
        found.wait(60.0)
        look(schema)

    monkeypatch.setattr(Schema, "check", late)
    monkeypatch.setattr("service.store.integrity.PATIENCE_S", 0.01)
    monkeypatch.setattr("service.store.write_check.VALID_S", 0.0)
    with TestClient(create_app(Settings(data_directory=directory), REGISTRY, works=False)) as client:
        assert client.get("/ready").status_code == 200
        found.set()
        until(lambda: client.get("/ready").status_code == 503)
        assert "cannot be used" in client.get("/ready").json()["detail"]
        assert client.get("/health").status_code == 200


def test_the_verb_says_so_and_fails(directory):
    damage(directory / "service.sqlite3", "garbage")
    done = loa("serve", "--port", "0", "--data-directory", directory)
    assert done.exit_code == EXIT_FAILED
    assert "file is not a database" in done.stderr and "loa store reindex" in done.stderr
    assert done.stderr.count("error: ") == 1


@pytest.mark.parametrize(
    ("kind", "what"),
    [("garbage", "file is not a database"), ("bad pages", "malformed"), ("gone", "no such table")],
)
def test_damage_beneath_a_running_service_is_said_at_once(client, directory, kind, what):
    """Reading went on where the pages were sound, and /ready said 200."""
    assert client.get("/ready").status_code == 200
    assert writable(client) == {"database": 1.0, "results": 1.0}
    file = directory / "service.sqlite3"
    if kind == "gone":
        file.unlink()
    else:
        damage(file, kind)
    refused(client, what)
    assert client.get("/health").status_code == 200


@pytest.mark.parametrize(
    ("pragma", "kind", "what"),
    [
        ("query_only=ON", "database-damaged", "readonly"),
        ("max_page_count=1", "no-space", "There is no space left: database or disk is full"),
    ],
)
def test_a_database_that_takes_nothing_is_said_and_taken_up_again(client, pragma, kind, what):
    """Read-only, and full: when that is mended the service goes on."""
    engine = client.app.state.context.engine

    def harm(connection, _record):
        connection.execute(f"PRAGMA {pragma}")

    event.listen(engine, "connect", harm)
    try:
        text = "x" * 100_000  # more than the free room of its pages
        answer = client.post(EXECUTION, json={"inputs": {"wish": {"text": text}}})
    finally:
        event.remove(engine, "connect", harm)
    assert (answer.status_code, answer.json()["type"]) == (503, f"urn:lineofaction:problem:{kind}")
    assert what in answer.json()["detail"]
    until(lambda: client.get("/ready").status_code == 200)
    assert client.post(EXECUTION, json={"inputs": {"wish": {"text": "after"}}}).status_code == 201


def test_a_place_of_results_that_takes_nothing_is_not_ready(client, directory):
    """Its volume is gone, say: the folder is there and the note is not."""
    (directory / "results" / NOTE).rename(directory / "note")
    assert client.get("/ready").status_code == 503
    assert writable(client) == {"database": 1.0, "results": 0.0}
    (directory / "note").rename(directory / "results" / NOTE)
    (directory / "results").rename(directory / "kept")
    (directory / "results").write_text("a file where the folder was")
    ready = client.get("/ready")
    assert ready.status_code == 503 and "results cannot be written: Not a directory" in ready.json()["detail"]
    (directory / "results").unlink()
    (directory / "kept").rename(directory / "results")
    assert client.get("/ready").status_code == 200


def test_a_disk_without_room_for_a_submission_is_not_ready(client, directory, monkeypatch):
    """57 kB were free, every submission was refused, and /ready said 200."""
    assert client.get("/ready").status_code == 200
    little = shutil.disk_usage(directory)._replace(free=57_000)
    monkeypatch.setattr("shutil.disk_usage", lambda _folder: little)
    ready = client.get("/ready")
    assert ready.status_code == 503 and "no space left: 0.057 MB are free" in ready.json()["detail"]
    assert writable(client) == {"database": 0.0, "results": 0.0}
    monkeypatch.undo()
    until(lambda: client.get("/ready").status_code == 200)


_IO_ERROR, _CANNOT_OPEN = sqlite3.SQLITE_IOERR, sqlite3.SQLITE_CANTOPEN


@pytest.mark.parametrize(
    ("code", "lacking", "kind"),
    [
        (_IO_ERROR, "shortage", NoSpace),
        (_CANNOT_OPEN, "shortage", NoSpace),
        (_IO_ERROR, "out_of_files", OutOfFiles),
        (_CANNOT_OPEN, "out_of_files", OutOfFiles),
        (_IO_ERROR, "", DatabaseDamaged),
        (_CANNOT_OPEN, "", DatabaseDamaged),
    ],
)
def test_what_the_files_beside_a_database_lack_is_named(directory, monkeypatch, code, lacking, kind):
    """With no space or no open file left SQLite says that it cannot open or read the files beside its own."""
    if lacking:
        monkeypatch.setattr(f"service.store.dialects.{lacking}", lambda *_: True)
    error = sqlite3.OperationalError("disk I/O error")
    error.sqlite_errorcode = code
    engine = database_engine(directory / "service.sqlite3")
    outage = outage_of(OperationalError("", {}, error), engine)
    assert type(outage) is kind


def test_open_files_that_are_used_up_are_noticed():
    assert not out_of_files()
    limits = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (3, limits[1]))
    try:
        assert out_of_files()
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, limits)


# Waiting for a turn is no fault for a while.


class Place:
    """A deployment whose writes end as they are told to."""

    def __init__(self) -> None:
        self.database: Callable[[], None] = lambda: None

    def write_database(self) -> None:
        self.database()

    def write_results(self) -> None:
        pass


def failing(error: Exception) -> Callable[[], None]:
    def step():
        raise error

    return step


@pytest.fixture
def place(monkeypatch):
    monkeypatch.setattr(write_check, "VALID_S", -1.0)
    return Place()


def fault(check: WriteCheck) -> str:
    return check.outcome().fault


def test_one_that_waits_for_its_turn_is_ready_until_it_has_waited_too_long(place, monkeypatch):
    """200 submissions at once held the database for a second, and a service at work said 503."""
    check = WriteCheck(place)
    assert fault(check) == ""
    place.database = failing(DatabaseUnavailable("Others hold it."))
    assert fault(check) == ""
    monkeypatch.setattr(write_check, "LATE_S", -1.0)
    assert fault(check) == "Others hold it."


def test_one_that_has_never_written_is_not_ready(place):
    place.database = failing(DatabaseUnavailable("Others hold it."))
    assert fault(WriteCheck(place)) == "Others hold it."


def test_damage_is_told_at_once(place):
    check = WriteCheck(place)
    assert fault(check) == ""
    place.database = failing(DatabaseDamaged("It is malformed."))
    assert fault(check) == "It is malformed."
