"""In front of every route: the caller's key, and how often it may be used."""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send
from structlog.contextvars import bind_contextvars

from service.access import AccessKey, Keyring, RateLimits
from service.problems import NotForUs, RateExceeded, Unauthorised
from service.routes.caching import for_one_caller
from service.routes.host import meant_for_us

OPEN_PATHS = ("/health", "/ready", "/", "/docs")
OPEN_FOLDER = "/page/"
"""Answered to everybody: they tell nothing about anybody's work. Supervisors and load balancers ask without a
key; the page asks its reader for one."""

_SCHEME = "bearer "


class Access:
    """Lets requests through that carry a key, and as long as there are no keys those meant for this machine.

    Parameters
    ----------
    app : ASGIApp
    keyring : Keyring
    always : bool
        Ask for a key even while there is none, so that taking back the last key opens nothing. Otherwise
        keys are requested as soon as there is one.
    """

    def __init__(self, app: ASGIApp, keyring: Keyring, *, always: bool) -> None:
        self._app, self._keyring, self._always, self._rates = app, keyring, always, RateLimits()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request of a known caller."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        closed = self._always or bool(self._keyring)
        if not closed and not meant_for_us(scope):
            raise NotForUs("A service without access keys answers to localhost and its own address only.")
        if closed and not _open(scope["path"]):
            key = self._known(scope)
            bind_contextvars(caller=key.name)
            send = for_one_caller(send)
            scope.setdefault("state", {})["caller"] = key
            wait_s = self._rates.wait_s(key)
            if wait_s:
                raise RateExceeded.after(
                    wait_s, f"Key {key.name!r} has {key.requests_per_minute} requests per minute."
                )
        await self._app(scope, receive, send)

    def _known(self, scope: Scope) -> AccessKey:
        """Return the caller's key; raise if it carries none, or an unknown one."""
        presented = _presented(scope)
        if presented is None:
            raise Unauthorised("This service asks for an access key, sent as: Authorization: Bearer KEY")
        key = self._keyring.holder(presented)
        if key is None:
            raise Unauthorised("This key is unknown. Ask the operator of the service for one.")
        return key


def _open(path: str) -> bool:
    """Whether a path is answered without a key."""
    return path in OPEN_PATHS or path.startswith(OPEN_FOLDER)


def _presented(scope: Scope) -> str | None:
    """Return the key in the header Authorization, None if there is none."""
    for name, value in scope["headers"]:
        if name == b"authorization":
            text = value.decode("latin-1").strip()
            return text[len(_SCHEME) :].strip() if text.lower().startswith(_SCHEME) else None
    return None
