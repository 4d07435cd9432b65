"""Tuples by address in loops written out: known parts of their arrays, and code that reads the rest."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from llvmlite import ir

from dynamics.kernels.tuple_addresses import WORD, by_value
from dynamics.structure_code.arithmetic import BYTE, FLOAT, Arithmetic, Unsupported, Value
from dynamics.structure_code.known_parts import Known

ITEMS = {"d": FLOAT, "l": WORD, "q": WORD, "?": BYTE}
LONGEST = 256
"""Dimensions, and arrays of integers, up to which they are part of the structure."""


@dataclass(frozen=True)
class Group:
    """A named tuple at `pointer`; `kind` is its compiled type."""

    value: Any
    kind: Any
    pointer: Any
    known: Known


@dataclass(frozen=True)
class Array:
    """An array of a tuple, or a part of it from item `first` on."""

    data: Callable[[], Any]
    """Returns the operand that points to its items."""
    shape: tuple[Any, ...]
    """Dimensions: integers, and `Value` for those that are not part of the structure."""
    item: Any
    alias: Any
    """Mark by which the compiler tells its accesses from those of other arrays; None: a table of constants.
    """
    content: Any = None
    """Items, where they are known."""
    first: Any = 0


def _known_shape(shape: tuple[int, ...], known: Known) -> tuple[int, ...]:
    """Return the dimensions of an array that are part of the structure; -1: not."""
    first = 1 if known is Known.WIDTHS else 0
    return tuple(length if axis >= first and length <= LONGEST else -1 for axis, length in enumerate(shape))


def _dimensions(array: Array, name: str) -> Any:
    if name == "shape":
        return array.shape
    if name == "size" and len(array.shape) == 1:
        return array.shape[0]
    raise Unsupported(f"{name} of an array")


class ArrayAccess(Arithmetic):
    """Reads fields and items; constant ones are read once, at `entry`."""

    entry: Any
    lost = False
    """Whether known items were read by a number that is not known."""

    def attribute(self, base: Any, name: str) -> Any:
        """Return a field of a tuple, the size of an array, or a name of a module or of a known object."""
        if isinstance(base, Array):
            return _dimensions(base, name)
        if not isinstance(base, Group):
            return getattr(base, name)
        kind, first = base.kind.find(name)
        value = getattr(base.value, name)
        if hasattr(kind, "fields"):
            pointer = self._once(base, name, lambda b: b.gep(base.pointer, [WORD(first)]))
            return Group(by_value(value), kind, pointer, base.known)
        if isinstance(value, np.ndarray):
            return self._array(base, value, name, first)
        if kind.name == "float64":
            word = self._once(base, name, lambda b: self._word(b, base.pointer, first))
            return Value(self.b.bitcast(word, FLOAT))
        return value if base.known is Known.ALL else Value(self._word(self.b, base.pointer, first))

    def _array(self, base: Group, value: Any, name: str, first: int) -> Array:
        item = ITEMS[value.dtype.char]
        shape = tuple(
            Value(self._word(self.b, base.pointer, first + 1 + axis)) if length < 0 else length
            for axis, length in enumerate(_known_shape(value.shape, base.known))
        )

        def data() -> Any:
            def read(b: Any) -> Any:
                return b.inttoptr(self._word(b, base.pointer, first), item.as_pointer())

            return self._once(base, name, read)

        known = base.known is Known.ALL and item is not FLOAT and name not in base.kind.numbers
        return Array(
            data, shape, item, self.module.alias(value), value if known and value.size <= LONGEST else None
        )

    def _once(self, base: Group, name: str, read: Callable[[Any], Any]) -> Any:
        key = id(base.value), name
        if key not in self.read:
            self.read[key] = read(self.entry)
        return self.read[key]

    read: dict[tuple[int, str], Any]

    def _word(self, builder: Any, pointer: Any, at: int) -> Any:
        word = builder.load(builder.gep(pointer, [WORD(at)]))
        word.set_metadata("invariant.load", self.module.module.add_metadata([]))
        return word

    def item(self, base: Any, index: Any) -> Any:
        """Return an item of a tuple or an array, or a row."""
        if isinstance(base, tuple) and isinstance(index, Value):
            self.lost = True
            raise Unsupported("an item of a tuple by a number that is not known")
        if not isinstance(base, Array):
            return base[index]
        index = index if isinstance(index, tuple) else (index,)
        if base.content is not None:
            if not any(isinstance(subscript, Value) for subscript in index):
                content = base.content[index]
                return self._part(base, index, content) if isinstance(content, np.ndarray) else content.item()
            self.lost = True
        if len(index) < len(base.shape):
            return self._part(base, index, None)
        loaded = self.b.load(self.element_pointer(base, index))
        loaded.set_metadata("tbaa", base.alias)
        return Value(self.b.trunc(loaded, ir.IntType(1)) if base.item is BYTE else loaded)

    def _part(self, base: Array, index: tuple[Any, ...], content: Any) -> Array:
        shape = base.shape[len(index) :]
        return Array(base.data, shape, base.item, base.alias, content, self._offset(base, index))

    def _offset(self, array: Array, index: tuple[Any, ...]) -> Any:
        total: Any = 0
        for axis, length in enumerate(array.shape):
            total = self.binary(ast.Mult(), total, length) if axis else total
            if axis < len(index):
                subscript = index[axis]
                if not isinstance(subscript, Value) and subscript < 0:
                    subscript = self.binary(ast.Add(), length, subscript)
                total = self.binary(ast.Add(), total, subscript) if axis else subscript
        return self.binary(ast.Add(), array.first, total)

    def element_pointer(self, array: Array, index: Any) -> Any:
        """Return the operand that points to an item."""
        if array.alias is None:
            raise Unsupported("a table of constants read by a number that is not known")
        index = index if isinstance(index, tuple) else (index,)
        return self.b.gep(array.data(), [self.cast(self._offset(array, index), WORD)], inbounds=True)
