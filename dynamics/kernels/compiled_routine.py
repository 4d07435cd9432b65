"""Routines: compiled functions that compiled functions call through their address.

What an ordinary compiled function calls becomes part of it, and is compiled anew with every caller. A routine
is compiled once, when it is prepared, and found through a slot that holds its address: for what is large and
called from several functions, and for what most runs never call.
"""

# numba annotates little of what extends it
# mypy: disable-error-code="no-untyped-call, untyped-decorator, attr-defined, override, misc, unused-ignore"

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cached_property, update_wrapper
from typing import Any, get_args, get_type_hints

import llvmlite.binding
import numpy as np
from numba.core import cgutils, types
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature

from dynamics.kernels.compiled import compiled
from dynamics.kernels.tuple_addresses import SCALARS, WORD, by_address

NOT_PREPARED = "a compiled routine was called before it was prepared"


class Routine:
    """A compiled function of named tuples and numbers, and the slot with its address.

    Its annotations are the types of its arguments and of its result, which is a number, several or none.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        update_wrapper(self, function)
        self._function = function
        self._dispatcher = compiled(function)
        self._slot = np.zeros(1, dtype=np.int64)
        self.symbol = f"{function.__module__}.{function.__qualname__}"
        llvmlite.binding.add_symbol(self.symbol, self._slot.ctypes.data)
        # what numba needs in compiled callers: the types of a call, and its instructions
        infer_global(self, types.Function(_typing(self)))
        lower_builtin(self, types.VarArg(types.Any))(_lowering(self))

    @property
    def prepared(self) -> bool:
        """Whether there is code at its address."""
        return bool(self._slot[0])

    def prepare(self, *tuples: Any) -> None:
        """Compile the routine or read it from the cache, once.

        `tuples` are examples of the tuples that it takes, in their order: they have the same layout.
        """
        if self.prepared:
            return
        values = iter(tuples)
        hints = self.arguments
        kinds = tuple(SCALARS.get(hint) or by_address(next(values))._numba_type_ for hint in hints)
        self._dispatcher.compile(kinds)
        overload = self._dispatcher.overloads[kinds]
        self._slot[0] = overload.library.get_pointer_to_function(overload.fndesc.llvm_func_name)

    def __call__(self, *arguments: Any) -> Any:
        """Call it from Python."""
        return self._dispatcher(*arguments)

    def typed(self, values: tuple[Any, ...]) -> Any:
        """Return the compiled signature: numbers as annotated, tuples as given."""
        kinds = (SCALARS.get(hint, kind) for hint, kind in zip(self.arguments, values, strict=True))
        return signature(self._result, *kinds)

    @cached_property
    def hints(self) -> dict[str, Any]:
        """Types of arguments and result by name."""
        return get_type_hints(self._function)

    @cached_property
    def arguments(self) -> list[Any]:
        """Types of the arguments in their order."""
        return [self.hints[name] for name in inspect.signature(self._function).parameters]

    @property
    def _result(self) -> Any:
        hint = self.hints["return"]
        if parts := get_args(hint):
            return types.UniTuple(SCALARS[parts[0]], len(parts))
        return types.none if hint is type(None) else SCALARS[hint]


def _typing(routine: Routine) -> type:
    class Call(AbstractTemplate):
        key = routine

        def generic(self, args: Any, kws: Any) -> Any:
            return routine.typed(args)

    return Call


def _lowering(routine: Routine) -> Callable[..., Any]:
    def call(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        convention = context.call_conv
        slot = builder.module.globals.get(routine.symbol)  # the module has it after the first call
        slot = slot or cgutils.add_global_variable(builder.module, WORD, routine.symbol)
        address = builder.load(slot)
        with cgutils.if_unlikely(builder, builder.icmp_unsigned("==", address, WORD(0))):
            convention.return_user_exc(builder, RuntimeError, (NOT_PREPARED,))
        pointer = convention.get_function_type(sig.return_type, sig.args).as_pointer()
        function = builder.inttoptr(address, pointer)
        status, result = convention.call_function(builder, function, sig.return_type, sig.args, args)
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return result

    return call
