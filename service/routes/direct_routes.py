"""Routes that take the request as it is: no dependencies, no validation by the framework."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fastapi import APIRouter, Request
from starlette import types

from service.routes.scopes import Handler, ScopedRoute


def answered_by(handler: Handler) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Return a decorator: the handler, a coroutine of the request, answers in place of the endpoint.

    The endpoint has the signature that OpenAPI documents, and is never called.
    """

    def attach(endpoint: Callable[..., None]) -> Callable[..., None]:
        endpoint.direct = handler  # type: ignore[attr-defined]
        return endpoint

    return attach


class DirectRoute(ScopedRoute):
    """A route whose endpoint is `answered_by` a coroutine.

    It is for queries that come thousands of times a second: dependencies would cost more than the answer.
    """

    def admitted_handler(self) -> Callable[[Request], Any]:
        """Return the coroutine itself, see `ScopedRoute`."""
        handler: Handler = self.endpoint.direct  # type: ignore[attr-defined]
        return handler


class DirectRoutes:
    """Middleware that answers direct routes before the framework compares a path with all its routes.

    Parameters
    ----------
    app : ASGIApp
        App that serves all other requests, and requests whose method a direct route refuses.
    router : APIRouter
        Router whose direct routes the middleware answers.
    prefix : str
        Prefix of the paths of the router.
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
