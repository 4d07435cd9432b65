"""Compiled loops on disk, found by the content of all code that they call.

numba finds an entry by the hash of the file of its loop: an inner loop that another file changed would leave
the code of its callers as it was. Here an entry has the key of that file and of all that it imports, and of
the versions that compile, in its name and in it: whatever changes, a stale entry is never read.

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
from functools import partial
from pathlib import Path
from typing import Any

import llvmlite
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

from host.loop_sources import PACKAGES, PROJECT, Sources, sources

SHIPPED = Path(__file__).parent / "shipped_loops"
VERSIONS = (sys.implementation.cache_tag, numba.__version__, llvmlite.__version__, np.__version__)
MAX_VERSIONS = 4
"""Number of versions of a loop that stay in a folder: those of other branches, of other Pythons."""

_UNREADABLE = (AttributeError, ImportError, EOFError, pickle.UnpicklingError, TypeError, ValueError)
"""Errors of reading an entry that is cut off, or names modules and functions that are gone."""


class _Provided(UserProvidedCacheLocator):
    """Folders in NUMBA_CACHE_DIR by the name of a package: clones of the project share compiled loops."""

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
    """The cache of a loop."""

    _impl_class = _Implementation

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)
        file = Path(function.__code__.co_filename).resolve()
        folder = Path(self._cache_path)
        self._sources, key = _key(file, function.__module__, folder)
        self._loop = self._impl.filename_base
        entries = partial(_Entries, filename_base=f"{self._loop}.{key[:16]}", source_stamp=key)
        self._cache_file = entries(str(folder))
        self._shipped = entries(str(_folder(SHIPPED, function)))

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
        loop = self._loop.rpartition("-")[0]  # without its line
        indices = sorted(Path(self._cache_path).glob(f"{loop}-*.nbi"), key=lambda path: -path.stat().st_mtime)
        for index in indices[MAX_VERSIONS:]:
            for file in [index, *index.parent.glob(f"{index.stem}.*.nbc")]:
                file.unlink(missing_ok=True)


def _folder(folder: Path, function: Callable[..., Any]) -> Path:
    return folder / function.__module__.rpartition(".")[0].replace(".", "/")


def _key(file: Path, module: str, folder: Path) -> tuple[Sources, str]:
    """Return the files that decide what a loop is, and the key of their content and of what compiles them."""
    depth = min(module.count("."), len(file.parents) - 1)
    root = PROJECT if PROJECT in file.parents else file.parents[depth]
    package = file.relative_to(root).parts[0].removesuffix(".py")
    manifest = _manifest(folder, package) if root == PROJECT and package in PACKAGES else None
    found = sources(root, package)
    return found, f"{found.key(file, manifest)}-{'-'.join(map(str, VERSIONS))}"


def _manifest(folder: Path, package: str) -> Path:
    """Return the file that keeps the keys of a package, by the folder that its loops are kept in."""
    clone = hashlib.sha256(str(PROJECT).encode()).hexdigest()[:8]
    if config.CACHE_DIR:
        return Path(config.CACHE_DIR, f"{package}-{clone}.json")
    in_pycache = folder.name == "__pycache__"
    return (PROJECT / package / "__pycache__" if in_pycache else folder.parent) / f"{package}-{clone}.json"
