"""The error of a value that cannot be used."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Self

import numpy as np

from bounds.reader import Reader
from bounds.text import Text, Words


class RefusedValue(Exception):
    """A value the caller gave cannot be used.

    Its numbers are in SI. As text it speaks to a caller from Python, by `worded` to any `Reader`.

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

    def __init__(self, field: str, value: object, bound: Words, suggestion: Words = "") -> None:
        value = value.item() if isinstance(value, np.generic) else value  # a number, to whoever reads it
        self.field, self.value = field, value
        self.bound = Text.of(bound) if isinstance(bound, str) else bound
        self.suggestion = suggestion if isinstance(suggestion, Text) else Text.of(suggestion)
        super().__init__(self.worded(Reader()))

    def worded(self, reader: Reader) -> str:
        """Return field, value, bound and suggestion as one text for a reader."""
        there = reader.at(self.field)
        text = f"{there.name} = {there.shown(self.value)!r}: must be {self.bound.worded(there)}"
        suggestion = self.suggestion.worded(there).strip()
        return f"{text}. {suggestion}" if suggestion else text

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle by the four facts, so that the error crosses process boundaries whole."""
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
