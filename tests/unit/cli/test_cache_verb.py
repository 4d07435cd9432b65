"""``loa cache``: what is kept, what goes first, and that reading counts as use."""

import json
import os
import time
from pathlib import Path
from typing import Any

import pytest
from command_line import loa

from fe_contact.compliance.cache import read_compliance
from fe_contact.compliance.flank import FlankCompliance
from service.folder_size import evict, files_in

EXAMPLE = Path(__file__).parents[3] / "examples" / "palermo_spur_20_20.toml"
HOUR = 3600.0


@pytest.fixture
def cache(tmp_path, monkeypatch):
    """A cache of three files of 1000 bytes, used one to three hours ago."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.delenv("LOA_CACHE_BYTES", raising=False)
    home = tmp_path / "lineofaction"
    for hours, name in ((1, "compliance/new.npz"), (2, "results/middle.nc"), (3, "compliance/old.npz")):
        file = home / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(bytes(1000))
        os.utime(file, (time.time() - hours * HOUR,) * 2)
    return home


def held(cache: Path) -> set[str]:
    return {file.path.name for file in files_in(cache)}


def test_the_list_tells_files_and_bytes_by_kind(cache):
    facts: dict[str, Any] = json.loads(loa("cache", "list", "--json").stdout)
    assert facts["limit_bytes"] == 2_000_000_000
    assert facts["kinds"]["compliance"] == {"files": 2, "bytes": 2000}
    assert facts["kinds"]["results"] == {"files": 1, "bytes": 1000}
    assert str(cache) in loa("cache", "list").stdout


def test_what_was_not_used_for_longest_goes_first(cache):
    assert "removed 1 files" in loa("cache", "limit", "--gb", 2.5e-6).stdout
    assert held(cache) == {"new.npz", "middle.nc"}
    loa("cache", "limit", "--gb", 1e-6)
    assert held(cache) == {"new.npz"}


def test_what_is_in_use_stays(cache):
    os.utime(cache / "compliance" / "old.npz")
    loa("cache", "limit", "--gb", 0.0)
    assert held(cache) == {"old.npz"}
    assert [file.path.name for file in evict(cache, 0, in_use_s=0.0)] == ["old.npz"]


def test_a_cache_that_fits_is_left_alone(cache):
    assert "removed 0 files" in loa("cache", "limit").stdout
    assert len(held(cache)) == 3


def test_a_verb_that_computes_keeps_the_cache_within_its_limit(cache, monkeypatch):
    monkeypatch.setenv("LOA_CACHE_BYTES", "1500")
    assert loa("geometry", EXAMPLE).exit_code == 0
    assert held(cache) == {"new.npz"}
    monkeypatch.setenv("LOA_CACHE_BYTES", "2 GB")
    done = loa("geometry", EXAMPLE)
    assert done.exit_code == 2
    assert "LOA_CACHE_BYTES = '2 GB': must be a number of bytes" in done.stderr


def test_kinds_are_cleared_one_by_one_or_all(cache):
    assert "removed 2 files" in loa("cache", "clear", "compliance").stdout
    assert held(cache) == {"middle.nc"}
    loa("cache", "clear")
    assert held(cache) == set()
    assert loa("cache", "clear", "nonsense").exit_code == 2


def test_reading_a_compliance_is_a_use(tmp_path, cache):
    done = loa("analyze", EXAMPLE, "-o", tmp_path / "a.nc", "--level", "draft", "--torque", 100)
    assert done.exit_code == 0, done.output
    (file, *_) = list((cache / "compliance").glob("compliance-*.npz"))
    os.utime(file, (time.time() - HOUR,) * 2)
    key = file.stem.removeprefix("compliance-")
    assert read_compliance(file.parent, key, FlankCompliance) is not None
    assert time.time() - file.stat().st_mtime < 60.0
