"""Answers that are kept: the bytes that were put, within a limit, none in a folder that cannot be written."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from service.live.pool import KeptAnswers
from service.version import modules_digest


def test_what_is_kept_is_found_by_any_process_on_the_folder(tmp_path: Path) -> None:
    folder = tmp_path / "figures"
    assert KeptAnswers(folder).find("a tag") is None
    KeptAnswers(folder).keep("a tag", b'{"title": "pair"}')
    assert KeptAnswers(folder).find("a tag") == b'{"title": "pair"}'
    assert KeptAnswers(folder).find("another tag") is None


def test_what_was_not_used_for_longest_goes_first(tmp_path: Path) -> None:
    kept = KeptAnswers(tmp_path, most_bytes=250)
    for tag in ("first", "second"):
        kept.keep(tag, tag[:1].encode() * 100)
    for path in tmp_path.iterdir():  # long ago: what was used a moment ago stays
        os.utime(path, (1e9, 1e9))
    assert kept.find("first") == b"f" * 100
    kept.keep("third", b"t" * 100)
    assert kept.find("second") is None
    assert kept.find("first") is not None
    assert kept.find("third") is not None


def test_a_folder_that_cannot_be_written_keeps_nothing(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("no folder", encoding="utf-8")
    kept = KeptAnswers(tmp_path / "file")
    kept.keep("a tag", b"{}")
    assert kept.find("a tag") is None


@pytest.mark.parametrize("package", ["service", "lineofaction", "host", "dynamics"])
def test_answers_of_an_edited_program_are_others(tmp_path: Path, package: str) -> None:
    module = tmp_path / package / "report" / "content.py"
    module.parent.mkdir(parents=True)
    module.write_text("ROOM = 1\n", encoding="utf-8")
    before = modules_digest(tmp_path)
    assert modules_digest(tmp_path) == before
    module.write_text("ROOM = 2\n", encoding="utf-8")
    assert modules_digest(tmp_path) != before
