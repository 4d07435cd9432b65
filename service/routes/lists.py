"""Answers with lists, made in a few separate threads, with a tag that saves sending them again."""

from __future__ import annotations

import asyncio
import contextvars
import hashlib
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from fastapi import Request
from pydantic import BaseModel
from starlette.responses import Response

from service.routes.media_types import JSON, answer

_THREADS = ThreadPoolExecutor(2, thread_name_prefix="list")
"""Threads that make lists. Many lists at once wait for each other here. In the threads of all requests they
would block the event loop, which answers whether the service is alive."""

_HEADERS = ("ETag", "Cache-Control")
LISTED: dict[int | str, dict[str, Any]] = {
    200: answer("The list", *_HEADERS),
    304: answer("Not modified", *_HEADERS),
}
"""Answers that a route of a list declares."""


async def list_answer(request: Request, page: Callable[[], BaseModel]) -> Response:
    """Return a page that is made in another thread; 304 to a caller that has it."""

    def written() -> bytes:
        return page().model_dump_json(by_alias=True).encode()

    loop, context = asyncio.get_running_loop(), contextvars.copy_context()
    body = await loop.run_in_executor(_THREADS, context.run, written)
    headers = {"ETag": f'"{hashlib.sha256(body).hexdigest()}-list"', "Cache-Control": "no-cache"}
    if headers["ETag"] in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    return Response(body, media_type=JSON, headers=headers)
