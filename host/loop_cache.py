"""Compiled loops on disk, found by the content of all code that they call.

numba checks an entry by the file of its loop alone: after a change of an inner loop in another file, it would
still run the old code of the callers. Here a key stands in the name of an entry and in the entry. It is a
hash of the file of the loop and of all files that this file imports, with the versions of Python, numba,
llvmlite and numpy: a stale entry is never read.

numba's words: an overload is the code for one signature; an index (``.nbi``) lists the overloads of a loop,
each of which is a file of data (``.nbc``). Both begin with ``filename_base``, "loop-LINE.pyXY".

Entries are read, and new ones written, in `NUMBA_CACHE_DIR`, beside the source or in the user's folder of
caches, the first that can be written; they are read in `SHIPPED` too, which an installation fills.
"""

# mypy: disable-error-code="no-untyped-call, attr-defined"
from __future__ import annotations

import hashlib
import pickle
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding as llvm
import numba
import numpy as np
from numba.core import config
from numba.core.caching import (
    CompileResultCacheImpl,
    FunctionCache,
    IndexDataCacheFile,
    InTreeCacheLocator,
    UserProvidedCacheLocator,
    UserWideCacheLocator,
)
from numba.core.runtime import _nrt_python

from host.loop_sources import PACKAGES, PROJECT, Sources, sources

SHIPPED = Path(__file__).parent / "shipped_loops"
VERSIONS = (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, np.__version__)
MAX_VERSIONS = 4
"""Number of versions of a loop that stay in a folder: those of other branches, of other Pythons."""

_UNREADABLE = (AttributeError, ImportError, EOFError, pickle.UnpicklingError, TypeError, ValueError)
"""Errors of reading an entry that is cut off, or names modules and functions that are gone."""


class _Provided(UserProvidedCacheLocator):
    """Locator of folders in NUMBA_CACHE_DIR by the name of a package: clones share compiled loops."""

    def __init__(self, function: Callable[..., Any], file: str) -> None:
        super().__init__(function, file)
        self._cache_path = str(_folder(Path(config.CACHE_DIR), function))


class _Nowhere(UserWideCacheLocator):
    """Locator for hosts without a writable folder: only the loops of an installation are read."""

    @classmethod
    def from_function(cls, function: Callable[..., Any], file: str) -> _Nowhere:
        """Return the locator for any loop."""
        return cls(function, file)


class _Implementation(CompileResultCacheImpl):
    _locator_classes = [_Provided, InTreeCacheLocator, UserWideCacheLocator, _Nowhere]  # noqa: RUF012 - as numba's


class _Entries(IndexDataCacheFile):
    """The entries of a loop; unreadable ones count as absent."""

    def load(self, key: Any) -> Any:
        """Return the entry of a signature, None if there is none."""
        try:
            return super().load(key)
        except _UNREADABLE:
            return None

    def _load_index(self) -> Any:
        try:
            return super()._load_index()
        except _UNREADABLE:
            return {}


class LoopCache(FunctionCache):
    """The cache of the compiled overloads of one loop, beside the source and in an installation."""

    _impl_class = _Implementation

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        file = Path(function.__code__.co_filename).resolve()
        folder = Path(self._cache_path)
        self._sources, key = _key(file, function.__module__, folder)
        self._loop = self._impl.filename_base
        # 16 digits of the key tell versions apart in names; the stamp has all of it
        entries = partial(_Entries, filename_base=f"{self._loop}.{key[:16]}", source_stamp=key)
        self._cache_file = entries(str(folder))
        self._shipped = entries(str(_folder(SHIPPED, function)))

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Return the overload of a signature, None if there is none.

        numba first loads all that a compilation may need, and compiles its runtime: 0.25 CPU s. An entry is
        machine code, and calls functions by their addresses alone. What is compiled loads the rest itself.
        """
        _name_runtime_functions()
        with self._guard_against_spurious_io_errors():
            return self._load_overload(signature, context)

    def _load_overload(self, signature: Any, context: Any) -> Any:
        entry = super()._load_overload(signature, context)
        if entry is not None or not self._enabled:
            return entry
        data = self._shipped.load(self._index_key(signature, context.codegen()))
        return None if data is None else self._impl.rebuild(context, data)

    def _save_overload(self, signature: Any, data: Any) -> None:
        """Store an entry, unless sources changed since they were read: its version is then unknown."""
        if self._sources.unchanged():
            with suppress(OSError):  # a full disk costs the next process time, not this one its result
                super()._save_overload(signature, data)
                self._remove_old()

    def _remove_old(self) -> None:
        """Remove all versions of the loop in the folder but the last few."""
        loop = self._loop.rpartition("-")[0]  # without "-LINE.pyXY": of any line and Python
        indices = sorted(Path(self._cache_path).glob(f"{loop}-*.nbi"), key=lambda path: -path.stat().st_mtime)
        for index in indices[MAX_VERSIONS:]:
            for file in [index, *index.parent.glob(f"{index.stem}.*.nbc")]:
                file.unlink(missing_ok=True)


@lru_cache(maxsize=1)
def _name_runtime_functions() -> None:
    """Tell LLVM the addresses of the functions of numba's runtime, by the names that compiled code calls."""
    for name, address in _nrt_python.c_helpers.items():
        llvm.add_symbol(name if name.startswith("_") else f"NRT_{name}", address)


def _folder(folder: Path, function: Callable[..., Any]) -> Path:
    """Return the folder of a function's package below `folder`."""
    return folder / function.__module__.rpartition(".")[0].replace(".", "/")


def _key(file: Path, module: str, folder: Path) -> tuple[Sources, str]:
    """Return the sources that a loop depends on, and the key of their content and of `VERSIONS`."""
    # The module a.b.c is root/a/b/c.py: as many parents up as it has dots is the folder of its package.
    depth = min(module.count("."), len(file.parents) - 1)
    root = PROJECT if PROJECT in file.parents else file.parents[depth]
    package = file.relative_to(root).parts[0].removesuffix(".py")
    manifest = _manifest(folder, package) if root == PROJECT and package in PACKAGES else None
    files = sources(root, package)
    return files, f"{files.key(file, manifest)}-{'-'.join(map(str, VERSIONS))}"


def _manifest(folder: Path, package: str) -> Path:
    """Return the file that stores the keys of a package; `folder` is the cache folder of one of its loops.

    It stands in NUMBA_CACHE_DIR, in the ``__pycache__`` of the package, or beside `folder` in the user's
    cache.
    """
    # Clones may share a cache, and have different sources: the name has a hash of the path of the clone.
    clone = hashlib.sha256(str(PROJECT).encode()).hexdigest()[:8]
    if config.CACHE_DIR:
        return Path(config.CACHE_DIR, f"{package}-{clone}.json")
    in_pycache = folder.name == "__pycache__"
    return (PROJECT / package / "__pycache__" if in_pycache else folder.parent) / f"{package}-{clone}.json"
