"""Named tuples of arrays handed to compiled functions by address.

numba passes a tuple by value: address, length and stride of every array in it. A system and its workspace
hold a hundred arrays, so each call copied a thousand values, or, with all calls inlined to save the copies,
compiled a thousand values through every function. By address a call passes one pointer, and a function loads
what it reads. Attributes work alike on the tuple and on its address, in Python and compiled.

At the address lie 64-bit *words*, field by field: of an array its address and its lengths, of a number its
bits, of an inner tuple its words. A *kind* describes a field: (type character, dimensions) of an array, an
`_AddressType` of a tuple, or the Python type of a number. The *structure* of a run is what compiled code may
take as constant.
"""

# numba annotates little of what extends it
# mypy: disable-error-code="no-untyped-call, untyped-decorator, attr-defined, override, misc, unused-ignore"

from __future__ import annotations

import hashlib
from collections.abc import Callable
from ctypes import addressof, c_char
from itertools import accumulate
from numbers import Integral
from typing import Any, TypeVar, cast

import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.typing.templates import AttributeTemplate
from numba.extending import NativeValue, infer_getattr, lower_getattr_generic, models, register_model, unbox
from numba.np.arrayobj import make_array, populate_array

WORD = ir.IntType(64)
SCALARS = {bool: types.boolean, int: types.int64, float: types.float64}
"""Compiled types of numbers."""
ITEMS = {"d": types.float64, "l": types.int64, "q": types.int64, "?": types.boolean}
"""Compiled types of the items of arrays, by numpy's type character; "l" or "q" depends on the platform."""

Tuple = TypeVar("Tuple")
TupleClass = TypeVar("TupleClass", bound=type)


_numbers: dict[type, frozenset[str]] = {}
"""Names given by `with_numbers`, by class."""
_NO_BYTES = c_char * 0
"""A buffer without length, which only has an address."""
_seen: dict[type, tuple[list[Any], _AddressType]] = {}
"""Kinds of the fields and compiled type of each class, from its first tuple."""


def with_numbers(*names: str) -> Callable[[TupleClass], TupleClass]:
    """Return a decorator that names the arrays of integers of a class that differ within one structure."""

    def decorated(cls: TupleClass) -> TupleClass:
        _numbers[cls] = frozenset(names)
        return cls

    return decorated


class _AddressType(types.Type):
    """The compiled type of the address of a tuple.

    `fields` are name, compiled type and first word of each field; `size` is the number of words. `numbers`
    are names of arrays of integers that do not belong to the structure.
    """

    def __init__(
        self, name: str, fields: tuple[tuple[str, Any, int], ...], size: int, numbers: frozenset[str]
    ) -> None:
        digest = hashlib.sha256(repr(fields).encode()).hexdigest()
        super().__init__(f"{name}At{digest[:12]}")  # short: it becomes part of every symbol
        self.fields, self.size, self.numbers = fields, size, numbers

    def find(self, name: str) -> tuple[Any, int] | None:
        """Return type and first word of a field."""
        return next(((kind, first) for field, kind, first in self.fields if field == name), None)


class _Addressed:
    """A named tuple and the words by which compiled functions find its arrays; attributes are the tuple's."""

    def __init__(self, value: Any) -> None:
        self._words: list[int] = []
        self._numba_type_ = _lay_out(value, self._words)  # the attribute in which numba looks for a type
        self._slots = np.array(self._words, dtype=np.int64)
        self._address = _address_of(self._slots)
        self.value = value
        vars(self).update(zip(value._fields, value, strict=True))  # faster than `__getattr__`
        if prepare := getattr(value, "prepare", None):
            prepare(self)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.value, name)

    def __reduce__(self) -> tuple[Any, tuple[Any]]:
        return by_address, (self.value,)  # another process has other addresses


def by_address(value: Tuple) -> Tuple:
    """Return `value`, a named tuple of C-contiguous arrays, numbers and such tuples, for compiled functions.

    Numbers are copied; arrays are shared, so that Python and compiled functions see each other's changes. All
    tuples of a class must have arrays of the same types and dimensions, for which functions are compiled. A
    class that calls routines has a method `prepare`, called with the tuple in each process to which it comes.

    Raises
    ------
    TypeError
        If an array is not C-contiguous, or the class has been seen with another layout.
    """
    return value if isinstance(value, _Addressed) else cast(Tuple, _Addressed(value))


def by_value(value: Tuple) -> Tuple:
    """Return the tuple itself."""
    return cast(Tuple, value.value) if isinstance(value, _Addressed) else value


def _lay_out(value: Any, slots: list[int]) -> _AddressType:
    """Append the words of a tuple to `slots`; return its type."""
    kinds: list[Any] = []
    for field in value:
        if isinstance(field, np.ndarray):
            kinds.append((field.dtype.char, field.ndim))
            slots.append(_address_of(field))
            slots.extend(field.shape)
        elif isinstance(field, _Addressed):
            kinds.append(field._numba_type_)
            slots.extend(field._words)
        elif isinstance(field, tuple):
            kinds.append(_lay_out(field, slots))
        else:
            kinds.append(
                bool if isinstance(field, bool | np.bool_) else int if isinstance(field, Integral) else float
            )
            slots.append(int(np.float64(field).view(np.int64)) if kinds[-1] is float else int(field))
    cls: Any = type(value)
    if cls not in _seen:
        _seen[cls] = kinds, _address_type(cls, kinds)
    known, kind = _seen[cls]
    if known != kinds:
        raise TypeError(f"{_address_type(cls, kinds)} has other arrays than {kind}")
    return kind


def _address_of(array: Any) -> int:
    """Return the address of the first item of an array."""
    try:
        return addressof(_NO_BYTES.from_buffer(array))  # a fifth of the time of `__array_interface__`
    except TypeError:  # for an array that cannot be written, or is not contiguous
        if array.flags.c_contiguous:
            return int(array.__array_interface__["data"][0])
    raise TypeError(f"compiled functions take C-contiguous arrays, not strides of {array.strides}")


def _address_type(cls: Any, kinds: list[Any]) -> _AddressType:
    first = [0, *accumulate(map(_size, kinds))]  # first word of each field, and the end
    fields = zip(cls._fields, map(_field_type, kinds), first[:-1], strict=True)
    return _AddressType(cls.__name__, tuple(fields), first[-1], _numbers.get(cls, frozenset()))


def _size(kind: Any) -> int:
    """Return the number of words of a field."""
    if isinstance(kind, tuple):
        return 1 + int(kind[1])
    return kind.size if isinstance(kind, _AddressType) else 1


def _field_type(kind: Any) -> Any:
    if isinstance(kind, tuple):
        return types.Array(ITEMS[kind[0]], kind[1], "C")
    return kind if isinstance(kind, _AddressType) else SCALARS[kind]


@register_model(_AddressType)
class _AddressModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: _AddressType) -> None:
        super().__init__(manager, kind, WORD.as_pointer())


@unbox(_AddressType)
def _unbox(kind: _AddressType, value: Any, c: Any) -> NativeValue:
    number = c.pyapi.object_getattr_string(value, "_address")
    address = c.builder.inttoptr(c.pyapi.long_as_ulonglong(number), WORD.as_pointer())
    c.pyapi.decref(number)
    return NativeValue(address)


@infer_getattr
class _Fields(AttributeTemplate):
    key = _AddressType

    def generic_resolve(self, kind: _AddressType, name: str) -> Any:
        """Return the type of the field `name`."""
        entry = kind.find(name)
        return None if entry is None else entry[0]


@lower_getattr_generic(_AddressType)
def _read_field(context: Any, builder: Any, kind: _AddressType, address: Any, name: str) -> Any:
    """Return the compiled value of a field: the address of an inner tuple, or the array or number itself."""
    entry = kind.find(name)
    assert entry is not None  # typing has found it
    field, first = entry
    location = builder.gep(address, [WORD(first)])
    if isinstance(field, _AddressType):
        return location
    if isinstance(field, types.Array):
        return _array(context, builder, field, location)
    word = _load(builder, location)
    if field is types.boolean:
        return builder.icmp_unsigned("!=", word, WORD(0))
    return builder.bitcast(word, ir.DoubleType()) if field is types.float64 else word


def _array(context: Any, builder: Any, field: Any, location: Any) -> Any:
    """Return the array whose address and lengths begin at `location`."""
    array = make_array(field)(context, builder)
    item = context.get_data_type(field.dtype)
    data = builder.inttoptr(_load(builder, location), item.as_pointer())
    shape = [_load(builder, builder.gep(location, [WORD(1 + axis)])) for axis in range(field.ndim)]
    size = context.get_abi_sizeof(item)
    strides = [WORD(size)]
    for length in shape[:0:-1]:  # from the last axis to the second: C order
        strides.insert(0, builder.mul(strides[0], length, flags=["nsw"]))
    populate_array(array, data, shape, strides, size, None)
    return array._getvalue()


def _load(builder: Any, location: Any) -> Any:
    """Read a word that never changes, so that the compiler may read it once for a whole loop."""
    word = builder.load(location)
    word.set_metadata("invariant.load", builder.module.add_metadata([]))
    return word
