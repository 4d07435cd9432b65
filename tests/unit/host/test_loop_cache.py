"""Compiled loops are found by the content of all that they call, also those that an installation brings."""

import importlib
import os
import pickle
import shutil
import sys
from pathlib import Path
from typing import Any

import pytest
from numba.core import config
from structure import imported

from host import loop_cache, loop_sources
from host.loop_sources import PROJECT, Sources
from host.processor_family import FAMILIES, family_of

OUTER = """
from host.loops import njit
from gears.inner import scaled

@njit(cache=True)
def outer(x):
    return scaled(x) + 1.0
"""
INNER = """
from host.loops import inner
from gears.constants import (
    FACTOR,  # (of the pair)
)

@inner()
def scaled(x):
    return FACTOR * x
"""


@pytest.fixture(autouse=True)
def beside_the_source(monkeypatch):
    """Keep entries beside the source, also where the whole run of tests has a folder for them."""
    monkeypatch.setattr(config, "CACHE_DIR", "")


def project(folder: Path) -> Path:
    package = folder / "gears"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "loop.py").write_text(OUTER)
    (package / "inner.py").write_text(INNER)
    (package / "constants.py").write_text("FACTOR = 3.0\n")
    return folder


def loop(folder: Path) -> Any:
    """Return the loop as a process that starts finds it."""
    for cached in (loop_sources.sources, loop_sources._of_folder):
        cached.cache_clear()
    for name in [name for name in sys.modules if name.partition(".")[0] == "gears"]:
        del sys.modules[name]
    importlib.invalidate_caches()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "path", [str(folder), *sys.path])
        patch.setattr(sys, "dont_write_bytecode", True)  # it is found by time and size
        return importlib.import_module("gears.loop").outer


def answer(folder: Path) -> tuple[float, bool]:
    """Call the loop: its result, and whether it was read."""
    outer = loop(folder)
    return outer(2.0), bool(outer.stats.cache_hits)


def edit(file: Path, before: str, after: str) -> None:
    """Change a file of equal length and time, as an upgrade may."""
    status = file.stat()
    assert len(before) == len(after)
    file.write_text(file.read_text().replace(before, after))
    os.utime(file, ns=(status.st_atime_ns, status.st_mtime_ns))


def test_a_loop_is_renewed_with_the_inner_loop_and_the_constant_that_it_calls(tmp_path):
    folder = project(tmp_path)
    assert [answer(folder), answer(folder)] == [(7.0, False), (7.0, True)]
    edit(folder / "gears" / "inner.py", "FACTOR * x", "FACTOR - x")
    assert [answer(folder), answer(folder)] == [(2.0, False), (2.0, True)]
    edit(folder / "gears" / "constants.py", "3.0", "5.0")
    assert answer(folder) == (4.0, False)
    edit(folder / "gears" / "constants.py", "5.0", "3.0")
    assert answer(folder) == (2.0, True)


def test_clones_share_a_folder_by_content(tmp_path, monkeypatch):
    first, second = project(tmp_path / "a"), project(tmp_path / "b")
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "kept"))
    answers = [answer(first), answer(second)]
    edit(second / "gears" / "constants.py", "3.0", "5.0")
    answers += [answer(second), answer(first)]
    assert answers == [(7.0, False), (7.0, True), (11.0, False), (7.0, True)]


def test_what_an_installation_brings_is_read_and_nothing_is_written_there(tmp_path, monkeypatch):
    folder, shipped = project(tmp_path / "a"), tmp_path / "shipped"
    monkeypatch.setattr(config, "CACHE_DIR", str(shipped))
    assert answer(folder) == (7.0, False)
    files = sorted(shipped.rglob("*.nb?"))
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(loop_cache, "SHIPPED", shipped)
    assert answer(folder) == (7.0, True)
    edit(folder / "gears" / "inner.py", "FACTOR * x", "FACTOR - x")
    assert [answer(folder), answer(folder)] == [(2.0, False), (2.0, True)]
    assert sorted(shipped.rglob("*.nb?")) == files


def test_an_entry_that_is_cut_off_or_of_other_versions_is_none(tmp_path, monkeypatch):
    folder = project(tmp_path)
    kept = folder / "gears" / "__pycache__"
    answer(folder)
    for index in kept.glob("*.nbi"):
        index.write_bytes(index.read_bytes()[:-9])
    assert answer(folder) == (7.0, False)
    for data in kept.glob("*.nbc"):
        data.write_bytes(pickle.dumps(0)[:-1])
    assert answer(folder) == (7.0, False)
    monkeypatch.setattr(loop_cache, "VERSIONS", ("cpython-310",))
    assert answer(folder) == (7.0, False)


def test_few_versions_of_a_loop_are_kept(tmp_path):
    folder = project(tmp_path)
    for factor in range(loop_cache.MAX_VERSIONS + 2):
        (folder / "gears" / "constants.py").write_text(f"FACTOR = {factor}.0\n")
        assert answer(folder) == (2.0 * factor + 1.0, False)
    kept = [len(list(folder.glob(f"gears/__pycache__/loop.*.{kind}"))) for kind in ("nbi", "nbc")]
    assert kept == [loop_cache.MAX_VERSIONS] * 2


def test_keys_hold_all_files_that_the_statements_of_import_name():
    sources = Sources()
    for name in ("dynamics/meshes/flank_force.py", "fe_contact/contact/edge_strip.py"):
        for file in sources.files(name):
            modules = imported(PROJECT / file)
            named = {path for module in modules for path in sources._files_of(module)}
            assert named <= sources.files(name)
    assert "dynamics/kernels/compiled.py" in sources.files("dynamics/meshes/flank_force.py")


def test_keys_are_read_from_their_file_while_all_is_as_it_was(tmp_path):
    root = project(tmp_path / "a")
    manifest = tmp_path / "keys.json"
    loop = root / "gears" / "loop.py"
    key = Sources(root).key(loop, manifest)
    manifest.write_text(manifest.read_text().replace(key, "kept"))
    assert Sources(root).key(loop, manifest) == "kept"
    sources = Sources(root)
    sources.key(loop, manifest)
    edit(root / "gears" / "constants.py", "3.0", "5.0")
    assert not sources.unchanged()
    assert Sources(root).key(loop, manifest) not in {key, "kept"}
    manifest.write_text("no keys")
    assert Sources(root).key(loop, manifest) != key


def test_statements_of_import_are_found_in_all_their_forms(tmp_path):
    package = project(tmp_path) / "gears"
    (package / "sub").mkdir()
    shutil.copy(package / "constants.py", package / "sub" / "deep.py")
    forms = (
        "from gears.sub import deep",
        "import gears.sub.deep as d, math",
        "from .sub import deep",
        "from gears.sub import (  # all (of it)\n    nothing,\n    deep,\n)",
        "def late():\n    from gears.sub.deep import FACTOR",
        "from gears.sub import \\\n    deep",
        "import math, \\\n    gears.sub.deep",
    )
    for number, form in enumerate(forms):
        (package / f"form{number}.py").write_text(form + "\n")
    sources = Sources(tmp_path)
    assert all("gears/sub/deep.py" in sources.files(f"gears/form{n}.py") for n in range(len(forms)))


def test_what_changed_while_a_process_ran_is_not_kept(tmp_path):
    folder = project(tmp_path)
    outer = loop(folder)
    edit(folder / "gears" / "constants.py", "3.0", "9.0")
    assert outer(2.0) == 7.0
    assert not list(folder.rglob("*.nb?"))


def test_a_processor_has_the_family_whose_features_it_has():
    fourth = dict.fromkeys(FAMILIES["x86-64-v4"], True)
    assert family_of(fourth, "x86_64") == "x86-64-v4"
    assert family_of(fourth | {"avx512vl": False}, "AMD64") == "x86-64-v3"
    assert family_of(fourth | {"fma": False}, "x86_64") is None
    assert family_of(fourth, "aarch64") is None
