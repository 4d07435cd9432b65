"""The base of all errors of the service, and the two that anything may raise."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar

# One thing wrong with an input.


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


EXIT_FAILED = 1
EXIT_BAD_INPUT = 2
EXIT_WARNINGS = 3
EXIT_UNREACHABLE = 4
EXIT_UNEXPECTED = 5
EXIT_INTERRUPTED = 130
OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"


def last_part(problem_type: str) -> str:
    """Return the last part of the URI of a problem type."""
    return re.split("[:/]", problem_type)[-1]


class ServiceError(Exception):
    """Anything the service, its client or its command line raises on purpose."""

    status: ClassVar[int] = 500
    type: ClassVar[str] = "urn:lineofaction:problem:unexpected"
    title: ClassVar[str] = "Unexpected failure"
    exit_code: ClassVar[int] = EXIT_UNEXPECTED
    challenge: str | None = None
    accept_post: str | None = None
    faults: tuple[Fault, ...] = ()
    retry_after_s: int | None = None

    @property
    def kind(self) -> str:
        """Last part of the problem type, by which it is counted and logged."""
        return last_part(self.type)

    def as_json(self) -> dict[str, Any]:
        """Return the problem details object of RFC 9457."""
        return {
            "type": self.type,
            "title": self.title,
            "status": self.status,
            "detail": str(self).encode("utf-8", "replace").decode(),
            "errors": [fault.as_json() for fault in self.faults],
        }


class BadInput(ServiceError):
    """The caller's input cannot be used."""

    status = 422
    type = "urn:lineofaction:problem:bad-input"
    title = "The input cannot be used"
    exit_code = EXIT_BAD_INPUT

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("; ".join(str(fault) for fault in self.faults))

    @classmethod
    def of(cls, field: str, value: object, bound: str, suggestion: str = "") -> BadInput:
        """Return the error of a single fault."""
        return cls([Fault(field, value, bound, suggestion)])

    def within(self, prefix: str) -> BadInput:
        """Return the same error with its fields named inside `prefix`."""
        return BadInput(replace(fault, field=f"{prefix}.{fault.field}") for fault in self.faults)


class Unexpected(ServiceError):
    """A defect: the log holds the details under the reference."""

    def __init__(self, reference: str) -> None:
        self.reference = reference
        super().__init__(f"An unexpected failure occurred. The log has the details under {reference}.")

    def as_json(self) -> dict[str, Any]:
        """Return the problem with its reference number."""
        return {**super().as_json(), "reference": self.reference}
