"""A result is made once for its content, and never lost to its cache."""

from __future__ import annotations

import os
from pathlib import Path

from model_studies.cached_file import cached_in


class Counted:
    """A result and how often it is made."""

    times = 0

    def make(self) -> str:
        self.times += 1
        return "result"


def kept(file: Path | None, counted: Counted, keep: bool = True) -> str:
    return cached_in(
        file,
        Path.read_text,
        counted.make,
        lambda made, at: at.write_text(made),
        OSError,
        lambda _made: keep,
    )


def test_a_result_is_made_once_for_its_file(tmp_path):
    file, counted = tmp_path / "new" / "kept", Counted()
    assert [kept(file, counted), kept(file, counted)] == ["result", "result"]
    assert counted.times == 1
    file.unlink()
    assert kept(file, counted) == "result"
    assert counted.times == 2


def test_what_is_not_to_be_kept_leaves_no_file(tmp_path):
    file = tmp_path / "kept"
    assert kept(file, Counted(), keep=False) == kept(None, Counted()) == "result"
    assert not list(tmp_path.iterdir())


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
