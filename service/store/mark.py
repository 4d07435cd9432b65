"""Places in lists that are read page by page, the newest first."""

from __future__ import annotations

from typing import Any, NamedTuple

from sqlalchemy import ColumnElement, tuple_


class Mark(NamedTuple):
    """The last line of a page; the next one begins behind it, whether the line still exists or not.

    Attributes
    ----------
    created : str
        RFC 3339 in UTC with microseconds.
    name : str
        Identifier, which orders lines of one instant.
    """

    created: str
    name: str


def behind(mark: Mark, created: ColumnElement[Any], name: ColumnElement[Any]) -> ColumnElement[bool]:
    """Return the condition of lines older than the mark."""
    return tuple_(created, name) < tuple_(mark.created, mark.name)
