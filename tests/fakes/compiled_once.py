"""Functions that several test processes need are compiled by one of them; the others read what it kept.

Each of them would otherwise compile for itself what is not in the cache yet, and two that keep different
signatures of a function at a time could take the same file for them.
"""

from __future__ import annotations

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher

_held: set[Path] = set()


def compile_once() -> None:
    """Let this process wait while another compiles, or reads, a function it needs."""
    compiled = Dispatcher.compile

    def one_at_a_time(self: Dispatcher, signature: Any) -> Any:
        folder = getattr(self._cache, "cache_path", None)
        if folder is None:
            return compiled(self, signature)
        with global_compiler_lock, _locked(Path(folder), self.py_func.__qualname__):
            return compiled(self, signature)

    Dispatcher.compile = one_at_a_time


@contextmanager
def _locked(folder: Path, name: str) -> Iterator[None]:
    """Hold the lock of a function; one that calls itself holds it already."""
    file = folder / f"{name}.lock"
    if file in _held:
        yield
        return
    folder.mkdir(parents=True, exist_ok=True)
    with file.open("wb") as stream:
        fcntl.flock(stream, fcntl.LOCK_EX)
        _held.add(file)
        try:
            yield
        finally:
            _held.remove(file)
