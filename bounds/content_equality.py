"""Equality of records by their content: arrays by kind, shape and values, NaN equal to NaN."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np


def equal_records(record: object, other: object) -> Any:
    """Return whether two dataclasses of one type have equal fields; the ``==`` of results.

    Measured costs and versions are fields too: a result equals its copies and what its file gives back, not a
    second computation.
    """
    if type(record) is not type(other):
        return NotImplemented
    compared = (field.name for field in fields(record) if field.compare)  # type: ignore[arg-type]
    return all(equal_content(getattr(record, name), getattr(other, name)) for name in compared)


def record_hash(record: object) -> int:
    """Return a hash by the sizes of the arrays of a record; equal records have equal ones."""
    values = (getattr(record, field.name) for field in fields(record))  # type: ignore[arg-type]
    return hash((type(record).__qualname__, *(np.shape(value) for value in values if _is_array(value))))


def equal_content(value: object, other: object) -> bool:
    """Return whether two values of records are equal; tuples equal lists, which they become in files."""
    if value is other:
        return True
    if _is_array(value) or _is_array(other):
        return _equal_arrays(value, other)
    if isinstance(value, tuple | list) and isinstance(other, tuple | list):
        return len(value) == len(other) and all(map(equal_content, value, other))
    if isinstance(value, Mapping) and isinstance(other, Mapping):
        return value.keys() == other.keys() and all(
            equal_content(part, other[name]) for name, part in value.items()
        )
    if is_dataclass(value) and not isinstance(value, type):
        return equal_records(value, other) is True
    nan = value != value and other != other  # noqa: PLR0124 (NaN alone differs from itself)
    return bool(nan or value == other)


def _is_array(value: object) -> bool:
    return isinstance(value, np.ndarray)


def _equal_arrays(value: object, other: object) -> bool:
    if not (isinstance(value, np.ndarray) and isinstance(other, np.ndarray)):
        return False
    if value.dtype != other.dtype or value.shape != other.shape:
        return False
    return bool(np.array_equal(value, other, equal_nan=value.dtype.kind in "fc"))
