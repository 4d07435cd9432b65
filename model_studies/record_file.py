"""Dataclasses as netCDF-4 files by their fields: arrays and floats are variables, the rest is JSON.

A tuple of records is a row. A number that every record of a row has is one variable, whose first dimension
has the name of the row. If ``effects`` is a row of records, each with a record ``with_effect``, whose field
``mean`` is an array over loads, then the variable is ``effects.with_effect.mean (effects, load)``.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, fields, is_dataclass, replace
from enum import Enum
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from model_studies.array_file import Stored, arrays_content, read_arrays
from model_studies.netcdf import DAMAGE, UnreadableFile
from model_studies.netcdf_content import NetcdfContent
from model_studies.record import key_of

IN_VARIABLE = "variable"
"""Mark in the JSON for a value that is stored in a variable."""
_UNITS = {"n": "N", "n_m": "N m", "pa": "Pa"}


@dataclass(frozen=True)
class _FieldVariable:
    """The variable of a field: its name, unit, dimensions, and the row of records that it runs along."""

    name: str = ""
    unit: str = "1"
    dimensions: tuple[str, ...] = ()
    row: str = ""

    def of(self, field: Field[Any]) -> _FieldVariable:
        """Return the variable of a field, if this one stands for the record that has the field."""
        name = f"{self.name}.{key_of(field)}" if self.name else key_of(field)
        unit = field.metadata.get("unit", "1")
        return _FieldVariable(name, _UNITS.get(unit, unit), field.metadata.get("dimensions", ()), self.row)

    @property
    def in_row(self) -> _FieldVariable:
        """The variable of the entries, if this one stands for a tuple: they are a row."""
        return replace(self, row=self.name)

    def stored(self, rank: int) -> Stored:
        """Return how an array of `rank` dimensions is stored."""
        row = (self.row,) if self.row else ()
        along = self.dimensions or tuple(f"{self.name}_{axis}" for axis in range(rank - len(row)))
        return Stored((*row, *along), self.unit, self.name.replace(".", " ").replace("_", " "))


def write_record(record: Any, path: Path, schema: str) -> None:
    """Write the file of `record_content`; it appears whole or not at all."""
    record_content(record, schema).write(path)


def record_content(record: Any, schema: str) -> NetcdfContent:
    """Return the content of the file of a dataclass.

    A field whose metadata are `model_studies.record.NOT_STORED` is left out.
    """
    columns: dict[_FieldVariable, list[Any]] = {}
    rest = _split(type(record), record, _FieldVariable(), columns)
    arrays = {variable: np.stack(rows) if variable.row else rows[0] for variable, rows in columns.items()}
    return arrays_content(
        schema,
        {variable.name: variable.stored(values.ndim) for variable, values in arrays.items()},
        {variable.name: values for variable, values in arrays.items()},
        rest,
    )


def read_record(path: Path, kinds: Mapping[str, type]) -> Any:
    """Return the content of a record that `write_record` wrote; `kinds` are dataclasses by their schemas.

    A field that has a default may be missing, in files of versions that did not know it.

    Raises `UnreadableFile`: the file is missing, no netCDF-4, of none of these schemas, damaged, or of other
    fields.
    """
    schema, arrays, rest = read_arrays(path, tuple(kinds))
    columns: dict[str, Iterator[Any]] = {}

    def next_entry(variable: _FieldVariable) -> Any:
        """Return the next value of a row from its variable; a variable outside rows has one value."""
        if variable.name not in columns:
            values = arrays[variable.name]
            columns[variable.name] = iter(values if variable.row else [values])
        return next(columns[variable.name])

    try:
        return _rebuilt(kinds[schema], rest, _FieldVariable(), next_entry)
    except (*DAMAGE, StopIteration) as error:
        raise UnreadableFile(f"{path.name}: not as this version writes it") from error


def _split(kind: Any, value: Any, variable: _FieldVariable, columns: dict[_FieldVariable, list[Any]]) -> Any:
    """Put the numbers of a value of a type into columns; return the rest as JSON."""
    kind = _present(kind)
    if value is None:
        return None
    if is_dataclass(kind):
        return {
            key_of(field): _split(field_type, getattr(value, field.name), variable.of(field), columns)
            for field, field_type in _stored_fields(kind)
        }
    if get_origin(kind) is tuple:
        return [_split(get_args(kind)[0], entry, variable.in_row, columns) for entry in value]
    if _is_number(kind):
        columns.setdefault(variable, []).append(np.asarray(value))
        return IN_VARIABLE
    if isinstance(value, Enum | np.generic):
        return value.value if isinstance(value, Enum) else value.item()
    return dict(value) if isinstance(value, Mapping) else value


def _rebuilt(kind: Any, plain: Any, variable: _FieldVariable, next_entry: Any) -> Any:
    """Return the value of a type that `_split` took apart; `next_entry` reads from a variable."""
    kind = _present(kind)
    if plain is None:
        return None
    if is_dataclass(kind):
        values = {
            field.name: _rebuilt(field_type, plain[key_of(field)], variable.of(field), next_entry)
            for field, field_type in _stored_fields(kind)
            if key_of(field) in plain or (field.default is MISSING and field.default_factory is MISSING)
        }
        return kind(**values)  # type: ignore[operator]  # is_dataclass says instances are types too
    if get_origin(kind) is tuple:
        return tuple(_rebuilt(get_args(kind)[0], entry, variable.in_row, next_entry) for entry in plain)
    if _is_number(kind):
        value = next_entry(variable)
        return float(value) if kind is float else np.ascontiguousarray(value)
    if isinstance(kind, type) and issubclass(kind, Enum):
        return kind(plain)
    # JSON turns integer keys of a mapping into texts
    by_integer = isinstance(plain, dict) and get_args(kind)[:1] == (int,)
    return {int(key): value for key, value in plain.items()} if by_integer else plain


def _is_number(kind: Any) -> bool:
    """Whether values of a type are in a variable: floats and arrays.

    `numpy.typing.NDArray` is an array's type itself, or from numpy 2.5 on an alias with its own parameters.
    """
    origin = get_origin(kind)
    return kind is float or np.ndarray in (origin, get_origin(getattr(origin, "__value__", None)))


def _present(kind: Any) -> Any:
    """Return the type T of an optional one, "T | None"; any other type as it is."""
    if get_origin(kind) not in (Union, UnionType):
        return kind
    parts = [part for part in get_args(kind) if part is not NoneType]
    return parts[0] if len(parts) == 1 else kind


def _stored_fields(kind: Any) -> list[tuple[Field[Any], Any]]:
    """Return the stored fields of a dataclass with their types.

    Where a base is generic, as ``Base[FloatArray]``, its type variables are replaced by these arguments.
    """
    bound: dict[Any, Any] = {}
    for ancestor in kind.__mro__:
        for base in getattr(ancestor, "__orig_bases__", ()):
            parameters = getattr(get_origin(base), "__parameters__", ())
            bound |= dict(zip(parameters, get_args(base), strict=False))
    hints = get_type_hints(kind)
    stored = [field for field in fields(kind) if field.metadata.get("stored", True)]
    return [(field, _bound(hints[field.name], bound)) for field in stored]


def _bound(hint: Any, bound: Mapping[Any, Any]) -> Any:
    """Return a type with its type variables replaced by what `bound` has for them."""
    if isinstance(hint, TypeVar):
        return bound.get(hint, hint)
    parameters = getattr(hint, "__parameters__", ())
    return hint[tuple(bound.get(parameter, parameter) for parameter in parameters)] if parameters else hint
