"""numba, with a cache that processes share: what one of them compiles the others wait for and read.

Each would otherwise compile for itself what is not kept yet, and two that keep different signatures of a
function at a time could take the same file for them. An entry is renewed with the file of its loop; it also
names modules and functions that the loop calls: where an upgrade has taken one away, it is compiled anew.

numba optimizes each loop, makes machine code of it and wraps it for Python, and does so again in every loop
that calls it. An inner loop is linked as it is: what Python calls is optimized once, with all that it calls.
So is what numba itself writes in Python, as `np.zeros`.
"""

# mypy: disable-error-code="no-untyped-call"
from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cached_property, partial
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.caching import IndexDataCacheFile
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_lock import global_compiler_lock
from numba.core.dispatcher import Dispatcher
from numba.core.registry import CPUDispatcher
from numba.core.typing.templates import _OverloadFunctionTemplate
from numba.extending import overload
from numba.np import arrayobj

from host import Unavailable, lock

__all__ = ["inner", "njit"]

Loop = TypeVar("Loop", bound=Callable[..., Any])

_locked_files: set[Path] = set()
_BARE = {"nopython": True, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
_decorator = _OverloadFunctionTemplate._get_jit_decorator


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
        with global_compiler_lock, _locked(Path(folder) / f"{name}.lock"), _nothing_collected():
            return compiled(self, signature)

    return compile_or_read


@contextmanager
def _nothing_collected() -> Iterator[None]:
    """Keep the collector of garbage from walking all that a compilation holds, which takes a fifth of it."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


@contextmanager
def _locked(file: Path) -> Iterator[None]:
    """Hold the lock of a function, by its file, where the system has locks and the folder can be written.

    A function that calls itself holds it already. Locks nest as calls do: no two processes wait for each
    other.
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


Dispatcher.compile = _one_at_a_time(Dispatcher.compile)  # type: ignore[method-assign]


class _Linked(JITCodeLibrary):
    """The code of a loop as others link it: what it becomes part of is optimized, and made machine code."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def _optimize_final_module(self) -> None:
        pass

    def get_pointer_to_function(self, name: str) -> int:
        return 0

    @property
    def codegen(self) -> Any:
        return self  # for the one call below: there is no machine code that has an environment

    def set_env(self, name: str, environment: Any) -> None:
        pass


class _LinkedCompiler(Compiler):
    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        super().__init__(typing, target, library or _Linked(target.codegen(), "inner"), *rest)


class _Inner(CPUDispatcher):
    """A loop of compiled loops: without machine code, wrappers for Python and an entry of its own."""

    def __call__(self, *arguments: Any) -> Any:
        return self._outer(*arguments)

    @cached_property
    def _outer(self) -> Any:
        options = {name: value for name, value in self.targetoptions.items() if name not in _BARE}
        return njit(cache=True, **options)(self.py_func)


def _linked(template: Any) -> Any:
    return partial(_decorator(template), pipeline_class=_LinkedCompiler, no_cfunc_wrapper=True)


_OverloadFunctionTemplate._get_jit_decorator = _linked  # type: ignore[method-assign]


def _raise_of_shapes(src_shapes: Any, index_shape: Any) -> None:
    """Raise without writing the two shapes out: to compile that takes each loop two CPU seconds."""
    raise NotImplementedError


overload(_raise_of_shapes)(arrayobj.ol_raise_with_shape_context_generic)
arrayobj.raise_with_shape_context = _raise_of_shapes


def inner(**options: Any) -> Callable[[Loop], Loop]:
    """Compile a loop into those that call it, with options of `njit`; called from Python, once more."""

    def compiled(function: Loop) -> Loop:
        return cast(
            Loop, _Inner(function, targetoptions={**_BARE, **options}, pipeline_class=_LinkedCompiler)
        )

    return compiled
