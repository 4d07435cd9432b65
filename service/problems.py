"""What can go wrong at the boundary, in one tree and one shape.

::

    ServiceError
    |- BadInput          the caller's: a list of faults (field, value, bound, suggestion)
    |- Unauthorised      no key, or an unknown one
    |- NotFound          no such process, job, result
    |- ResultNotReady    the job has not ended
    |- StillRunning      the job did not end in the time it was waited for; it goes on
    |- JobFailed         the job ended without a result; says at what
    |- JobDismissed      the job was cancelled
    |- TooLarge          the request body is beyond the limit
    |- TooSlow           the request body does not come
    |- NotForUs          the request names another machine
    |- UnsupportedMediaType, NotAcceptable   a body, or an answer, of a type that is not known here
    |- QueueFull         the queue is at its limit; try again later
    |- RateExceeded      the caller's key asks more often than it may; try again later
    |- Superseded        a later question of the same caller took its place
    |- NotAnalysed       nothing is kept to answer from; submit a job first
    |- LiveUnavailable   the live worker ended or took too long; try again
    |- DatabaseUnavailable  the database does not answer; try again later
    |- StoreUnavailable  the store of results does not answer; try again later
    |- DamagedFile       a file does not hold what its digest says
    |- Unreachable       no service at the address
    `- Unexpected        a defect; carries a reference number, never the text of the exception

Each carries the HTTP status, the problem type (RFC 9457) and the exit code of the command line.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, ClassVar, Self

EXIT_BAD_INPUT = 2
EXIT_FAILED = 3
EXIT_UNREACHABLE = 4
EXIT_UNEXPECTED = 5
EXIT_INTERRUPTED = 130

_LONGEST_VALUE = 200
_OGC = "http://www.opengis.net/def/exceptions/ogcapi-processes-1/1.0/"


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
    """

    field: str
    value: object
    bound: str
    suggestion: str = ""

    def __str__(self) -> str:
        text = f"{self.field} = {_shown(self.value)}: must be {self.bound}"
        return f"{text}. {self.suggestion}" if self.suggestion else text

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
    text = "nothing" if value is None else repr(value)
    return text if len(text) <= _LONGEST_VALUE else f"{text[:_LONGEST_VALUE]}..."


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


class ServiceError(Exception):
    """Anything the service, its client or its command line raises on purpose."""

    status: ClassVar[int] = 500
    type: ClassVar[str] = "urn:lineofaction:problem:unexpected"
    title: ClassVar[str] = "Unexpected failure"
    exit_code: ClassVar[int] = EXIT_UNEXPECTED
    challenge: ClassVar[str | None] = None
    faults: tuple[Fault, ...] = ()
    retry_after_s: int | None = None

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
        return BadInput(Fault(f"{prefix}.{f.field}", f.value, f.bound, f.suggestion) for f in self.faults)


class Unauthorised(ServiceError):
    """The request carries no key, or one that is not known."""

    status = 401
    type = "urn:lineofaction:problem:unauthorised"
    title = "A key is needed"
    exit_code = EXIT_BAD_INPUT
    challenge = "Bearer"


class NotFound(ServiceError):
    """No such process, job or result."""

    status = 404
    type = "urn:lineofaction:problem:not-found"
    title = "Not found"
    exit_code = EXIT_BAD_INPUT


class NoSuchProcess(NotFound):
    """No process of this name."""

    type = f"{_OGC}no-such-process"
    title = "No such process"


class NoSuchJob(NotFound):
    """No job of this identifier."""

    type = f"{_OGC}no-such-job"
    title = "No such job"


class ResultNotReady(NotFound):
    """The job has not ended."""

    type = f"{_OGC}result-not-ready"
    title = "The result is not ready"


class StillRunning(ServiceError, TimeoutError):
    """The job did not end in the time it was waited for; it goes on."""

    status = 504
    type = "urn:lineofaction:problem:still-running"
    title = "The job has not ended yet"
    exit_code = EXIT_FAILED


class JobDismissed(ServiceError):
    """The job was cancelled and has no result."""

    status = 410
    type = "urn:lineofaction:problem:job-dismissed"
    title = "The job was cancelled"
    exit_code = EXIT_FAILED


class JobFailed(ServiceError):
    """The job ended without a result: mesh, solve, worker or deadline."""

    status = 500
    type = "urn:lineofaction:problem:job-failed"
    title = "The job failed"
    exit_code = EXIT_FAILED

    def __init__(self, message: str, faults: Iterable[Fault] = ()) -> None:
        super().__init__(message)
        self.faults = tuple(faults)


class TooLarge(ServiceError):
    """The request body is beyond the limit."""

    status = 413
    type = "urn:lineofaction:problem:too-large"
    title = "The request is too large"
    exit_code = EXIT_BAD_INPUT


class TooSlow(ServiceError):
    """The request body does not come, or drips."""

    status = 408
    type = "urn:lineofaction:problem:too-slow"
    title = "The request is too slow"
    exit_code = EXIT_UNREACHABLE


class NotForUs(ServiceError):
    """The request names another machine in its header Host."""

    status = 421
    type = "urn:lineofaction:problem:not-for-us"
    title = "The request is meant for another machine"
    exit_code = EXIT_BAD_INPUT


class UnsupportedMediaType(ServiceError):
    """The request body is of a type that is not read here."""

    status = 415
    type = "urn:lineofaction:problem:unsupported-media-type"
    title = "The type of the body is not known here"
    exit_code = EXIT_BAD_INPUT


class NotAcceptable(ServiceError):
    """The caller takes none of the types an answer can have."""

    status = 406
    type = "urn:lineofaction:problem:not-acceptable"
    title = "No acceptable type of answer"
    exit_code = EXIT_BAD_INPUT


class TryLater(ServiceError):
    """Too much at once; the same request may be sent again after a while."""

    status = 429
    exit_code = EXIT_FAILED

    @classmethod
    def after(cls, seconds: int, message: str) -> Self:
        """Return the error of what is possible again in so many seconds."""
        error = cls(message)
        error.retry_after_s = seconds
        return error


class QueueFull(TryLater):
    """The queue is at its limit."""

    type = "urn:lineofaction:problem:queue-full"
    title = "The queue is full"
    retry_after_s = 10


class RateExceeded(TryLater):
    """The caller's key asks more often than it may."""

    type = "urn:lineofaction:problem:rate-exceeded"
    title = "Too many requests with this key"
    retry_after_s = 1


class Superseded(ServiceError):
    """A later question of the same caller took the place of this one."""

    status = 409
    type = "urn:lineofaction:problem:superseded"
    title = "A later question took its place"
    exit_code = EXIT_FAILED


class NotAnalysed(ServiceError):
    """There is nothing to answer a live question from."""

    status = 409
    type = "urn:lineofaction:problem:not-analysed"
    title = "The pair has to be analysed first"
    exit_code = EXIT_FAILED


class LiveUnavailable(ServiceError):
    """The live worker ended or took too long."""

    status = 503
    type = "urn:lineofaction:problem:live-unavailable"
    title = "No live answer"
    exit_code = EXIT_FAILED
    retry_after_s = 1


class DatabaseUnavailable(ServiceError):
    """The database of the service does not answer."""

    status = 503
    type = "urn:lineofaction:problem:database-unavailable"
    title = "The database cannot be reached"
    exit_code = EXIT_UNREACHABLE
    retry_after_s = 5


class StoreUnavailable(ServiceError):
    """The store of results does not answer."""

    status = 503
    type = "urn:lineofaction:problem:store-unavailable"
    title = "The store of results cannot be reached"
    exit_code = EXIT_UNREACHABLE
    retry_after_s = 5


class DamagedFile(ServiceError):
    """A stored file does not hold what its digest says."""

    status = 500
    type = "urn:lineofaction:problem:damaged-file"
    title = "A stored file is damaged"
    exit_code = EXIT_FAILED


class Unreachable(ServiceError):
    """No service answers at the address."""

    status = 503
    type = "urn:lineofaction:problem:unreachable"
    title = "The service cannot be reached"
    exit_code = EXIT_UNREACHABLE


class Unexpected(ServiceError):
    """A defect: the log holds the details under the reference."""

    def __init__(self, reference: str) -> None:
        self.reference = reference
        super().__init__(f"Something failed that should not. The log has the details under {reference}.")

    def as_json(self) -> dict[str, Any]:
        """Return the problem with its reference number."""
        return {**super().as_json(), "reference": self.reference}
