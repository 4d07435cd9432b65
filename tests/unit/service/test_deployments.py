"""One database and one place of results belong together: neither is served, nor removed, beside another's."""

import hashlib
import json
import shutil
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import h5py
import pytest
from postgres_server import PostgresServer, migrated
from running_service import Bench, bench
from service_fakes import REGISTRY
from sqlalchemy import delete, update
from typer.testing import CliRunner

from lineofaction.cli.commands import app
from lineofaction.gearbox.problems import BadInput
from service.app import create_app
from service.queue.retention import Retention
from service.settings import Settings
from service.store.database import open_database, writing
from service.store.deployment import NOTE, Deployment, deployments
from service.store.files import DirectoryFiles
from service.store.maintenance import verify_store
from service.store.reindex import reindex
from service.store.results import ResultStore, results

LONG_AGO = "2016-01-01T00:00:00.000000Z"
KEYS = [hashlib.sha256(bytes([n])).hexdigest() for n in range(3)]
DAYS = 3650.0

NewDatabase = Callable[[], str]


@pytest.fixture(params=["one machine", "servers"])
def on_servers(request):
    """Whether index and files are on servers (PostgreSQL, S3) or in folders (SQLite)."""
    return bool(request.param == "servers")


@pytest.fixture
def new_database(tmp_path, on_servers, request):
    if on_servers:
        server: PostgresServer = request.getfixturevalue("postgres")
        return lambda: migrated(server.new_database())
    numbers = iter(range(9))
    return lambda: f"sqlite:///{tmp_path}/database_{next(numbers)}.sqlite3"


@pytest.fixture
def place(tmp_path, on_servers, request):
    return str(request.getfixturevalue("s3_url")) if on_servers else (tmp_path / "results").as_uri()


@pytest.fixture
def first(tmp_path, new_database, place):
    """A deployment with three results, all requested some time ago."""
    machine = bench(tmp_path / "first", REGISTRY, database_url=new_database(), results_url=place)
    for key in KEYS:
        put(machine, key)
    yield machine
    machine.close()


def put(machine: Bench, key: str) -> str:
    """Put a result that holds its key, and return the name of its file."""
    file = machine.settings.data_directory / "made"
    with h5py.File(file, "w") as content:
        content.attrs["key"] = key
    return machine.store.put(key, "ablation", file).file


def read(store: ResultStore, key: str) -> object:
    with h5py.File(store.verified(key, "ablation").path, "r") as content:
        return content.attrs["key"]


def retention(machine: Bench, days: float = 7.0) -> Retention:
    return Retention(machine.engine, machine.store, machine.settings.data_directory, days)


def held(machine: Bench) -> set[str]:
    return {file.name for file in machine.store.files.files()} - {NOTE}


def of_older_versions(machine: Bench) -> None:
    """Take the note away: a place as older versions left it."""
    machine.store.files.delete(NOTE)


def unchecked(machine: Bench, url: str) -> Bench:
    """Return a machine with another database on the same files, which nobody has compared."""
    engine = open_database(url)
    return replace(machine, engine=engine, store=ResultStore(engine, machine.store.files))


def opened(tmp_path: Path, url: str, place: str) -> Bench:
    """Open another deployment as a service does at its start."""
    return bench(tmp_path / "second", REGISTRY, database_url=url, results_url=place)


def test_an_empty_database_beside_results_removes_none_of_them(tmp_path, first, new_database, monkeypatch):
    """One minute after the start of a fresh database with 3650 days all were gone."""
    monkeypatch.setattr("service.store.maintenance.GRACE_S", -60.0)
    for unmarked in (False, True):
        if unmarked:
            of_older_versions(first)
        before = held(first)
        wrong = unchecked(first, new_database())
        for remove in (retention(wrong).expire, retention(wrong).collect):
            with pytest.raises(BadInput, match="must be the place of deployment"):
                list(remove(DAYS))
        wrong.close()
        assert held(first) == before
    Deployment(first.engine, first.store).confirm_files()
    assert [read(first.store, key) for key in KEYS] == KEYS


def test_retention_beside_files_that_the_index_does_not_name_removes_none(first, monkeypatch):
    """What has no line has no date."""
    monkeypatch.setattr("service.store.maintenance.GRACE_S", -60.0)
    (line, *_) = first.store.lines()
    first.store.strike(line)
    assert list(retention(first).expire(DAYS)) == []
    assert line.file in held(first)
    assert verify_store(first.store).unknown == (line.file,)


def test_a_service_is_not_started_beside_files_of_another(tmp_path, first, new_database, place):
    """Both are named, with the database of the other and what to do."""
    theirs = Deployment(first.engine, first.store).identifier()
    with pytest.raises(BadInput) as caught:
        create_app(Settings(data_directory=tmp_path / "new", database_url=new_database(), results_url=place))
    (fault,) = caught.value.faults
    assert fault.field == "results" and str(fault.value) in place
    assert f"it belongs to deployment {theirs} (database " in fault.bound
    assert "loa store reindex" in fault.suggestion
    of_older_versions(first)
    with pytest.raises(BadInput, match=r"there are files \(such as ablation/.*\) and the index is empty"):
        opened(tmp_path, new_database(), place)


def test_an_index_with_results_of_its_own_is_not_put_beside_others(tmp_path, first, new_database, place):
    url = new_database()
    second = bench(tmp_path / "second", REGISTRY, database_url=url)
    put(second, KEYS[0])
    second.close()
    with pytest.raises(BadInput, match="it belongs to deployment"):
        opened(tmp_path, url, place)
    mixed = ResultStore(engine := open_database(url), first.store.files)
    with pytest.raises(BadInput, match="Name the database of these files"):
        reindex(mixed, Deployment(engine, mixed))
    of_older_versions(first)
    with pytest.raises(BadInput, match="the index names other files"):
        opened(tmp_path, url, place)
    engine.dispose()


def test_a_place_of_older_versions_is_taken_by_the_index_that_knows_it(tmp_path, first, place):
    of_older_versions(first)
    again = opened(tmp_path, str(first.settings.database_address), place)
    assert [read(again.store, key) for key in KEYS] == KEYS
    assert list(retention(again).expire(DAYS)) == []
    again.close()


def test_an_empty_place_beside_an_index_with_results_is_refused(tmp_path, first, place):
    """A volume that is not mounted, say; if the results are lost, reindexing says so to the index."""
    url = str(first.settings.database_address)
    elsewhere = f"{place}/not/mounted"
    with pytest.raises(BadInput, match="Is its volume mounted"):
        opened(tmp_path, url, elsewhere)
    for name in {*held(first), NOTE}:
        first.store.files.delete(name)
    found = reindex(first.store, Deployment(first.engine, first.store))
    assert len(found.struck) == 3 and first.store.lines() == []
    opened(tmp_path, url, place).close()


def test_two_that_start_on_one_place_at_the_same_time_are_one(tmp_path, new_database, place):
    urls = [new_database() for _ in range(3)]
    for url in urls:
        open_database(url).dispose()  # alembic migrates one database at a time

    def start(number):
        try:
            return bench(
                tmp_path / str(number), REGISTRY, database_url=urls[number], results_url=place + "/shared"
            )
        except BadInput:
            return None

    with ThreadPoolExecutor(3) as pool:
        started = [machine for machine in pool.map(start, range(3)) if machine is not None]
    assert len(started) == 1
    put(started[0], KEYS[0])
    assert read(started[0].store, KEYS[0]) == KEYS[0]
    started[0].close()


def test_the_index_is_rebuilt_from_the_files(tmp_path, first, new_database, place):
    """Retention counts from then, whatever the files' dates are, and the old owner removes nothing more."""
    lost = tmp_path / "damaged"
    lost.write_text("other bytes")
    damaged = put(first, hashlib.sha256(b"damaged").hexdigest())
    first.store.files.put(damaged, lost, hashlib.sha256(b"other bytes").hexdigest())
    cut = f"database/{KEYS[0][:2]}/{KEYS[0]}.nc"  # as older versions named it
    first.store.files.put(cut, lost, hashlib.sha256(b"other bytes").hexdigest())
    rebuilt = unchecked(first, new_database())
    found = reindex(rebuilt.store, Deployment(rebuilt.engine, rebuilt.store))
    assert (found.entered, found.known, sorted(found.damaged)) == (3, 0, sorted([damaged, cut]))
    assert [read(rebuilt.store, key) for key in KEYS] == KEYS
    assert list(retention(rebuilt).expire(1.0)) == []
    assert verify_store(rebuilt.store).reindexed == 3
    assert reindex(rebuilt.store, Deployment(rebuilt.engine, rebuilt.store)).known == 3
    with writing(first.engine) as connection:
        connection.execute(update(results).values(used=LONG_AGO))
    before = held(first)
    with pytest.raises(BadInput, match="it belongs to deployment"):
        list(retention(first).expire(30.0))
    assert held(first) == before and len(first.store.lines()) == 4
    rebuilt.close()


def test_what_is_removed_stays_in_quarantine_for_the_stated_time_and_comes_back(first):
    """It is dated by when it came there: a copy has no date of its own."""
    with writing(first.engine) as connection:
        connection.execute(update(results).where(results.c.key != KEYS[0]).values(used=LONG_AGO))
    before = held(first)
    removed = list(retention(first).expire(30.0))
    assert [one.quarantined for one in removed] == [True, True] and len(held(first)) == 3
    assert list(retention(first, days=1.0).expire(30.0)) == []
    machine = retention(first)
    assert machine._quarantine.release() == 2 and held(first) == before
    found = reindex(first.store, Deployment(first.engine, first.store))
    assert found.entered == 2 and [read(first.store, key) for key in KEYS] == KEYS


def test_quarantine_ends_by_its_own_date(first):
    now = datetime.now(UTC)
    (name, *_) = sorted(held(first))
    for days in (6.5, 7.5):
        stamp = (now - timedelta(days=days)).strftime("%Y%m%dT%H%M%SZ")
        first.store.files.put(f"quarantine/{name}.{stamp}", made(first), hashlib.sha256(b"{}").hexdigest())
    first.store.files.put("quarantine/notes.txt", made(first), hashlib.sha256(b"{}").hexdigest())
    (gone,) = retention(first).expire(DAYS)
    assert gone.why == "quarantine ended" and gone.name.endswith(stamp)
    assert len([name for name in held(first) if name.startswith("quarantine/")]) == 2


def made(machine: Bench) -> Path:
    file = machine.settings.data_directory / "some"
    file.write_bytes(b"{}")
    return file


def test_results_newer_than_a_restored_database_are_kept_and_told(tmp_path):
    """As docs/how-to/back-up-and-upgrade.md says: they are unknown until the index is rebuilt."""
    machine = bench(tmp_path / "data", REGISTRY)
    put(machine, KEYS[0])
    shutil.copyfile(tmp_path / "data/service.sqlite3", tmp_path / "copy.sqlite3")  # nobody has it open
    newer = put(machine, KEYS[1])
    machine.close()
    shutil.move(tmp_path / "copy.sqlite3", tmp_path / "data/service.sqlite3")
    restored = bench(tmp_path / "data", REGISTRY)
    assert list(retention(restored).expire(1.0)) == []
    assert verify_store(restored.store).unknown == (newer,)
    reindex(restored.store, Deployment(restored.engine, restored.store))
    assert read(restored.store, KEYS[1]) == KEYS[1]
    restored.close()


def test_a_database_from_before_the_files_were_marked_takes_them_back(first):
    """A backup of an older version has no identifier: its index names the files, so they may be its own."""
    with writing(first.engine) as connection:
        connection.execute(delete(deployments))
    with pytest.raises(BadInput, match="loa store reindex"):
        Deployment(first.engine, first.store).confirm_files()
    assert reindex(first.store, Deployment(first.engine, first.store)).known == 3
    Deployment(first.engine, first.store).confirm_files()


def test_the_verbs_refuse_and_rebuild(tmp_path, monkeypatch):
    monkeypatch.setenv("LOA_DATA_DIRECTORY", str(tmp_path))
    monkeypatch.setenv("LOA_RETENTION_DAYS", "3650")
    machine = bench(tmp_path, REGISTRY)
    for key in KEYS:
        put(machine, key)
    machine.close()
    for file in tmp_path.glob("service.sqlite3*"):
        file.unlink()
    run = CliRunner()
    for verb in (["serve", "--port", "0"], ["store", "gc"], ["store", "verify"]):
        refused = run.invoke(app, verb)
        assert refused.exit_code == 2 and "loa store reindex" in refused.stderr, refused.output
    told = run.invoke(app, ["store", "reindex"])
    assert (told.exit_code, told.stdout) == (0, "3 results entered, 0 known, 0 damaged\n")
    assert "3 files intact, 0 damaged or missing" in run.invoke(app, ["store", "verify"]).stdout
    with writing(engine := open_database(tmp_path / "service.sqlite3")) as connection:
        connection.execute(update(results).values(used=LONG_AGO))
    assert json.loads(run.invoke(app, ["store", "gc", "--json"]).stdout)["quarantine_days"] == 7.0
    found = json.loads(run.invoke(app, ["store", "reindex", "--quarantined", "--json"]).stdout)
    assert found["entered"] == 3
    engine.dispose()


def test_a_note_is_whole_and_the_first_one_stays_where_there_are_no_links(tmp_path, monkeypatch):
    def refuse(*_):
        raise PermissionError("no links here")

    for name, linked in (("linked", True), ("written", False)):
        if not linked:
            monkeypatch.setattr("os.link", refuse)
        files = DirectoryFiles(tmp_path / name)
        assert files.note(NOTE) is None
        for text, instead in (("one", False), ("two", False), ("three", True)):
            files.put_note(NOTE, text, replace=instead)
            assert files.note(NOTE) == {"one": "one", "two": "one", "three": "three"}[text]
        assert [path.name for path in (tmp_path / name).iterdir()] == [NOTE]
