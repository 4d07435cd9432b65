"""The public keys of an OpenID Connect issuer: fetched from the issuer, and anew when they change."""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import Callable
from typing import Any
from urllib.parse import urlsplit

import httpx2
import structlog

from lineofaction.gearbox.problems import IssuerUnavailable, Unauthorised

Json = dict[str, Any]
logger = structlog.get_logger(__name__)
FRESH_S, STALE_S = 3600.0, 86_400.0
"""Seconds after which keys are fetched anew, and seconds for which keys stay valid while the issuer does not
answer."""
PAUSE_S = 10.0
"""Seconds between attempts to fetch keys: tokens with made-up key identifiers cause no more attempts."""
_TIMEOUT_S = 5.0
_LARGEST = 1_000_000
_DISCOVERY = "/.well-known/openid-configuration"


class Issuer:
    """The keys that one issuer signs with, by their identifiers; used from one event loop.

    Parameters
    ----------
    url : str
        Address of the issuer, as its tokens have it.
    keys_url : str, optional
        Address of the keys; default: the address in the issuer's configuration, on its own host.
    clock : callable
        Function that returns seconds of a monotonic clock; tests replace it.
    """

    def __init__(
        self, url: str, keys_url: str | None = None, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.url, self._keys_url, self._clock = url, keys_url, clock
        self._keys: dict[str, Json] = {}
        self._fetched = -float("inf")  # time of the last success
        self._tried = -float("inf")  # time of the last attempt
        self._lock = asyncio.Lock()
        self._renewal: asyncio.Task[None] | None = None

    async def key(self, identifier: str) -> Json:
        """Return a key (RFC 7517).

        Raises `Unauthorised`: the issuer has none of this identifier; `IssuerUnavailable`: it does not
        answer, and no key is at hand.
        """
        if not self._good(identifier):
            await self._renew(identifier)
        elif self._age > FRESH_S and (self._renewal is None or self._renewal.done()):
            self._renewal = asyncio.create_task(self._renew(identifier))  # the caller takes the known key
        if self._good(identifier):
            return self._keys[identifier]
        if self._tried > self._fetched:  # the last attempt failed
            raise IssuerUnavailable("The issuer of access tokens does not answer. Try again later.")
        raise Unauthorised.of("The token is signed with a key that its issuer does not publish.")

    @property
    def _age(self) -> float:
        return self._clock() - self._fetched

    def _good(self, identifier: str) -> bool:
        """Whether a key is known and still valid."""
        return identifier in self._keys and self._age <= STALE_S

    async def _renew(self, identifier: str) -> None:
        """Fetch the keys, unless another caller has just fetched them or the last attempt is too recent."""
        async with self._lock:
            fresh = self._good(identifier) and self._age <= FRESH_S
            if fresh or self._clock() - self._tried < PAUSE_S:
                return
            self._tried = self._clock()
            try:
                self._keys = await asyncio.to_thread(self._fetch)
            except (httpx2.HTTPError, ValueError, KeyError, TypeError) as error:
                logger.warning("keys of the issuer not fetched", issuer=self.url, error=type(error).__name__)
            else:
                self._fetched = self._tried

    def _fetch(self) -> dict[str, Json]:
        """Return the published keys for signatures, by their identifiers."""
        with httpx2.Client(timeout=_TIMEOUT_S, follow_redirects=False) as http:
            keys = _document(http, self._keys_url or self._discovered(http))["keys"]
        return {key["kid"]: key for key in keys if "kid" in key and key.get("use", "sig") == "sig"}

    def _discovered(self, http: httpx2.Client) -> str:
        """Return the address of the issuer's keys by its configuration; raise ValueError: another host."""
        document = _document(http, self.url.rstrip("/") + _DISCOVERY)
        address = str(document["jwks_uri"])
        if document["issuer"] != self.url or _host(address) != _host(self.url):
            raise ValueError(address)
        return address


def _host(url: str) -> tuple[str, str]:
    parts = urlsplit(url)
    return parts.scheme, parts.netloc


def _document(http: httpx2.Client, url: str) -> Json:
    """Return the JSON object at an address; raise ValueError or TypeError for other content."""
    with http.stream("GET", url) as answer:
        answer.raise_for_status()
        content = b""
        for piece in answer.iter_bytes():
            content += piece
            if len(content) > _LARGEST:
                raise ValueError(url)
    document = json.loads(content)
    if not isinstance(document, dict):
        raise TypeError(url)
    return document
