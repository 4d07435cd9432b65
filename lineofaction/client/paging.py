"""Lists of the service, page after page."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeVar

from lineofaction.client.exchange import Exchange
from lineofaction.client.steps import Item, Items

T = TypeVar("T")
_PAGE = 100
"""Entries that are fetched at a time."""


def pages(
    exchange: Exchange,
    path: str,
    entries: str,
    reader: Callable[[dict[str, Any]], T],
    parameters: Mapping[str, Any],
    limit: int | None,
) -> Items[T]:
    """Hand out the entries of a list, at most `limit`; the next page is fetched when it is needed.

    Parameters
    ----------
    path, entries : str
        Of the list; the name of the entries in its pages.
    reader : callable
        JSON of an entry to the entry.
    parameters : mapping
        Of the first page.
    """

    def read(page: dict[str, Any]) -> tuple[list[T], str | None]:
        following = (link["href"] for link in page["links"] if link["rel"] == "next")
        return [reader(entry) for entry in page[entries]], next(following, None)

    left = limit
    size = _PAGE if limit is None else max(1, min(limit, _PAGE))
    shown, following = yield from exchange.read(read, "GET", path, params={**parameters, "limit": size})
    while True:
        for entry in shown[:left]:
            yield Item(entry)
        left = None if left is None else left - len(shown)
        if following is None or (left is not None and left <= 0):
            return
        shown, following = yield from exchange.read(read, "GET", following)
