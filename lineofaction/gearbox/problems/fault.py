"""One thing wrong with an input."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

_LONGEST_VALUE = 200


@dataclass(frozen=True)
class Fault:
    """One thing wrong with the input.

    Attributes
    ----------
    field : str
        Dotted name as the user wrote it, e.g. ``"pair.pinion.teeth"``.
    value : object
        What was given; None if nothing was.
    bound : str
        What would be accepted, to be read after "must be".
    suggestion : str
        What to try.
    place : str
        File and line, for those who wrote one; empty where none is known. It makes no other fault of it.
    """

    field: str
    value: object
    bound: str
    suggestion: str = ""
    place: str = dataclasses.field(default="", compare=False)

    def __str__(self) -> str:
        text = f"{self.field} = {_shown(self.value)}: must be {self.bound}"
        parts = (text, self.suggestion) if self.suggestion else (text,)
        return ". ".join(parts) + (f" ({self.place})" if self.place else "")

    def as_json(self) -> dict[str, Any]:
        """Return the four facts as plain JSON; a value that JSON cannot hold is shown as text."""
        return {
            "field": self.field,
            "value": _plain(self.value),
            "bound": self.bound,
            "suggestion": self.suggestion,
        }


def _shown(value: object) -> str:
    """Value as a short text."""
    if value is None:
        return "nothing"
    text = ""
    for piece in _pieces(value):
        text += piece
        if len(text) > _LONGEST_VALUE:
            return f"{text[:_LONGEST_VALUE]}..."
    return text


def _pieces(value: object) -> Iterator[str]:
    """Yield what `repr` would write, piece by piece, so that no more of a long list is written than shown."""
    if type(value) is list:
        yield "["
        for index, item in enumerate(value):
            yield ", " if index else ""
            yield from _pieces(item)
        yield "]"
    elif type(value) is dict:
        yield "{"
        for index, (name, item) in enumerate(value.items()):
            yield f", {name!r}: " if index else f"{name!r}: "
            yield from _pieces(item)
        yield "}"
    else:
        yield repr(value)


def _plain(value: object) -> object:
    """Value as JSON can hold it: short, finite, printable."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, int) and abs(value) < 2**53:
        return value
    if isinstance(value, float) and math.isfinite(value):
        return value
    if isinstance(value, str):
        return value[:_LONGEST_VALUE].encode("utf-8", "replace").decode()
    return _shown(value).encode("utf-8", "replace").decode()
