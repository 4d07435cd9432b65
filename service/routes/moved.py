"""Addresses that have moved for good: a redirection that keeps method, body and query."""

from __future__ import annotations

from http import HTTPStatus

from fastapi import Request
from starlette.responses import RedirectResponse


def moved(request: Request, path: str) -> RedirectResponse:
    """Return the redirection of a request to the path that it has now."""
    query = f"?{request.url.query}" if request.url.query else ""
    return RedirectResponse(f"{path}{query}", status_code=HTTPStatus.PERMANENT_REDIRECT)
