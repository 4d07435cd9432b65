"""The errors of the boundary, in one tree and one shape.

Each carries the HTTP status, the problem type (RFC 9457), a title and the exit code of the command line. What
does more than that, or has kinds below it, is a class; the others are rows of the table at the end.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self, TypeVar

EXIT_FAILED = 1
EXIT_BAD_INPUT = 2
EXIT_WARNINGS = 3
EXIT_UNREACHABLE = 4
EXIT_UNEXPECTED = 5
EXIT_INTERRUPTED = 130
_OURS = "urn:lineofaction:problem:"
_OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"
_LONGEST_VALUE = 200


@dataclass(frozen=True)
class Fault:
    """One thing wrong with the input."""

    field: str
    """Dotted name as the user wrote it, e.g. ``"pair.pinion.teeth"``."""
    value: object
    """Value of the input; None if the input has none."""
    bound: str
    """Description of the accepted values, to be read after "must be"."""
    suggestion: str = ""
    """Sentence on a remedy."""
    location: str = dataclasses.field(default="", compare=False)
    """File and line of the input, where they are known, else empty. Faults that differ in it alone are equal.
    """

    def __str__(self) -> str:
        text = f"{self.field} = {_value_text(self.value)}: must be {self.bound}"
        parts = (text, self.suggestion) if self.suggestion else (text,)
        return ". ".join(parts) + (f" ({self.location})" if self.location else "")

    def as_json(self) -> dict[str, Any]:
        """Return the four facts as plain JSON; a value that JSON cannot hold is shown as text."""
        return {
            "field": self.field,
            "value": _plain(self.value),
            "bound": self.bound,
            "suggestion": self.suggestion,
        }


def _value_text(value: object) -> str:
    if value is None:
        return "nothing"
    text = ""
    for piece in _pieces(value):
        text += piece
        if len(text) > _LONGEST_VALUE:
            return f"{text[:_LONGEST_VALUE]}..."
    return text


def _pieces(value: object) -> Iterator[str]:
    """Yield the text of `repr` piece by piece, so that of a long list only the shown part is written."""
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
    return _value_text(value).encode("utf-8", "replace").decode()


def last_part(problem_type: str) -> str:
    """Return the last part of the URI of a problem type."""
    return re.split("[:/]", problem_type)[-1]


class ServiceError(Exception):
    """Anything the service, its client or its command line raises on purpose."""

    status: ClassVar[int] = 500
    type: ClassVar[str] = f"{_OURS}unexpected"
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


class _Failed(ServiceError):
    exit_code = EXIT_FAILED


class _Refused(ServiceError):
    exit_code = EXIT_BAD_INPUT


class _Away(ServiceError):
    exit_code = EXIT_UNREACHABLE


class BadInput(_Refused):
    """The caller's input cannot be used."""

    status = 422
    type = f"{_OURS}bad-input"
    title = "The input cannot be used"

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


class TryLater(_Failed):
    """Too much at once; the same request may be sent again after a while."""

    status = 429

    @classmethod
    def after(cls, seconds: int, message: str) -> Self:
        """Return the error of a request that is possible again after a number of seconds."""
        error = cls(message)
        error.retry_after_s = seconds
        return error


class QueueFull(TryLater):
    """The queue is at its limit."""

    type = f"{_OURS}queue-full"
    title = "The queue is full"
    retry_after_s = 10


class NotAnalyzed(_Failed):
    """The service lacks what a live question is answered from."""

    status = 409
    type = f"{_OURS}not-analysed"
    title = "The pair has to be analyzed first"


class Unauthorised(_Refused):
    """The request carries no key, or one that is not good (RFC 6750, section 3)."""

    status = 401
    type = f"{_OURS}unauthorised"
    title = "A key is needed"
    challenge = "Bearer"

    @classmethod
    def of(cls, message: str) -> Self:
        """Return the error of a key that is not good."""
        error = cls(message)
        error.challenge = 'Bearer error="invalid_token"'
        return error


class MissingScope(_Refused):
    """The request carries a key that may do other things, not this one."""

    status = 403
    type = f"{_OURS}missing-scope"
    title = "The key lacks a scope"

    @classmethod
    def of(cls, name: str, scope: str, scopes: Iterable[str]) -> Self:
        """Return the error of a key of this name, which has other scopes."""
        has = ", ".join(scopes) or "none"
        error = cls(f"This needs the scope {scope}; key {name!r} has {has}. Ask the operator of the service.")
        error.challenge = f'Bearer error="insufficient_scope", scope="{scope}"'
        return error


class NotFound(_Refused):
    """The named process, job or result does not exist."""

    status = 404
    type = f"{_OURS}not-found"
    title = "Not found"


class UnsupportedMediaType(_Refused):
    """The request body is of a type that is not read here."""

    status = 415
    type = f"{_OURS}unsupported-media-type"
    title = "The type of the body is not known here"

    @classmethod
    def of(cls, sent: str, *read: str) -> UnsupportedMediaType:
        """Return the error of a body of the type `sent`, where the types `read` are."""
        headers = " or ".join(f"Content-Type: {kind}" for kind in read)
        error = cls(f"The body is {sent or 'of no stated type'}. Send it with the header {headers}.")
        error.accept_post = ", ".join(read)
        return error


class JobFailed(_Failed):
    """The job ended without a result: mesh, solve, worker or deadline."""

    status = 500
    type = f"{_OURS}job-failed"
    title = "The job failed"

    def __init__(self, message: str, faults: Iterable[Fault] = ()) -> None:
        super().__init__(message)
        self.faults = tuple(faults)


class StillRunning(_Failed, TimeoutError):
    """The job did not end in the time it was waited for; it goes on."""

    status = 504
    type = f"{_OURS}still-running"
    title = "The job has not ended yet"


class DatabaseUnavailable(_Away):
    """The database of the service does not answer."""

    status = 503
    type = f"{_OURS}database-unavailable"
    title = "The database cannot be reached"
    retry_after_s: int | None = 5


class _Outage(DatabaseUnavailable):
    exit_code = EXIT_FAILED


class Unreachable(_Away):
    """The address answers with no service."""

    status = 503
    type = f"{_OURS}unreachable"
    title = "The service cannot be reached"


Kind = TypeVar("Kind", bound=ServiceError)


def _row(
    base: type[Kind],
    status: int,
    name: str,
    title: str,
    retry_after_s: int | None = None,
    home: str = _OURS,
) -> type[Kind]:
    """Return a class of no more than a title, an HTTP status, and seconds after which to try again."""
    members = {"status": status, "type": f"{home}{name}", "title": title, "retry_after_s": retry_after_s}
    names = {"__module__": __name__, "__doc__": f"{title}."}
    kind: type[Kind] = type(name.title().replace("-", ""), (base,), members | names)
    return kind


RateExceeded = _row(TryLater, 429, "rate-exceeded", "Too many requests with this key", 1)
TooManyHeld = _row(TryLater, 429, "too-many-held", "Too much at the same time with this key", 1)
TooManyRequests = _row(TryLater, 503, "too-many-requests", "Too many requests at once", 1)
IssuerUnavailable = _row(TryLater, 503, "issuer-unavailable", "The issuer of tokens does not answer", 10)
Superseded = _row(_Failed, 409, "superseded", "A later question took its place")
JobDismissed = _row(_Failed, 410, "job-dismissed", "The job was cancelled")
DamagedFile = _row(_Failed, 500, "damaged-file", "A stored file is damaged")
LiveUnavailable = _row(_Failed, 503, "live-unavailable", "No live answer", 1)
NoSuchProcess = _row(NotFound, 404, "no-such-process", "No such process", home=_OGC)
NoSuchJob = _row(NotFound, 404, "no-such-job", "No such job", home=_OGC)
ResultNotReady = _row(NotFound, 404, "result-not-ready", "The result is not ready", home=_OGC)
TooLarge = _row(_Refused, 413, "too-large", "The request is too large")
Malformed = _row(_Refused, 400, "malformed", "The request is not HTTP")
KeyExpired = _row(Unauthorised, 401, "key-expired", "The key has expired")
NotAcceptable = _row(_Refused, 406, "not-acceptable", "No acceptable type of answer")
NotForUs = _row(_Refused, 421, "not-for-us", "The request is meant for another machine")
HeadTooLarge = _row(_Refused, 431, "head-too-large", "The head of the request is too large")
Busy = _row(DatabaseUnavailable, 503, "busy", "The service is busy", 2)
TooSlow = _row(_Away, 408, "too-slow", "The request is too slow")
StoreUnavailable = _row(_Away, 503, "store-unavailable", "The store of results cannot be reached", 5)
DatabaseDamaged = _row(_Outage, 503, "database-damaged", "The database cannot be used")
NoSpace = _row(_Outage, 503, "no-space", "There is no space left")
OutOfFiles = _row(_Outage, 503, "out-of-files", "Too many files are open", 5)
