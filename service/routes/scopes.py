"""Routes whose endpoints state a scope: a caller without it is refused before the body is read."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from fastapi import Request
from fastapi.routing import APIRoute
from pydantic import BaseModel
from starlette.responses import Response

from lineofaction.gearbox.problems import MissingScope
from service.access.holder import Scope
from service.routes.context import key_of

Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])
KEY_SCHEME = "accessKey"
"""Name of the scheme in the description."""
OPEN_TO_ALL = None
"""Scope of endpoints that need no key; `service.routes.access.OPEN_PATHS` lists their paths."""

Handler = Callable[[Request], Awaitable[Response]]


def needs(
    scope: Scope | None, *, streams: bool = False, body: type[BaseModel] | None = None
) -> Callable[[Endpoint], Endpoint]:
    """Declare the scope that an endpoint needs, and whether it `streams` while its caller listens.

    `body` is the model that explains refused fields.
    """

    def declare(endpoint: Endpoint) -> Endpoint:
        endpoint.scope, endpoint.streams = scope, streams  # type: ignore[attr-defined]
        endpoint.body_model = body  # type: ignore[attr-defined]
        return endpoint

    return declare


class ScopedRoute(APIRoute):
    """A route that callers with its scope reach; an endpoint without a scope cannot be a route."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        security = [] if self.scope is OPEN_TO_ALL else [{KEY_SCHEME: [str(self.scope)]}, {}]
        self.openapi_extra = {**(self.openapi_extra or {}), "security": security}

    @property
    def scope(self) -> Scope | None:
        """The scope that a caller needs; raises AttributeError: the endpoint declares none."""
        scope: Scope | None = self.endpoint.scope  # type: ignore[attr-defined]
        return scope

    def admitted_handler(self) -> Callable[[Request], Any]:
        """Return the handler of requests that `get_route_handler` admits."""
        return super().get_route_handler()

    def get_route_handler(self) -> Callable[[Request], Any]:
        """Return the handler that admits callers with the scope."""
        answer, scope, streams = self.admitted_handler(), self.scope, self.endpoint.streams  # type: ignore[attr-defined]
        if scope is OPEN_TO_ALL:
            return answer

        async def admitted(request: Request) -> Response:
            require(request, scope)
            key = key_of(request)
            if streams and key is not None:  # counted until the last byte is sent
                request.state.streams.refuse_beyond(key.name, key.streams)
                request.state.exit_stack.enter_context(request.state.streams.one(key.name))
            response: Response = await answer(request)
            return response

        return admitted


def require(request: Request, scope: Scope) -> None:
    """Raise `MissingScope` unless the caller has a scope; without keys everybody has all."""
    key = key_of(request)
    if key is not None and scope not in key.scopes:
        raise MissingScope.of(key.name, scope, key.scopes)
