"""The result store: what is read is what was written, or it is refused; the same in every place."""

import hashlib
import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from sqlalchemy import event

from lineofaction.gearbox.problems import BadInput, DamagedFile, NotFound, StoreUnavailable
from service.directory_lock import DirectoryLock
from service.settings import Settings, load_settings
from service.store.database import open_database, reading, writing
from service.store.deployment import NOTE
from service.store.files import DirectoryFiles
from service.store.object_files import ObjectFiles, object_files
from service.store.places import result_files, result_store, stored_results
from service.store.results import ResultStore

KEY = hashlib.sha256(b"input").hexdigest()
OTHER = hashlib.sha256(b"other").hexdigest()


@pytest.fixture(params=["directory", "s3"])
def place(request):
    return None if request.param == "directory" else str(request.getfixturevalue("s3_url"))


@pytest.fixture
def store(tmp_path, database_url, place):
    """An empty store, its index in each database and its files in each place."""
    engine = open_database(database_url or tmp_path / "index.sqlite3")
    yield result_store(engine, tmp_path, place)
    engine.dispose()


def put(store: ResultStore, tmp_path: Path, content: bytes, key: str = KEY) -> None:
    file = tmp_path / "made"
    file.write_bytes(content)
    store.put(key, "database", file)


def damage(store: ResultStore, tmp_path: Path, content: bytes) -> None:
    """Change the bytes behind the store's back, in its place and in the cache."""
    (line,) = store.lines()
    if isinstance(store.files, DirectoryFiles):
        store.verified(line.key, line.kind).path.write_bytes(content)
        return
    file = tmp_path / "damage"
    file.write_bytes(content)
    store.files.put(line.file, file, line.sha256)


def test_a_result_is_found_by_its_key_and_kind(store, tmp_path):
    put(store, tmp_path, b"table")
    stored = store.verified(KEY, "database")
    assert stored.path.read_bytes() == b"table"
    assert (stored.sha256, stored.size) == (hashlib.sha256(b"table").hexdigest(), 5)
    with pytest.raises(NotFound):
        store.verified(KEY, "run")
    assert not (tmp_path / "made").exists()


def test_a_damaged_file_is_never_served_and_makes_room_for_a_new_one(store, tmp_path):
    put(store, tmp_path, b"table")
    damage(store, tmp_path, b"tabla")
    with pytest.raises(DamagedFile):
        store.verified(KEY, "database")
    assert store.find(KEY, "database") is None
    assert [file.name for file in store.files.files() if file.name.endswith(".damaged")] != []
    put(store, tmp_path, b"table")
    assert store.verified(KEY, "database").path.read_bytes() == b"table"


def test_the_first_result_of_a_key_stays(store, tmp_path):
    """What was served never changes, though a second computation may differ in its times."""
    put(store, tmp_path, b"one")
    put(store, tmp_path, b"two")
    assert store.verified(KEY, "database").path.read_bytes() == b"one"
    assert not (tmp_path / "made").exists()


def test_of_results_put_at_the_same_time_one_stays(store, tmp_path):
    """Each has a file of its own, and the one that lost is gone."""

    def put_one(number):
        file = tmp_path / f"made_{number}"
        file.write_bytes(b"%d" % number)
        store._put(KEY, "database", file)

    with ThreadPoolExecutor(4) as pool:
        list(pool.map(put_one, range(4)))
    assert store.verified(KEY, "database").path.read_bytes() in (b"0", b"1", b"2", b"3")
    assert [file.name for file in store.files.files() if file.name != NOTE] == [store.lines()[0].file]


@pytest.mark.parametrize("key", ["../../etc/passwd", "", KEY.upper(), KEY[:-1] + "/", "a" * 63, "\x00" * 64])
def test_what_is_no_hash_names_no_file(tmp_path, key):
    with pytest.raises(NotFound):
        stored_results(tmp_path).verified(key, "database")


def test_a_lost_file_counts_as_no_result(store, tmp_path):
    put(store, tmp_path, b"table")
    (line,) = store.lines()
    store.files.delete(line.file)
    assert store.find(KEY, "database") is None
    put(store, tmp_path, b"again")
    assert store.verified(KEY, "database").path.read_bytes() == b"again"


def test_a_failed_put_may_be_repeated(store, tmp_path, monkeypatch):
    """The bytes were placed, the index was not told: the file of the work is still there."""

    def fail(*_):
        raise StoreUnavailable("in mid-put")

    with monkeypatch.context() as broken:
        broken.setattr(store, "enter", fail)
        with pytest.raises(StoreUnavailable):
            put(store, tmp_path, b"table")
    assert store.find(KEY, "database") is None
    store.put(KEY, "database", tmp_path / "made")
    assert store.verified(KEY, "database").path.read_bytes() == b"table"
    store.put(KEY, "database", tmp_path / "made")  # is gone, and need not be there


def test_a_copy_that_is_cut_off_leaves_no_result(tmp_path, monkeypatch):
    """On another file system the bytes are copied; the name comes when all are there."""
    store = stored_results(tmp_path)

    def refuse(*_):
        raise OSError("another file system")

    def cut_off(_file, target):
        target.write_bytes(b"tab")
        raise OSError("no space left")

    monkeypatch.setattr(os, "link", refuse)
    with monkeypatch.context() as broken:
        broken.setattr("service.store.files.shutil.copyfile", cut_off)
        with pytest.raises(OSError, match="no space left"):
            put(store, tmp_path, b"table")
    assert store.find(KEY, "database") is None
    (left,) = [file.name for file in store.files.files() if file.name != NOTE]
    assert left.endswith(".part")
    put(store, tmp_path, b"table")
    assert store.verified(KEY, "database").path.read_bytes() == b"table"


def test_what_was_fetched_is_kept_and_a_damaged_copy_is_fetched_anew(tmp_path, s3_url):
    put(result_store(open_database(tmp_path / "index.sqlite3"), tmp_path / "one", s3_url), tmp_path, b"table")
    other = result_store(open_database(tmp_path / "index.sqlite3"), tmp_path / "other", s3_url)
    cached = other.verified(KEY, "database").path
    assert cached.is_relative_to(tmp_path / "other" / "cache") and cached.read_bytes() == b"table"
    cached.write_bytes(b"tabla")
    assert other.verified(KEY, "database").path.read_bytes() == b"table"


def test_the_cache_is_bounded_and_spares_what_is_being_read(tmp_path, s3_url):
    files = object_files(s3_url, tmp_path / "cache", 250)
    for number in range(4):
        made = tmp_path / f"made_{number}"
        made.write_bytes(bytes([number]) * 100)
        files.put(f"database/{number}.nc", made, hashlib.sha256(made.read_bytes()).hexdigest())
    held = sorted((tmp_path / "cache").rglob("*.nc"))
    assert len(held) == 4
    for path in held[:3]:
        os.utime(path, (0.0, 0.0))
    (last := tmp_path / "last").write_bytes(b"5" * 100)
    files.put("database/5.nc", last, hashlib.sha256(b"5" * 100).hexdigest())
    left = sorted((tmp_path / "cache").rglob("*.nc"))
    assert len(left) == 2 and held[3] in left


def test_a_store_that_does_not_answer_is_said(tmp_path, s3_objects, monkeypatch):
    monkeypatch.setattr("service.store.object_files.RETRIES", {"max_retries": 1})
    store = result_store(open_database(tmp_path / "index.sqlite3"), tmp_path, "s3://bucket/prefix")
    put(store, tmp_path, b"table")
    s3_objects.down = True
    for asked in (lambda: put(store, tmp_path, b"other", OTHER), lambda: store.find(KEY, "database")):
        with pytest.raises(StoreUnavailable):
            asked()
    assert store.verified(KEY, "database").path.read_bytes() == b"table"  # from the cache
    s3_objects.down = False
    store.put(OTHER, "database", tmp_path / "made")
    assert store.verified(OTHER, "database").path.read_bytes() == b"other"


def test_credentials_of_a_bucket_come_from_files(tmp_path, monkeypatch):
    for name in ("ACCESS_KEY_ID", "SECRET_ACCESS_KEY"):
        monkeypatch.delenv(f"AWS_{name}", raising=False)
        (tmp_path / name).write_text(f"of {name}\n")
        monkeypatch.setenv(f"LOA_RESULTS_{name}_FILE", str(tmp_path / name))
    keys = Settings().results_keys
    assert keys == ("of ACCESS_KEY_ID", "of SECRET_ACCESS_KEY")
    files = result_files(tmp_path, "s3://bucket/prefix", keys=keys)
    assert isinstance(files, ObjectFiles)
    config = files._store.config
    assert (config["access_key_id"], config["secret_access_key"]) == keys
    monkeypatch.delenv("LOA_RESULTS_ACCESS_KEY_ID_FILE")
    with pytest.raises(BadInput) as caught:
        load_settings()
    assert [fault.field for fault in caught.value.faults] == ["results_secret_access_key"]


@pytest.mark.parametrize("url", ["s3://", "ftp://host/folder", "file://host/folder", "results"])
def test_a_place_that_is_none_is_refused(tmp_path, url):
    with pytest.raises(BadInput) as caught:
        result_files(tmp_path, url)
    assert [fault.field for fault in caught.value.faults] == ["results_url"]


@pytest.mark.parametrize("make", [lambda path: f"file://{path}/shared%20results"])
def test_a_folder_may_be_elsewhere(tmp_path, make):
    store = stored_results(tmp_path / "data", results_url=make(tmp_path))
    put(store, tmp_path, b"table")
    assert store.verified(KEY, "database").path.is_relative_to(tmp_path / "shared results")


def test_a_data_directory_serves_one_service_at_a_time(tmp_path):
    first, second = DirectoryLock(tmp_path), DirectoryLock(tmp_path)
    first.acquire()
    with pytest.raises(BadInput, match="another service works in it"):
        second.acquire()
    first.release()
    second.acquire()
    second.release()


def test_a_file_where_the_directory_should_be_is_refused(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="a writable directory"):
        DirectoryLock(tmp_path / "file").acquire()


def test_no_connection_outlives_its_transaction(tmp_path):
    """Kept connections of ended threads were closed by nobody (Python 3.13 says so)."""
    engine = open_database(tmp_path / "index.sqlite3")
    opened, closed = [], []
    event.listen(engine, "connect", lambda connection, _record: opened.append(connection))
    event.listen(engine, "close", lambda connection, _record: closed.append(connection))
    for transaction in (reading, writing):
        with transaction(engine) as connection:
            connection.exec_driver_sql("SELECT 1")
    assert len(opened) == len(closed) == 2
