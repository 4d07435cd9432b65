"""Compiled loops that name what an upgrade in place has taken away are compiled anew."""

from __future__ import annotations

import sys
from pathlib import Path
from types import ModuleType

import pytest
from numba.core.caching import IndexDataCacheFile

from host import loops


@pytest.mark.parametrize("renamed", ["module", "name"])
@pytest.mark.parametrize("place", ["index", "data"])
def test_an_entry_that_names_what_is_gone_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, renamed: str, place: str
) -> None:
    assert loops.njit is not None
    module = ModuleType("loops_of_before")
    exec("class Called:\n    pass\n", module.__dict__)
    monkeypatch.setitem(sys.modules, "loops_of_before", module)
    cache = IndexDataCacheFile(str(tmp_path), "loop", ("stamp", 1))
    key, data = (module.Called, "code") if place == "index" else ("key", module.Called)
    cache.save(key, data)
    assert cache.load(key) == data
    if renamed == "module":
        monkeypatch.delitem(sys.modules, "loops_of_before")
    else:
        del module.Called
    assert cache.load("key") is None
    cache.save("key", "code of now")
    assert cache.load("key") == "code of now"
