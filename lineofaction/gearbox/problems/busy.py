"""Errors of requests that may be repeated later, or after something else."""

from __future__ import annotations

from typing import Self

from lineofaction.gearbox.problems.error import EXIT_FAILED, ServiceError


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


class TooManyHeld(TryLater):
    """The caller's key holds as many connections or event streams as it may."""

    type = "urn:lineofaction:problem:too-many-held"
    title = "Too much at the same time with this key"
    retry_after_s = 1


class IssuerUnavailable(TryLater):
    """The issuer of access tokens does not answer."""

    status = 503
    type = "urn:lineofaction:problem:issuer-unavailable"
    title = "The issuer of tokens does not answer"
    retry_after_s = 10


class TooManyRequests(TryLater):
    """The server process answers as many requests as it can."""

    status = 503
    type = "urn:lineofaction:problem:too-many-requests"
    title = "Too many requests at once"
    retry_after_s = 1


class Superseded(ServiceError):
    """A later question of the same caller took the place of this one."""

    status = 409
    type = "urn:lineofaction:problem:superseded"
    title = "A later question took its place"
    exit_code = EXIT_FAILED


class NotAnalyzed(ServiceError):
    """There is nothing to answer a live question from."""

    status = 409
    type = "urn:lineofaction:problem:not-analysed"
    title = "The pair has to be analyzed first"
    exit_code = EXIT_FAILED


class LiveUnavailable(ServiceError):
    """The live worker ended or took too long."""

    status = 503
    type = "urn:lineofaction:problem:live-unavailable"
    title = "No live answer"
    exit_code = EXIT_FAILED
    retry_after_s = 1
