"""What numba compiled is taken by another clone whose file, and all that it imports, are the same."""

from __future__ import annotations

import importlib.util
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

SCRIPTS = Path(__file__).parents[3] / "scripts"
LOOP = """
from numba import njit
from fe_contact.constants import FACTOR

@njit(cache=True)
def scaled(x):
    return FACTOR * x
"""


@pytest.fixture
def loops(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The script as a module."""
    monkeypatch.syspath_prepend(SCRIPTS)
    yield importlib.import_module("compiled_loops")


def clone(folder: Path, factor: float) -> Path:
    """Write a project of a loop and of what it imports."""
    package = folder / "fe_contact"
    package.mkdir(parents=True)
    (package / "loop.py").write_text(LOOP)
    (package / "constants.py").write_text(f"FACTOR = {factor}\n")
    (package / "other.py").write_text(f"# {folder}\n")
    return folder


def called(folder: Path, factor: float) -> Any:
    """Call the loop of a clone; returns the compiled function."""
    spec = importlib.util.spec_from_file_location("loop", folder / "fe_contact" / "loop.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    constants = ModuleType("fe_contact.constants")
    constants.FACTOR = factor  # type: ignore[attr-defined]
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "fe_contact.constants", constants)
        spec.loader.exec_module(module)
    assert module.scaled(2.0) == 2.0 * factor
    return module.scaled


def test_an_equal_clone_takes_what_another_kept_and_one_with_another_import_does_not(
    loops: ModuleType, tmp_path: Path
) -> None:
    kept = tmp_path / "kept"
    first, equal, changed = (clone(tmp_path / name, f) for name, f in (("a", 3.0), ("b", 3.0), ("c", 5.0)))
    assert loops.restore(first, kept) == 0
    assert called(first, 3.0).stats.cache_misses
    assert loops.keep(first, kept) == 1
    shutil.copytree(first / "fe_contact" / "__pycache__", changed / "fe_contact" / "__pycache__")
    assert [loops.restore(other, kept) for other in (equal, changed)] == [1, 0]
    assert called(equal, 3.0).stats.cache_hits
    assert called(changed, 5.0).stats.cache_misses  # the file itself is the same: numba would have taken it


def test_what_changed_between_is_not_kept(loops: ModuleType, tmp_path: Path) -> None:
    project, kept = clone(tmp_path / "a", 3.0), tmp_path / "kept"
    loops.restore(project, kept)
    called(project, 3.0)
    (project / "fe_contact" / "constants.py").write_text("FACTOR = 7.0\n")
    assert loops.keep(project, kept) == 0
    assert loops.restore(project, kept) == 0
    assert loops.compiled(project / "fe_contact" / "loop.py") == []


def test_the_loops_of_the_project_are_among_its_keys(loops: ModuleType) -> None:
    keys = loops.keys()
    assert {"fe_contact/contact/newton.py", "dynamics/integrators/march.py"} <= keys.keys()
    assert len(set(keys.values())) == len(keys)
