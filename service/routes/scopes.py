"""The routes: what each operation needs is said where it is defined, and refused before its body is read."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

from fastapi import APIRouter, Request
from fastapi.routing import APIRoute
from pydantic import BaseModel
from starlette import types
from starlette.responses import Response

from lineofaction.gearbox.problems import MissingScope
from service.access.keyring import Scope
from service.routes.context import key_of

Endpoint = TypeVar("Endpoint", bound=Callable[..., Any])
KEY_SCHEME = "accessKey"
"""Name of the scheme in the description."""
OPEN_TO_ALL = None
"""In place of a scope: no key is needed; `service.routes.access.OPEN_PATHS` are the paths."""

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
    """A route that callers with its scope reach; there is none whose endpoint declares no scope."""

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        security = [] if self.scope is OPEN_TO_ALL else [{KEY_SCHEME: [str(self.scope)]}, {}]
        self.openapi_extra = {**(self.openapi_extra or {}), "security": security}

    @property
    def scope(self) -> Scope | None:
        """What callers need; raises AttributeError if the endpoint does not say."""
        scope: Scope | None = self.endpoint.scope  # type: ignore[attr-defined]
        return scope

    def answering(self) -> Callable[[Request], Any]:
        """Return what answers a request that may be answered."""
        return super().get_route_handler()

    def get_route_handler(self) -> Callable[[Request], Any]:
        """Return what answers a request if its caller may ask that."""
        answer, scope, streams = self.answering(), self.scope, self.endpoint.streams  # type: ignore[attr-defined]
        if scope is OPEN_TO_ALL:
            return answer

        async def admitted(request: Request) -> Response:
            require(request, scope)
            key = key_of(request)
            if streams and key is not None:  # counted until the last byte is sent
                request.state.streams.refuse_beyond(key.name, key.streams)
                request.state.held.enter_context(request.state.streams.one(key.name))
            response: Response = await answer(request)
            return response

        return admitted


def require(request: Request, scope: Scope) -> None:
    """Raise `MissingScope` unless the caller has a scope; without keys everybody has all."""
    key = key_of(request)
    if key is not None and scope not in key.scopes:
        raise MissingScope.of(key.name, scope, key.scopes)


# Routes that take the request as it is: no dependencies, no validation by the framework.


def answered_by(handler: Handler) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Let a coroutine of the request answer for an endpoint, whose signature is what OpenAPI documents."""

    def attach(endpoint: Callable[..., None]) -> Callable[..., None]:
        endpoint.direct = handler  # type: ignore[attr-defined]
        return endpoint

    return attach


class DirectRoute(ScopedRoute):
    """A route whose endpoint is `answered_by` a coroutine.

    For queries that come thousands of times a second: solving dependencies costs more there than the answer.
    """

    def answering(self) -> Callable[[Request], Any]:
        """Return the coroutine itself."""
        handler: Handler = self.endpoint.direct  # type: ignore[attr-defined]
        return handler


class DirectRoutes:
    """In front of the framework's router, which compares a path with every route it has.

    Parameters
    ----------
    app : ASGIApp
        What serves all other requests, and those that a direct route refuses by their method.
    router : APIRouter
        Its direct routes are answered here.
    prefix : str
        Under which the router is included.
    """

    def __init__(self, app: types.ASGIApp, router: APIRouter, prefix: str) -> None:
        self._app, self._prefix = app, prefix
        self._routes = [route for route in router.routes if isinstance(route, DirectRoute)]

    async def __call__(self, scope: types.Scope, receive: types.Receive, send: types.Send) -> None:
        """Serve one request."""
        for route in self._routes:
            if scope["type"] == "http" and scope["method"] in (route.methods or ()):
                path = scope["path"]
                match = route.path_regex.match(path.removeprefix(self._prefix))
                if match is not None and path.startswith(self._prefix):
                    scope.update(route=route, endpoint=route.endpoint, path_params=match.groupdict())
                    response = await route.get_route_handler()(Request(scope, receive, send))
                    await response(scope, receive, send)
                    return
        await self._app(scope, receive, send)
