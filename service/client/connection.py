"""Requests to a service: retries, downloads, and answers checked to be this service's."""

from __future__ import annotations

import hashlib
import ipaddress
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import Any, BinaryIO, TypeVar

import httpx2
from tenacity import RetryCallState, Retrying, retry_if_exception_type, stop_after_attempt, wait_exponential

from service.client.answers import problem_of, stranger
from service.problems import BadInput, Unreachable
from service.version import solver_version

_TRY_AGAIN = (429, 502, 503, 504)
_LONGEST_WAIT_S = 10.0
_CHUNK = 1 << 18
_RAW = "application/octet-stream"

T = TypeVar("T")


class _TryAgain(Exception):
    """An answer that may be another one later."""

    def __init__(self, response: httpx2.Response) -> None:
        self.response = response


class Connection:
    """One service, at one address; threads may share it.

    Every request may be sent again: equal submissions are one computation, and everything else only reads
    or dismisses. Proxies and certificates are those of the environment (``HTTPS_PROXY``, ``NO_PROXY``,
    ``SSL_CERT_FILE``); this machine is asked without a proxy.
    """

    def __init__(
        self,
        base_url: str,
        transport: httpx2.BaseTransport | None,
        timeout: float,
        attempts: int,
        key: str | None = None,
    ) -> None:
        self.base_url = base_url.rstrip("/")
        self._attempts = attempts
        agent = {"User-Agent": f"lineofaction/{solver_version()}"}
        self._http = httpx2.Client(
            base_url=self.base_url,
            headers=agent | ({"Authorization": f"Bearer {key}"} if key else {}),
            transport=transport,
            timeout=timeout,
            trust_env=not _is_loopback(_host(base_url)),
        )

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def request(self, method: str, path: str, **arguments: Any) -> httpx2.Response:
        """Return the answer to a request.

        Raises
        ------
        Unreachable
            No service answers, after all attempts; or what answers is another program.
        ServiceError
            The problem the service answered with.
        """
        return self._patiently(lambda: _checked(self._http.request(method, path, **arguments)))

    def read(self, reader: Callable[[dict[str, Any]], T], method: str, path: str, **arguments: Any) -> T:
        """Return what `reader` makes of the JSON object that answers a request; raises as `request`."""
        response = self.request(method, path, **arguments)
        try:
            return reader(response.json())
        except (LookupError, TypeError, ValueError, AttributeError):
            raise stranger(response) from None

    def columns(self, path: str, content: bytes, **parameters: str) -> bytes:
        """Return the raw columns that a path makes of raw columns; raises as `request`."""
        headers = {"Content-Type": _RAW, "Accept": _RAW}
        response = self.request("POST", path, params=parameters, content=content, headers=headers)
        if response.headers.get("content-type") != _RAW:
            raise stranger(response)
        return response.content

    def download(self, path: str, media_type: str, into: BinaryIO) -> tuple[str, Mapping[str, str]]:
        """Write the file that a path answers with, piece by piece.

        Returns
        -------
        tuple of str and mapping
            SHA-256 of what was written, hexadecimal, and the headers of the answer.

        Raises
        ------
        Unreachable, ServiceError
            As `request`.
        """

        def once() -> tuple[str, Mapping[str, str]]:
            into.seek(0)
            into.truncate()
            digest = hashlib.sha256()
            with self._http.stream("GET", path, headers={"Accept": media_type}) as response:
                if not response.is_success:
                    response.read()
                _checked(response)
                for piece in response.iter_bytes(_CHUNK):
                    digest.update(piece)
                    into.write(piece)
            return digest.hexdigest(), response.headers

        return self._patiently(once)

    def _patiently(self, once: Callable[[], T]) -> T:
        """Return what `once` returns, which is called again when the network or the service asks for it."""
        retrying = Retrying(
            retry=retry_if_exception_type((httpx2.TransportError, _TryAgain)),
            stop=stop_after_attempt(self._attempts),
            wait=_wait,
            reraise=True,
        )
        try:
            return retrying(once)
        except _TryAgain as last:
            raise problem_of(last.response) from None
        except httpx2.TransportError as error:
            reason = type(error).__name__
            text = f"No service answers at {self.base_url} ({reason}). Start one with: loa serve"
            raise Unreachable(text) from None


def _checked(response: httpx2.Response) -> httpx2.Response:
    """Return an answer that is what was requested; raises what it says otherwise."""
    if response.status_code in _TRY_AGAIN:
        raise _TryAgain(response)
    if not response.is_success:  # a redirection too: those are for others
        raise problem_of(response)
    return response


def _host(base_url: str) -> str:
    """Return the host of an address; raises `BadInput` for one that is none."""
    try:
        url = httpx2.URL(base_url)
    except httpx2.InvalidURL:
        url = httpx2.URL()
    if url.scheme not in ("http", "https") or not url.host:
        advice = "Begin it with http:// or https://."
        raise BadInput.of("service", base_url, "an address such as http://127.0.0.1:8321", advice)
    return url.host


def _is_loopback(host: str) -> bool:
    """Whether a host is this machine, which no proxy needs to reach."""
    try:
        return host == "localhost" or ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


_exponential = wait_exponential(multiplier=0.1, max=2.0)


def _wait(state: RetryCallState) -> float:
    """Wait as long as the service asks for, else exponentially longer."""
    error = state.outcome.exception() if state.outcome else None
    delay = _asked_s(error.response.headers.get("retry-after", "")) if isinstance(error, _TryAgain) else None
    return _exponential(state) if delay is None else min(max(delay, 0.0), _LONGEST_WAIT_S)


def _asked_s(text: str) -> float | None:
    """Return the seconds of a ``Retry-After``, which is a number or a date (RFC 9110, 10.2.3)."""
    if text.isdigit():
        return float(text)
    try:
        when = parsedate_to_datetime(text)
    except ValueError:
        return None
    return (when if when.tzinfo else when.replace(tzinfo=UTC)).timestamp() - datetime.now(UTC).timestamp()
