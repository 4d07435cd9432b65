"""Routines written out for the tuples they get, as one module of instructions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from inspect import signature, unwrap
from typing import Any, get_args, get_type_hints

from llvmlite import ir

from dynamics.kernels.compiled_routine import Routine
from dynamics.kernels.tuple_addresses import WORD, by_value
from dynamics.structure_code.arithmetic import TYPES, Unsupported, Value
from dynamics.structure_code.arrays import Group
from dynamics.structure_code.known_parts import Known
from dynamics.structure_code.statements import Statements

POINTER = WORD.as_pointer()
MAX_EXPRESSIONS = 150_000
"""Most expressions of a module: beyond them compiling takes longer than runs do."""
FEW_EXPRESSIONS = 500
"""Most expressions of a function that is written once for each set of known numbers although one for any
numbers is possible; the terms of a frame have 300.
"""


class Module:
    """Functions of routines, each for the tuples it is called with.

    Attributes
    ----------
    expressions : int
        Number of expressions read so far; the time of compiling grows with it.
    """

    def __init__(self) -> None:
        self.module = ir.Module("structure")
        self._functions: dict[tuple[Any, ...], Any] = {}
        self._aliases: dict[int, tuple[Any, Any]] = {}
        self._root = self.module.add_metadata(["arrays"])
        self.expressions = 0

    def count(self) -> None:
        """Count an expression; too many are `Unsupported`."""
        self.expressions += 1
        if self.expressions > MAX_EXPRESSIONS:
            raise Unsupported("the structure is too large")

    def alias(self, array: Any) -> Any:
        """Return the metadata that mark accesses of an array; arrays at another address have others."""
        address = array.__array_interface__["data"][0] if array.size else -id(array)
        if address not in self._aliases:
            kind = self.module.add_metadata([str(len(self._aliases)), self._root, WORD(0)])
            self._aliases[address] = self.module.add_metadata([kind, kind, WORD(0)]), array
        return self._aliases[address][0]

    def export(self, function: Any, tuples: Mapping[Any, Known]) -> None:
        """Write a compiled function of `tuples` by address and of floats, which returns a status."""
        python = unwrap(function)
        hints = get_type_hints(python)
        kinds = [TYPES.get(hints[name], POINTER) for name in signature(python).parameters]
        exported = ir.Function(self.module, ir.FunctionType(WORD, kinds), python.__name__)
        groups = (Group(by_value(group), group._numba_type_, None, known) for group, known in tuples.items())
        number = Value(None)
        self._write(python, exported, [next(groups) if kind is POINTER else number for kind in kinds])

    def function(self, routine: Routine, values: Sequence[Any]) -> Any:
        """Return the function of `routine` for these tuples, and for numbers of any value if possible.

        A routine that reads known items by a number is written for the known numbers among `values` instead,
        if it is short or cannot be written otherwise.
        """
        tuples = tuple(id(value.value) for value in values if isinstance(value, Group))
        key: tuple[Any, ...] = (routine.symbol, tuples)
        if key not in self._functions:
            self._functions[key] = self._written(routine, [_anything(value) for value in values])
        if self._functions[key] is None:
            known = tuple(None if isinstance(value, Group | Value) else value for value in values)
            key = *key, known
            if key not in self._functions:
                self._functions[key] = self._written(routine, values)
        return self._functions[key]

    def _written(self, routine: Routine, values: Sequence[Any]) -> Any:
        """Return a new function, or None if it needs numbers that are not known."""
        result = routine.hints["return"]
        parts = [TYPES[part] for part in get_args(result)]
        kind = ir.LiteralStructType(parts) if parts else TYPES.get(result, ir.VoidType())
        kinds = [TYPES.get(hint, POINTER) for hint in routine.arguments]
        function = ir.Function(self.module, ir.FunctionType(kind, kinds), f"own{len(self.module.functions)}")
        function.linkage = "internal"
        return function if self._write(unwrap(routine), function, values) else None

    def _write(self, python: Any, function: Any, values: Sequence[Any]) -> bool:
        """Write `python` for these tuples and numbers; return whether to use it.

        A function for any numbers that could read known items (`lost`) is used only if it is long.
        """
        arguments = [
            replace(value, pointer=argument) if isinstance(value, Group) else _operand(value, argument)
            for value, argument in zip(values, function.args, strict=True)
        ]
        statements, anything = Statements(self, function), any(value is None for value in values)
        before = self.expressions
        try:
            self._end(statements, statements.inline(python, arguments), function.function_type.return_type)
        except Unsupported:
            function.blocks.clear()
            function.linkage = ""  # external, as a declaration has to be; no code calls it
            if not (statements.lost and anything):
                raise
            before = self.expressions
        return not (statements.lost and anything) or self.expressions - before > FEW_EXPRESSIONS

    def _end(self, statements: Statements, result: Any, kind: Any) -> None:
        if kind == ir.VoidType():
            statements.b.ret_void()
        elif isinstance(kind, ir.LiteralStructType):
            made: Any = ir.Constant(kind, ir.Undefined)
            for k, part in enumerate(kind.elements):
                made = statements.b.insert_value(made, statements.cast(result[k], part), k)
            statements.b.ret(made)
        else:
            statements.b.ret(statements.cast(result, kind))
        statements.finish()


def _anything(value: Any) -> Any:
    """Return a tuple as it is, None for a number of any value."""
    return value if isinstance(value, Group) else None


def _operand(value: Any, argument: Any) -> Any:
    return Value(argument) if value is None or isinstance(value, Value) else value
