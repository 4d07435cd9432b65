"""Requests to a service: retries, and problems turned back into errors."""

from __future__ import annotations

import ipaddress
import json
from typing import Any

import httpx2
from tenacity import RetryCallState, Retrying, retry_if_exception_type, stop_after_attempt, wait_exponential

from service.problems import (
    BadInput,
    DamagedFile,
    Fault,
    JobDismissed,
    JobFailed,
    NotFound,
    QueueFull,
    RateExceeded,
    ResultNotReady,
    ServiceError,
    TooLarge,
    Unauthorised,
    Unreachable,
)

_TRY_AGAIN = (429, 502, 503, 504)
_LONGEST_WAIT_S = 10.0
_KNOWN: tuple[type[ServiceError], ...] = (
    ResultNotReady,
    NotFound,
    JobDismissed,
    TooLarge,
    QueueFull,
    RateExceeded,
    Unauthorised,
    DamagedFile,
)


class _TryAgain(Exception):
    """An answer that may be another one later."""

    def __init__(self, response: httpx2.Response) -> None:
        self.response = response


class Connection:
    """One service, at one address.

    Every request may be sent again: equal submissions are one computation, and everything else only reads
    or dismisses.
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
        try:
            self._http = httpx2.Client(
                base_url=self.base_url,
                headers={"Authorization": f"Bearer {key}"} if key else None,
                transport=transport,
                timeout=timeout,
                trust_env=not _is_loopback(httpx2.URL(self.base_url).host),
            )
        except httpx2.InvalidURL:
            raise _bad_address(base_url) from None

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def request(self, method: str, path: str, **arguments: Any) -> httpx2.Response:
        """Return the answer to a request.

        Raises
        ------
        Unreachable
            No service answers, after all attempts.
        ServiceError
            The problem the service answered with.
        """
        retrying = Retrying(
            retry=retry_if_exception_type((httpx2.TransportError, _TryAgain)),
            stop=stop_after_attempt(self._attempts),
            wait=_wait,
            reraise=True,
        )
        try:
            return retrying(self._once, method, path, **arguments)
        except _TryAgain as last:
            raise _problem(last.response) from None
        except (httpx2.UnsupportedProtocol, httpx2.InvalidURL):
            raise _bad_address(self.base_url) from None
        except httpx2.TransportError as error:
            reason = type(error).__name__
            text = f"No service answers at {self.base_url} ({reason}). Start one with: loa serve"
            raise Unreachable(text) from None

    def _once(self, method: str, path: str, **arguments: Any) -> httpx2.Response:
        """Send a request once."""
        response = self._http.request(method, path, **arguments)
        if response.status_code in _TRY_AGAIN:
            raise _TryAgain(response)
        if response.is_error:
            raise _problem(response)
        return response


def _bad_address(base_url: str) -> BadInput:
    """Return the error of an address that is none."""
    return BadInput.of("service", base_url, "an address such as http://127.0.0.1:8321", "Check the address.")


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
    asked = error.response.headers.get("retry-after", "") if isinstance(error, _TryAgain) else ""
    return min(float(asked), _LONGEST_WAIT_S) if asked.isdigit() else _exponential(state)


def _problem(response: httpx2.Response) -> ServiceError:
    """Return the error that an answer tells of."""
    try:
        facts = response.json()
        detail, kind = str(facts["detail"]), str(facts["type"])
        faults = [Fault(**fault) for fault in facts.get("errors", [])]
    except (json.JSONDecodeError, UnicodeDecodeError, KeyError, TypeError):
        status = response.status_code
        return Unreachable(f"{response.request.url} answered with status {status}, not as this service does.")
    if kind == BadInput.type:
        return BadInput(faults)
    if kind == JobFailed.type:
        return BadInput(faults) if faults else JobFailed(detail)
    known = next((error for error in _KNOWN if error.type == kind), None)
    if known is not None:
        return known(detail)
    return NotFound(detail) if response.status_code == NotFound.status else ServiceError(detail)
