"""The result store: what is read is what was written, or it is refused."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import event

from service.problems import BadInput, DamagedFile, NotFound
from service.store import DirectoryLock, ResultStore, open_database, reading, writing

KEY = hashlib.sha256(b"input").hexdigest()


@pytest.fixture
def store(tmp_path: Path, database_url: str | None) -> Iterator[ResultStore]:
    """An empty store, its index in each database."""
    engine = open_database(database_url or tmp_path / "index.sqlite3")
    yield ResultStore(engine, tmp_path / "results")
    engine.dispose()


def put(store: ResultStore, tmp_path: Path, content: bytes, key: str = KEY) -> None:
    """Put some bytes into the store."""
    file = tmp_path / "made"
    file.write_bytes(content)
    store.put(key, "database", file)


def test_a_result_is_found_by_its_key_and_kind(store: ResultStore, tmp_path: Path) -> None:
    put(store, tmp_path, b"table")
    stored = store.verified(KEY, "database")
    assert stored.path.read_bytes() == b"table"
    assert (stored.sha256, stored.size) == (hashlib.sha256(b"table").hexdigest(), 5)
    with pytest.raises(NotFound):
        store.verified(KEY, "run")
    assert not (tmp_path / "made").exists()


def test_a_damaged_file_is_never_served_and_makes_room_for_a_new_one(
    store: ResultStore, tmp_path: Path
) -> None:
    put(store, tmp_path, b"table")
    store.verified(KEY, "database").path.write_bytes(b"tabla")
    with pytest.raises(DamagedFile):
        store.verified(KEY, "database")
    assert store.find(KEY, "database") is None
    put(store, tmp_path, b"table")
    assert store.verified(KEY, "database").path.read_bytes() == b"table"


def test_a_second_result_of_a_key_replaces_the_first(store: ResultStore, tmp_path: Path) -> None:
    put(store, tmp_path, b"one")
    put(store, tmp_path, b"two")
    assert store.verified(KEY, "database").path.read_bytes() == b"two"


@pytest.mark.parametrize("key", ["../../etc/passwd", "", KEY.upper(), KEY[:-1] + "/", "a" * 63])
def test_what_is_no_hash_names_no_file(store: ResultStore, key: str) -> None:
    with pytest.raises(NotFound):
        store.verified(key, "database")


def test_a_lost_file_counts_as_no_result(store: ResultStore, tmp_path: Path) -> None:
    put(store, tmp_path, b"table")
    store.verified(KEY, "database").path.unlink()
    assert store.find(KEY, "database") is None


def test_a_data_directory_serves_one_service_at_a_time(tmp_path: Path) -> None:
    first, second = DirectoryLock(tmp_path), DirectoryLock(tmp_path)
    first.acquire()
    with pytest.raises(BadInput, match="another service works in it"):
        second.acquire()
    first.release()
    second.acquire()
    second.release()


def test_a_file_where_the_directory_should_be_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="a directory we may write to"):
        DirectoryLock(tmp_path / "file").acquire()


def test_no_connection_outlives_its_transaction(tmp_path: Path) -> None:
    """Kept connections of ended threads were closed by nobody (Python 3.13 says so)."""
    engine = open_database(tmp_path / "index.sqlite3")
    opened, closed = [], []
    event.listen(engine, "connect", lambda connection, _record: opened.append(connection))
    event.listen(engine, "close", lambda connection, _record: closed.append(connection))
    for transaction in (reading, writing):
        with transaction(engine) as connection:
            connection.exec_driver_sql("SELECT 1")
    assert len(opened) == len(closed) == 2
