"""Access to every route: the caller, the rate of requests, connections; one line in the log each."""

from __future__ import annotations

import re
from contextlib import ExitStack
from functools import partial

import structlog
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bind_contextvars

from lineofaction.gearbox.problems import KeyExpired, NotForUs, RateExceeded, ServiceError
from service.access.capacity import KEYLESS, RateLimits, Usage
from service.access.holder import Holder
from service.access.identities import Identities
from service.access.quotas import Quota
from service.origin import is_loopback
from service.routes.admission import Admission
from service.routes.media_types import for_one_caller

_KEY = re.compile(r"loa_[A-Za-z0-9_-]+")
_LONGEST = 200
logger = structlog.get_logger(__name__)
OPEN_PATHS = ("/health", "/ready", "/", "/docs")
OPEN_FOLDER = "/page/"
"""Answered to everybody: they tell nothing about anybody's work. Supervisors and load balancers ask without a
key; the page asks its reader for one."""
VITAL_PATHS = ("/health", "/ready")
"""Answered however many requests are under way."""
_SCHEME = "bearer "


class _Visit:
    """An access to a service with keys until it is logged; `holder` is the caller, once known."""

    def __init__(self, scope: Scope, send: Send) -> None:
        self._scope, self._send = scope, send
        self.holder: Holder | None = None
        self._status = 500
        self._problem: str | None = None

    async def send(self, message: Message) -> None:
        if message["type"] == "http.response.start":
            self._status = message["status"]
        await self._send(message)

    def refused(self, error: ServiceError) -> None:
        self._status, self._problem = error.status, error.kind

    def note(self) -> None:
        """Write the line, without the key, even for a caller who wrote the key into the path."""
        problem = self._problem or self._scope["state"].get("problem")
        logger.info(
            "access",
            caller=self.holder and self.holder.name,
            project=self.holder and self.holder.project,
            scope=getattr(self._scope.get("endpoint"), "scope", None),
            operation=getattr(self._scope.get("route"), "name", None),
            target=f"{self._scope['method']} {_KEY.sub('(key)', self._scope['path'])[:_LONGEST]}",
            outcome=problem or "granted",
            status=self._status,
        )


def _meant_for_us(scope: Scope) -> bool:
    """Whether the header Host, if there is one, names this machine or the address that was connected to.

    A page of another site can let its own name point to 127.0.0.1 (DNS rebinding). To a browser the service
    is then part of that site, so that no rule on origins holds the page back; but its name is in Host.
    """
    named = next((value.decode("latin-1") for name, value in scope["headers"] if name == b"host"), None)
    server = scope.get("server")
    if named is None or server is None:
        return True
    host = named[1:].partition("]")[0] if named.startswith("[") else named.partition(":")[0]
    return host.lower() == str(server[0]).lower() or is_loopback(host.lower())


class Access:
    """Lets requests with a key through; while no key exists, requests meant for this machine.

    `always`: ask for a key even while there is none, so that taking back the last key opens nothing.
    Otherwise keys are requested as soon as there is one.
    """

    def __init__(self, app: ASGIApp, identities: Identities, *, always: bool, admission: Admission) -> None:
        self._app, self._identities, self._always = app, identities, always
        self._admission, self._rates, self._streams = admission, RateLimits(), Usage("event streams")

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
        if not closed or scope["path"] in OPEN_PATHS or scope["path"].startswith(OPEN_FOLDER):
            maximum = self._admission.share if closed else None
            with self._admission.admitted(scope, receive, KEYLESS, maximum) as received:
                await self._app(scope, received, send)
            return
        visit = _Visit(scope, send)
        try:
            await self._serve(scope, receive, visit)
        except ServiceError as error:
            visit.refused(error)
            raise
        finally:
            visit.note()

    async def _serve(self, scope: Scope, receive: Receive, visit: _Visit) -> None:
        """Find out who calls, and serve the request within the limits of that caller."""
        key = await self._identities.holder(_presented(scope))
        visit.holder = key
        bind_contextvars(caller=key.name)
        if key.expired:
            raise KeyExpired.of(f"Key {key.name!r} has expired ({key.expires}). Ask for a new one.")
        maximum = key.connections or self._admission.share
        scope["state"]["quotas"] = partial(self._quotas, key, maximum)
        wait_s = self._rates.wait_s(key)
        if wait_s:
            text = f"Key {key.name!r} has {key.requests_per_minute} requests per minute."
            raise RateExceeded.after(wait_s, text)
        with ExitStack() as stack:
            received = stack.enter_context(self._admission.admitted(scope, receive, key.name, maximum))
            scope["state"] |= {"caller": key, "exit_stack": stack, "streams": self._streams}
            await self._app(scope, received, for_one_caller(visit.send))

    def _quotas(self, key: Holder, maximum: int) -> list[Quota]:
        """Return the shares of a key, as its answer begins."""
        rate = self._rates.quota(key)
        return [*([] if rate is None else [rate]), self._admission.quota(key.name, maximum)]


def _presented(scope: Scope) -> str | None:
    """Return the key in the header Authorization, None if there is none."""
    for name, value in scope["headers"]:
        if name == b"authorization":
            text = value.decode("latin-1").strip()
            return text[len(_SCHEME) :].strip() if text.lower().startswith(_SCHEME) else None
    return None
