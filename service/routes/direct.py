"""Routes that take the request as it is: no dependencies, no validation by the framework."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any

from fastapi.routing import APIRoute
from starlette.requests import Request
from starlette.responses import Response

Handler = Callable[[Request], Awaitable[Response]]


def answered_by(handler: Handler) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Let a coroutine of the request answer for an endpoint, whose signature is what OpenAPI documents."""

    def attach(endpoint: Callable[..., None]) -> Callable[..., None]:
        endpoint.direct = handler  # type: ignore[attr-defined]
        return endpoint

    return attach


class DirectRoute(APIRoute):
    """A route whose endpoint is `answered_by` a coroutine.

    For queries that come thousands of times a second: solving dependencies costs more there than the answer.
    """

    def get_route_handler(self) -> Callable[[Request], Any]:
        """Return the coroutine itself."""
        handler: Handler = self.endpoint.direct  # type: ignore[attr-defined]
        return handler
