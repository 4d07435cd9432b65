"""Compiled loops that processes share: one compiles, the others wait and read the result.

numba alone would let each process compile a function that is not on disk yet, and two processes that store
different signatures of a function at the same time could write to the same file. Here a lock for each
function prevents both.

Loops are compiled for a family of processors (`host.processor_family`). A stored loop is found by the content
of the functions that it calls (`host.loop_cache`). Inner loops become part of their callers
(`host.linked_loops`).
"""

# mypy: disable-error-code="no-untyped-call, attr-defined"
from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cached_property, partial
from pathlib import Path
from typing import Any, TypeVar, cast

from numba.core import config
from numba.core.compiler_lock import global_compiler_lock
from numba.core.registry import CPUDispatcher

from host import Unavailable, lock
from host.linked_loops import LinkedCompiler, link_what_numba_writes
from host.loop_cache import LoopCache
from host.processor_family import compile_for_family

Function = TypeVar("Function", bound=Callable[..., Any])

_BARE = {"nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""numba's options of a loop that only compiled loops call: without wrappers for Python and C."""
_locked_files: set[Path] = set()
"""Files whose locks this process holds."""


class Loop(CPUDispatcher):
    """A loop that Python calls: one process at a time compiles it, the others read its entry."""

    def enable_caching(self) -> None:
        """Store compiled loops on disk."""
        self._cache = LoopCache(self.py_func)

    def compile(self, sig: Any) -> Any:
        """Compile a signature, or read what another process compiled."""
        folder = getattr(self._cache, "cache_path", None)
        if folder is None:
            return super().compile(sig)
        name = f"{self.py_func.__module__}.{self.py_func.__qualname__}"
        with global_compiler_lock, _locked(Path(folder) / f"{name}.lock"), _nothing_collected():
            return super().compile(sig)


class _Inner(CPUDispatcher):
    """A loop that compiled loops call; it has no machine code, no wrapper for Python and no entry on disk.

    Where Python calls it nevertheless, it is compiled once more as a `Loop`.
    """

    def __call__(self, *arguments: Any) -> Any:
        return self._outer(*arguments)

    @cached_property
    def _outer(self) -> Any:
        options = {name: value for name, value in self.targetoptions.items() if name not in _BARE}
        return njit(cache=True, **options)(self.py_func)


@contextmanager
def _nothing_collected() -> Iterator[None]:
    """Pause the garbage collector: it takes a fifth of the time of a compilation, which drops few objects."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


@contextmanager
def _locked(file: Path) -> Iterator[None]:
    """Hold the lock of a function, by its file, where the system has locks and the folder can be written.

    A function that calls itself finds its lock held by this process. Locks are taken in the order of calls,
    so that no two processes wait for each other.
    """
    if file in _locked_files:
        yield
        return
    descriptor = -1
    with suppress(OSError, Unavailable):
        file.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(file, os.O_CREAT | os.O_RDWR, 0o666)
        lock(descriptor, wait=True)
    _locked_files.add(file)
    try:
        yield
    finally:
        _locked_files.remove(file)
        if descriptor >= 0:
            os.close(descriptor)


def njit(function: Callable[..., Any] | None = None, *, cache: bool = False, **options: Any) -> Any:
    """Compile a loop that Python calls, with options of numba's `njit`; `cache` keeps it on disk."""
    if function is None:
        return partial(njit, cache=cache, **options)
    if config.DISABLE_JIT:
        return function
    loop = Loop(function, targetoptions={"nopython": True, **options})
    if cache:
        loop.enable_caching()
    return loop


def inner(**options: Any) -> Callable[[Function], Function]:
    """Return a decorator that compiles a loop into its callers, with options of `njit`."""

    def compiled(function: Function) -> Function:
        if config.DISABLE_JIT:
            return function
        loop = _Inner(function, targetoptions={**_BARE, **options}, pipeline_class=LinkedCompiler)
        return cast(Function, loop)

    return compiled


# both change numba for the whole process, before any loop is compiled
compile_for_family()
link_what_numba_writes()
