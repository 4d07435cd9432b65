"""Checks of single values, each raising one clear error."""

from __future__ import annotations

import math
from collections.abc import Collection, Hashable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import cache
from typing import Any, Self, cast

import numpy as np

from bounds.bound import Bound, Choice, above, at_least, from_to, one_of
from bounds.declared import declarations
from bounds.text import Reader, Text, Wording
from bounds.types import FloatArray


class RefusedValue(Exception):
    """A value the caller gave cannot be used.

    Its numbers are in SI. Its message is for a caller from Python; `worded` writes it for any `Reader`.

    Parameters
    ----------
    field : str
        Dotted name of the field, e.g. ``"pinion.teeth"``.
    value : object
        What was given, in SI.
    bound : Bound, Choice, Text or str
        What would be accepted, e.g. ``above(0.0)``; a str holds no number that has a unit.
    suggestion : Text, SiNote or str
        What to try.
    """

    def __init__(self, field: str, value: object, bound: Wording, suggestion: Wording = "") -> None:
        value = value.item() if isinstance(value, np.generic) else value  # a number, to whoever reads it
        self.field, self.value = field, value
        self.bound = Text.of(bound) if isinstance(bound, str) else bound  # ranges and choices word themselves
        self.suggestion = suggestion if isinstance(suggestion, Text) else Text.of(suggestion)
        super().__init__(self.worded(Reader()))

    def worded(self, reader: Reader) -> str:
        """Return field, value, bound and suggestion as one text for a reader."""
        field_reader = reader.at(self.field)
        value, bound = field_reader.field_value(self.value), self.bound.worded(field_reader)
        text = f"{field_reader.name} = {value!r}: must be {bound}"
        suggestion = self.suggestion.worded(field_reader).strip()
        return f"{text}. {suggestion}" if suggestion else text

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle the four arguments, so that the error crosses process boundaries whole."""
        return type(self), (self.field, self.value, self.bound, self.suggestion)

    def within(self, prefix: str) -> Self:
        """Return the same error with its field named inside `prefix`."""
        return type(self)(f"{prefix}.{self.field}", self.value, self.bound, self.suggestion)


@contextmanager
def inside(part: str) -> Iterator[None]:
    """Name the field of a value that is refused inside `part`."""
    try:
        yield
    except RefusedValue as error:
        raise error.within(part) from None


@cache
def _optional_fields(kind: Any) -> frozenset[str]:
    """Return the fields of a dataclass whose default is None."""
    return frozenset(entry.name for entry in fields(kind) if entry.default is None)


@dataclass(frozen=True)
class Checks:
    """The checks of a library.

    Every one takes the name of the field, the value in SI and what to try if it is refused. `refused`: the
    library's error of a value that is refused.
    """

    refused: type[RefusedValue]

    def finite(self, field: str, value: float, suggestion: Wording = "") -> float:
        """Return `value` as a float if it is a finite number."""
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float | np.number)
            or not math.isfinite(value)
        ):
            raise self.refused(field, value, "a finite number", suggestion)
        return float(value)

    def in_bound(self, field: str, value: float, bound: Bound, suggestion: Wording = "") -> float:
        """Return `value` as a float if it is a finite number that meets `bound`."""
        number = self.finite(field, value, suggestion)
        if not bound.holds(number):
            raise self.refused(field, value, bound, suggestion)
        return number

    def within(self, field: str, value: float, low: float, high: float, suggestion: Wording = "") -> float:
        """Return `value` if low <= value <= high, but for rounding."""
        return self.in_bound(field, value, from_to(low, high), suggestion)

    def positive(self, field: str, value: float, suggestion: Wording = "") -> float:
        """Return `value` if it is finite and above zero."""
        return self.in_bound(field, value, above(0.0), suggestion)

    def not_negative(self, field: str, value: float, suggestion: Wording = "") -> float:
        """Return `value` if it is finite and zero or above."""
        return self.in_bound(field, value, at_least(0.0), suggestion)

    def integer(self, field: str, value: int, low: int, high: int, suggestion: Wording = "") -> int:
        """Return `value` if it is an integer from `low` to `high`."""
        if isinstance(value, bool) or not isinstance(value, int | np.integer) or not low <= value <= high:
            raise self.refused(field, value, Bound(low, high, integer=True), suggestion)
        return int(value)

    def one_of(self, field: str, value: str, names: Collection[str], suggestion: Wording = "") -> str:
        """Return `value` if it is one of `names`."""
        if value not in names:
            raise self.refused(field, value, one_of(names), suggestion)
        return value

    def chosen(
        self, field: str, names: Sequence[str] | None, known: Sequence[str], suggestion: Wording = ""
    ) -> list[str]:
        """Return the `known` names that are in `names`, in the order of `known`; all if None."""
        for name in names or ():
            self.one_of(field, name, known, suggestion)
        return [name for name in known if names is None or name in names]

    def declared_fields(self, thing: Any, beyond: Collection[str] = ()) -> None:
        """Check each declared field of a dataclass against its limits.

        An optional field that is None passes, and one in `beyond` passes if it is finite.
        """
        optional = _optional_fields(cast("Hashable", type(thing)))
        for field, declaration in declarations(type(thing)).items():
            value = getattr(thing, field)
            if value is None and field in optional:
                continue
            limits = declaration.limits
            if field in beyond:
                self.finite(field, value)
            elif isinstance(limits, Choice):
                self.one_of(field, value, limits.names)
            elif limits is not None and limits.integer:
                self.integer(field, value, int(limits.low or 0), int(limits.high or 0))
            elif limits is not None:
                remedy = declaration.remedy if declaration.unit else ""  # an example in the unit
                self.in_bound(field, value, limits, remedy)

    def increasing(
        self, field: str, values: Sequence[float] | FloatArray, suggestion: Wording = ""
    ) -> FloatArray:
        """Return `values` as a 1-D array if it is non-empty, finite and strictly increasing."""
        array = np.atleast_1d(np.asarray(values, dtype=float))
        if array.ndim != 1 or array.size == 0 or not np.all(np.isfinite(array)):
            raise self.refused(field, values, "a non-empty list of finite numbers", suggestion)
        if np.any(np.diff(array) <= 0.0):
            remedy = suggestion or "Sort the list and drop repeats."
            raise self.refused(field, values, "strictly increasing", remedy)
        return array
