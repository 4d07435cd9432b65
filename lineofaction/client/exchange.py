"""Requests to a service: retries, downloads, the caller's trace, and answers checked."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any, BinaryIO, TypeVar

import httpx2

from lineofaction.client.problem_answers import problem_of, stranger
from lineofaction.client.steps import Open, Pause, Piece, Send, Steps, Stream
from lineofaction.gearbox.problems import Unreachable

_RETRIED = (429, 502, 503, 504)
_FIRST_PAUSE_S, _LONGEST_BACKOFF_S, _LONGEST_PAUSE_S = 0.1, 2.0, 10.0

T = TypeVar("T")


def traced(options: dict[str, Any]) -> dict[str, Any]:
    """Return the options of a request with the headers of the active span of OpenTelemetry, if there is one.

    Who has an active span has imported OpenTelemetry; nobody else pays for that.
    """
    if "opentelemetry.trace" not in sys.modules:
        return options
    from opentelemetry.propagate import inject  # noqa: PLC0415 (not installed with the client)

    headers: dict[str, str] = {}
    inject(headers)
    return {**options, "headers": headers | options.get("headers", {})} if headers else options


class _TryAgain(Exception):
    """An answer that may be another one later."""

    def __init__(self, response: httpx2.Response) -> None:
        self.response = response


@dataclass(frozen=True)
class Exchange:
    """Requests to one service, each sent up to `attempts` times.

    Every request may be sent again: a submission carries an idempotency key, and everything else only reads
    or dismisses.
    """

    base_url: str
    attempts: int

    def request(self, method: str, path: str, **options: Any) -> Steps[httpx2.Response]:
        """Return the answer to a request.

        Raises
        ------
        Unreachable
            No service answers, after all attempts; or what answers is another program.
        ServiceError
            The problem the service answered with.
        """

        def once() -> Steps[httpx2.Response]:
            return _checked((yield Send(method, path, traced(options))))

        return (yield from self._with_retries(once))

    def read(self, reader: Callable[[Any], T], method: str, path: str, **options: Any) -> Steps[T]:
        """Return the value of `reader` for the JSON that answers a request; raises as `request`."""
        response = yield from self.request(method, path, **options)
        try:
            return reader(response.json())
        except (LookupError, TypeError, ValueError, AttributeError):
            raise stranger(response) from None

    def download(self, path: str, media_type: str, into: BinaryIO) -> Steps[tuple[str, Mapping[str, str]]]:
        """Write the file that a path answers with, piece by piece.

        Raises `Unreachable`, `ServiceError` as `request`.

        Returns
        -------
        tuple of str and mapping
            SHA-256 of what was written, hexadecimal, and the headers of the answer.
        """

        def once() -> Steps[tuple[str, Mapping[str, str]]]:
            into.seek(0)
            into.truncate()
            digest = hashlib.sha256()
            stream: Stream = yield Open("GET", path, traced({"headers": {"Accept": media_type}}))
            _checked(stream.response)
            while (piece := (yield Piece(stream))) is not None:
                digest.update(piece)
                into.write(piece)
            return digest.hexdigest(), stream.response.headers

        return (yield from self._with_retries(once))

    def opened(self, path: str, media_type: str) -> Steps[Stream]:
        """Return the answer of a path with its body still to come; raises as `request`."""

        def once() -> Steps[Stream]:
            stream: Stream = yield Open("GET", path, traced({"headers": {"Accept": media_type}}))
            _checked(stream.response)
            if stream.response.headers.get("content-type", "").partition(";")[0] != media_type:
                raise stranger(stream.response)
            return stream

        return (yield from self._with_retries(once))

    def _with_retries(self, once: Callable[[], Steps[T]]) -> Steps[T]:
        """Return the value of `once`, which runs again when the network or the service asks for it."""
        for attempt in range(1, self.attempts):
            try:
                return (yield from once())
            except (httpx2.TransportError, _TryAgain) as error:
                pause = _pause_s(attempt, error)
            yield Pause(pause)
        try:
            return (yield from once())
        except _TryAgain as last:
            raise problem_of(last.response) from None
        except httpx2.TransportError as error:
            raise self.away(error) from None

    def away(self, error: httpx2.TransportError) -> Unreachable:
        """Return the error to raise for a failure of the network."""
        reason = type(error).__name__
        return Unreachable(f"No service answers at {self.base_url} ({reason}). Start one with: loa serve")


def _checked(response: httpx2.Response) -> httpx2.Response:
    if response.status_code in _RETRIED:
        raise _TryAgain(response)
    if not response.is_success:  # redirections too: this service has none
        raise problem_of(response)
    return response


def _pause_s(attempt: int, error: Exception) -> float:
    """Return the seconds that the service asks to wait, else exponentially more."""
    if isinstance(error, _TryAgain):
        requested = _retry_after_s(error.response.headers)
        if requested is not None:
            return min(max(requested, 0.0), _LONGEST_PAUSE_S)
    return min(_FIRST_PAUSE_S * 2.0 ** (attempt - 1), _LONGEST_BACKOFF_S)


def _retry_after_s(headers: Mapping[str, str]) -> float | None:
    """Return the seconds of a ``Retry-After``, which is a number or a date (RFC 9110, 10.2.3).

    A date counts from that of the answer: the service's clock may not be this one.
    """
    text = headers.get("retry-after", "")
    when = _date(text)
    if text.isdigit() or when is None:
        return float(text) if text.isdigit() else None
    return (when - (_date(headers.get("date", "")) or datetime.now(UTC))).total_seconds()


def _date(text: str) -> datetime | None:
    try:
        when = parsedate_to_datetime(text)
    except ValueError:
        return None
    return when if when.tzinfo else when.replace(tzinfo=UTC)
