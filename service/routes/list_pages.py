"""Pages of lists: links, and cursors, which are opaque to callers and do not expire."""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Sequence
from typing import Annotated
from urllib.parse import urlencode

from fastapi import Query, Request

from lineofaction.gearbox.problems import BadInput
from service.schemas.answers import Link
from service.store.results import Mark

_MARK = re.compile(r"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{6}Z) ([0-9a-f-]{36}|[0-9a-f]{64})\Z")
Cursor = Annotated[
    str | None,
    Query(max_length=200, description="Cursor from the link `next` of the previous page"),
]
Limit = Annotated[int, Query(ge=1, le=1000, description="Largest number of entries on the page")]


def page_links(request: Request, path: str, last: Mark | None) -> list[Link]:
    """Return the links of a page: itself, and the next one behind `last` with the same parameters."""
    parameters = [(name, value) for name, value in request.query_params.multi_items() if name != "cursor"]
    links = [Link(href=_href(path, request.query_params.multi_items()), rel="self", title="This page")]
    if last is not None:
        cursor = base64.urlsafe_b64encode(" ".join(last).encode()).decode().rstrip("=")
        following = _href(path, [*parameters, ("cursor", cursor)])
        links.append(Link(href=following, rel="next", title="Next page"))
    return links


def _href(path: str, parameters: Sequence[tuple[str, str]]) -> str:
    return f"{path}?{urlencode(parameters)}" if parameters else path


def mark_of(cursor: str | None) -> Mark | None:
    """Return the mark of a cursor, None without one.

    Raises `BadInput`: it is no cursor of this service.
    """
    if cursor is None:
        return None
    try:  # padding was cut off the cursor
        text = base64.b64decode(cursor + "=" * (-len(cursor) % 4), altchars=b"-_", validate=True).decode()
    except (binascii.Error, ValueError):
        text = ""
    match = _MARK.match(text)
    if match is None:
        remedy = "Follow the link next of a page, or leave it out for the first page."
        raise BadInput.of("cursor", cursor, "taken from a page of this list", remedy)
    return Mark(*match.groups())
