"""In front of every route: who calls, how often and on how many connections; a line of every access."""

from __future__ import annotations

import ipaddress
from contextlib import ExitStack

from starlette.types import ASGIApp, Receive, Scope, Send
from structlog.contextvars import bind_contextvars

from lineofaction.gearbox.problems import KeyExpired, NotForUs, RateExceeded, ServiceError
from service.access import NOBODY, Held, Identities, RateLimits
from service.routes.admission import Admission
from service.routes.audit import Visit
from service.routes.media_types import for_one_caller

# Whether a request was meant for this machine: what protects a service without keys from pages of others.


def _meant_for_us(scope: Scope) -> bool:
    """Whether the header Host, if there is one, names this machine or the address that was connected to.

    A page of another site can let its own name point to 127.0.0.1 (DNS rebinding). To a browser the service
    is then part of that site, so that no rule on origins holds the page back; but its name is in Host.
    """
    named = next((value.decode("latin-1") for name, value in scope["headers"] if name == b"host"), None)
    server = scope.get("server")
    if named is None or server is None:
        return True
    host = _without_port(named).lower()
    return host in ("localhost", str(server[0]).lower()) or _is_loopback(host)


def _without_port(host: str) -> str:
    """Return a name or address without its port, and an IPv6 address without its brackets."""
    if host.startswith("["):
        return host[1:].partition("]")[0]
    return host.partition(":")[0]


def _is_loopback(host: str) -> bool:
    """Whether an address is of this machine alone."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


OPEN_PATHS = ("/health", "/ready", "/", "/docs")
OPEN_FOLDER = "/page/"
"""Answered to everybody: they tell nothing about anybody's work. Supervisors and load balancers ask without a
key; the page asks its reader for one."""
VITAL_PATHS = ("/health", "/ready")
"""Answered however many requests are under way."""

_SCHEME = "bearer "


class Access:
    """Lets requests through that carry a key, and as long as there are no keys those meant for this machine.

    Parameters
    ----------
    app : ASGIApp
    identities : Identities
    always : bool
        Ask for a key even while there is none, so that taking back the last key opens nothing. Otherwise
        keys are requested as soon as there is one.
    admission : Admission
    """

    def __init__(self, app: ASGIApp, identities: Identities, *, always: bool, admission: Admission) -> None:
        self._app, self._identities, self._always = app, identities, always
        self._admission, self._rates, self._streams = admission, RateLimits(), Held("event streams")

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve one request of a known caller."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        closed = self._always or bool(self._identities)
        if not closed and not _meant_for_us(scope):
            raise NotForUs("A service without access keys answers to localhost and its own address only.")
        scope.setdefault("state", {})["closed"] = closed
        if scope["path"] in VITAL_PATHS:
            await self._app(scope, receive, send)
            return
        if not closed or _open(scope["path"]):
            most = self._admission.share if closed else None
            with self._admission.admitted(scope, receive, NOBODY, most) as received:
                await self._app(scope, received, send)
            return
        visit = Visit(scope, send)
        try:
            await self._serve(scope, receive, visit)
        except ServiceError as error:
            visit.refused(error)
            raise
        finally:
            visit.note()

    async def _serve(self, scope: Scope, receive: Receive, visit: Visit) -> None:
        """Find out who calls, and serve the request within the limits of that caller."""
        visit.holder = key = await self._identities.holder(_presented(scope))
        bind_contextvars(caller=key.name)
        if key.expired:
            raise KeyExpired.of(f"Key {key.name!r} has expired ({key.expires}). Ask for a new one.")
        wait_s = self._rates.wait_s(key)
        if wait_s:
            text = f"Key {key.name!r} has {key.requests_per_minute} requests per minute."
            raise RateExceeded.after(wait_s, text)
        most = key.connections or self._admission.share
        with ExitStack() as held:
            received = held.enter_context(self._admission.admitted(scope, receive, key.name, most))
            scope["state"] |= {"caller": key, "held": held, "streams": self._streams}
            await self._app(scope, received, for_one_caller(visit.send))


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
