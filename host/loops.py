"""numba, with a cache that processes share: what one of them compiles the others wait for and read.

Each would otherwise compile for itself what is not kept yet, and two that keep different signatures of a
function at a time could take the same file for them. An entry is renewed with the file of its loop; it also
names modules and functions that the loop calls: where an upgrade has taken one away, it is compiled anew.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from numba import njit
from numba.core.caching import IndexDataCacheFile
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

from host import Unavailable, lock

__all__ = ["njit"]

_held: set[Path] = set()


def _unless_gone(load: Callable[..., Any], absent: Callable[[], Any]) -> Callable[..., Any]:
    def guarded(*arguments: Any) -> Any:
        try:
            return load(*arguments)
        except (AttributeError, ImportError):
            return absent()

    return guarded


for _name, _absent in (("load", lambda: None), ("_load_index", dict)):
    if _load := getattr(IndexDataCacheFile, _name, None):
        setattr(IndexDataCacheFile, _name, _unless_gone(_load, _absent))


def _one_at_a_time(compiled: Callable[..., Any]) -> Callable[..., Any]:
    def compile_or_read(self: Any, signature: Any) -> Any:
        folder = getattr(self._cache, "cache_path", None)
        if folder is None:
            return compiled(self, signature)
        name = f"{self.py_func.__module__}.{self.py_func.__qualname__}"
        with global_compiler_lock, _locked(Path(folder) / f"{name}.lock"):
            return compiled(self, signature)

    return compile_or_read


@contextmanager
def _locked(file: Path) -> Iterator[None]:
    """Hold the lock of a function, by its file, where the system has locks and the folder can be written.

    A function that calls itself holds it already. Locks nest as calls do: no two processes wait for each
    other.
    """
    if file in _held:
        yield
        return
    descriptor = -1
    with suppress(OSError, Unavailable):
        file.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(file, os.O_CREAT | os.O_RDWR, 0o666)
        lock(descriptor, wait=True)
    _held.add(file)
    try:
        yield
    finally:
        _held.remove(file)
        if descriptor >= 0:
            os.close(descriptor)


Dispatcher.compile = _one_at_a_time(Dispatcher.compile)  # type: ignore[method-assign]
