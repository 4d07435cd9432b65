"""Jobs that have no result."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Self

from lineofaction.gearbox.problems.error import (
    EXIT_BAD_INPUT,
    EXIT_FAILED,
    EXIT_UNREACHABLE,
    OGC,
    Fault,
    ServiceError,
)

# Requests that are refused as they are.


class Unauthorised(ServiceError):
    """The request carries no key, or one that is not good (RFC 6750, section 3)."""

    status = 401
    type = "urn:lineofaction:problem:unauthorised"
    title = "A key is needed"
    exit_code = EXIT_BAD_INPUT
    challenge = "Bearer"

    @classmethod
    def of(cls, message: str) -> Self:
        """Return the error of a key that is not good."""
        error = cls(message)
        error.challenge = 'Bearer error="invalid_token"'
        return error


class KeyExpired(Unauthorised):
    """The request carries a key whose time is over."""

    type = "urn:lineofaction:problem:key-expired"
    title = "The key has expired"


class MissingScope(ServiceError):
    """The request carries a key that may do other things, not this one."""

    status = 403
    type = "urn:lineofaction:problem:missing-scope"
    title = "The key lacks a scope"
    exit_code = EXIT_BAD_INPUT

    @classmethod
    def of(cls, name: str, scope: str, scopes: Iterable[str]) -> Self:
        """Return the error of a key of this name, which has other scopes."""
        has = ", ".join(scopes) or "none"
        error = cls(f"This needs the scope {scope}; key {name!r} has {has}. Ask the operator of the service.")
        error.challenge = f'Bearer error="insufficient_scope", scope="{scope}"'
        return error


class NotFound(ServiceError):
    """No such process, job or result."""

    status = 404
    type = "urn:lineofaction:problem:not-found"
    title = "Not found"
    exit_code = EXIT_BAD_INPUT


class NoSuchProcess(NotFound):
    """No process of this name."""

    type = f"{OGC}no-such-process"
    title = "No such process"


class NoSuchJob(NotFound):
    """No job of this identifier."""

    type = f"{OGC}no-such-job"
    title = "No such job"


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


class HeadTooLarge(ServiceError):
    """The head of the request is beyond the limit."""

    status = 431
    type = "urn:lineofaction:problem:head-too-large"
    title = "The head of the request is too large"
    exit_code = EXIT_BAD_INPUT


class Malformed(ServiceError):
    """The bytes received are no request."""

    status = 400
    type = "urn:lineofaction:problem:malformed"
    title = "The request is not HTTP"
    exit_code = EXIT_BAD_INPUT


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

    @classmethod
    def of(cls, sent: str, *read: str) -> UnsupportedMediaType:
        """Return the error of a body of the type `sent`, where the types `read` are."""
        headers = " or ".join(f"Content-Type: {kind}" for kind in read)
        error = cls(f"The body is {sent or 'of no stated type'}. Send it with the header {headers}.")
        error.accept_post = ", ".join(read)
        return error


class NotAcceptable(ServiceError):
    """The caller takes none of the types an answer can have."""

    status = 406
    type = "urn:lineofaction:problem:not-acceptable"
    title = "No acceptable type of answer"
    exit_code = EXIT_BAD_INPUT


class ResultNotReady(NotFound):
    """The job has not ended."""

    type = f"{OGC}result-not-ready"
    title = "The result is not ready"


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


class StillRunning(ServiceError, TimeoutError):
    """The job did not end in the time it was waited for; it goes on."""

    status = 504
    type = "urn:lineofaction:problem:still-running"
    title = "The job has not ended yet"
    exit_code = EXIT_FAILED
