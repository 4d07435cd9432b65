"""The client's cache: what it gives is what was kept, whoever else writes, whatever happened to the disk."""

import hashlib
import threading
from pathlib import Path

import pytest

from lineofaction.client import Result, ResultCache
from lineofaction.gearbox.problems import BadInput

KEY = "ab" * 32
RESULT = Result(KEY, "database", f"/v1/results/{KEY}")
ADDRESS = "http://127.0.0.1:8321"


@pytest.fixture
def cache(tmp_path):
    return ResultCache(tmp_path)


def keep(cache: ResultCache, content: bytes, key: str = KEY) -> Path:
    with cache.incoming() as file:
        file.write(content)
        return cache.keep("database", key, file, hashlib.sha256(content).hexdigest())


def test_what_was_kept_is_given(cache):
    file = keep(cache, b"table")
    assert cache.get("database", KEY) == file
    assert file.read_bytes() == b"table" and file.suffix == ".nc"
    assert cache.get("database", "cd" * 32) is None
    assert cache.get("run", KEY) is None


@pytest.mark.parametrize("damaged", [b"tabel", b""], ids=["changed", "cut short"])
def test_a_damaged_file_is_set_aside_for_a_person_to_look_at(cache, damaged):
    file = keep(cache, b"table")
    file.write_bytes(damaged)
    assert cache.get("database", KEY) is None
    assert [(f.name, f.read_bytes()) for f in file.parent.iterdir()] == [(f"{file.name}.damaged", damaged)]
    assert keep(cache, b"table") == cache.get("database", KEY)


def test_what_is_not_kept_leaves_nothing(tmp_path, cache):
    def breaks():
        with cache.incoming() as file:
            file.write(b"half")
            raise RuntimeError("the line broke")

    with pytest.raises(RuntimeError):
        breaks()
    assert [f for f in tmp_path.rglob("*") if f.is_file()] == []


def test_writers_of_the_same_key_never_spoil_it_for_readers(tmp_path):
    """Two services may give different bytes for one key. Processes share files alone, as threads here do."""
    contents = (b"one" * 20_000, b"two" * 30_000)
    keep(ResultCache(tmp_path), contents[0])
    seen: list[bytes | None] = []

    def write(content):
        for _ in range(40):
            keep(ResultCache(tmp_path), content)

    def read():
        for _ in range(120):
            file = ResultCache(tmp_path).get("database", KEY)
            seen.append(None if file is None else file.read_bytes())

    threads = [threading.Thread(target=write, args=(content,)) for content in contents]
    threads += [threading.Thread(target=read) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(seen) == 240
    assert set(seen) <= set(contents)
    assert list(tmp_path.rglob("*.damaged")) == [] and list(tmp_path.rglob("*.part")) == []


def test_a_name_cannot_lead_out_of_the_cache(tmp_path):
    cache = ResultCache(tmp_path / "cache")
    file = keep(cache, b"table", "../../outside")
    assert file.parent.parent == tmp_path / "cache" / "database"
    assert cache.get("database", "../../outside") == file


def test_a_request_is_remembered_by_service_process_and_inputs(cache):
    keep(cache, b"table")
    cache.remember(ADDRESS, "analyze", {"case": {"a": 1, "b": 2}}, RESULT)
    assert cache.recall(ADDRESS, "analyze", {"case": {"b": 2, "a": 1}}) == RESULT
    assert cache.recall(ADDRESS, "analyze", {"case": {"a": 1, "b": 3}}) is None
    assert cache.recall(ADDRESS, "flank", {"case": {"a": 1, "b": 2}}) is None
    assert cache.recall("http://other:8321", "analyze", {"case": {"a": 1, "b": 2}}) is None


def test_a_request_whose_file_is_damaged_is_not_remembered(cache):
    cache.remember(ADDRESS, "analyze", {}, RESULT)
    assert cache.recall(ADDRESS, "analyze", {}) is None
    keep(cache, b"table").write_bytes(b"tabel")
    assert cache.recall(ADDRESS, "analyze", {}) is None


def test_notes_that_cannot_be_read_are_as_good_as_none(tmp_path, cache):
    keep(cache, b"table")
    cache.remember(ADDRESS, "analyze", {}, RESULT)
    (note,) = (tmp_path / "requests").iterdir()
    for text in ("", "[]", '{"key": 1}', "\x00"):
        note.write_text(text)
        assert cache.recall(ADDRESS, "analyze", {}) is None


def test_a_folder_that_cannot_be_written_is_named_with_what_to_try(tmp_path):
    (tmp_path / "file").write_text("not a folder")
    with pytest.raises(BadInput, match=r"cache_dir = .*file'.*: must be a folder .* XDG_CACHE_HOME"):
        keep(ResultCache(tmp_path / "file"), b"table")
