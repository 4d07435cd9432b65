"""Inner loops that are linked into those that call them, and optimized there alone.

numba optimizes each loop, makes machine code of it and wraps it for Python, and does so again in every loop
that calls it. An inner loop is linked as it is: what Python calls is optimized once, with all that it calls.
So is what numba itself writes in Python, as `np.zeros`. This rests on internals of numba; `LOA_PLAIN_LOOPS`
takes numba as it is.
"""

# mypy: disable-error-code="no-untyped-call"
from __future__ import annotations

from functools import partial
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.typing.templates import _OverloadFunctionTemplate
from numba.extending import overload
from numba.np import arrayobj

_decorator = _OverloadFunctionTemplate._get_jit_decorator


class _Linked(JITCodeLibrary):
    """Unoptimized code of a loop for linking; machine code is made only of the loop that links it."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def _optimize_final_module(self) -> None:
        pass

    def get_pointer_to_function(self, name: str) -> int:
        return 0  # no machine code

    @property
    def codegen(self) -> Any:
        return self  # for the one call below: there is no machine code that has an environment

    def set_env(self, name: str, environment: Any) -> None:
        pass


class LinkedCompiler(Compiler):
    """The compiler of a loop that others link."""

    def __init__(self, typing: Any, target: Any, library: Any, *rest: Any) -> None:
        super().__init__(typing, target, library or _Linked(target.codegen(), "inner"), *rest)


def _linked(template: Any) -> Any:
    return partial(_decorator(template), pipeline_class=LinkedCompiler, no_cfunc_wrapper=True)


def _raise_of_shapes(src_shapes: Any, index_shape: Any) -> None:
    """Raise without writing the two shapes out: to compile that takes each loop two CPU seconds."""
    raise NotImplementedError


def link_what_numba_writes() -> None:
    """Link numba's own functions in Python as inner loops are, and shorten its messages on shapes."""
    _OverloadFunctionTemplate._get_jit_decorator = _linked  # type: ignore[method-assign]
    overload(_raise_of_shapes)(arrayobj.ol_raise_with_shape_context_generic)
    arrayobj.raise_with_shape_context = _raise_of_shapes
