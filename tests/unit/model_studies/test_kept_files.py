"""A result is made once for its content, and never lost to its cache."""

import os
from pathlib import Path

from model_studies.cached_file import keep_cached, read_cached


class Counted:
    """A result and how often it is made."""

    times = 0

    def make(self) -> str:
        self.times += 1
        return "result"


def kept(file: Path | None, counted: Counted) -> str:
    cached = read_cached(file, Path.read_text, OSError)
    if cached is not None:
        return cached
    made = counted.make()
    keep_cached(made, file, lambda text, at: at.write_text(text))
    return made


def test_a_result_is_made_once_for_its_file(tmp_path):
    file, counted = tmp_path / "new" / "kept", Counted()
    assert [kept(file, counted), kept(file, counted)] == ["result", "result"]
    assert counted.times == 1
    file.unlink()
    assert kept(file, counted) == "result"
    assert counted.times == 2


def test_without_a_file_nothing_is_kept():
    counted = Counted()
    assert [kept(None, counted), kept(None, counted)] == ["result", "result"]
    assert counted.times == 2


def test_a_folder_that_cannot_be_made_loses_nothing(tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("in the way")
    assert kept(blocked / "kept", Counted()) == "result"


def test_the_last_use_is_its_time(tmp_path):
    file, counted = tmp_path / "kept", Counted()
    kept(file, counted)
    os.utime(file, (0.0, 0.0))
    kept(file, counted)
    assert file.stat().st_mtime > 0.0
