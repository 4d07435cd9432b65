"""All routes of an application, those that the description leaves out too."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from fastapi import FastAPI


@dataclass(frozen=True)
class WalkedRoute:
    """A route with one of its methods."""

    method: str
    path: str
    route: Any

    def __str__(self) -> str:
        return f"{self.method} {self.path}"

    def at(self, **parameters: str) -> str:
        """Return the path with parameters, some more than it has."""
        return self.path.format_map(parameters)


def walked_routes(app: FastAPI) -> list[WalkedRoute]:
    return list(_walk(app.routes, ""))


def _walk(routes: Any, prefix: str) -> Iterator[WalkedRoute]:
    for route in routes:
        inner = getattr(route, "original_router", None)
        if inner is not None:
            yield from _walk(inner.routes, prefix + route.include_context.prefix)
        else:
            for method in sorted(route.methods):
                yield WalkedRoute(method, prefix + route.path, route)
