"""Answers that a worker makes from stored results, kept in memory while they are asked for."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from fastapi import Request, Response
from starlette.concurrency import run_in_threadpool

from service.live.order import LiveOrder
from service.routes.context import Context

VERSION = ("ETag", "Cache-Control")
"""Headers of such an answer."""


async def kept_answer(
    request: Request,
    context: Context,
    tag: str,
    order: LiveOrder,
    media_type: str,
    body_of: Callable[[bytes], bytes] = lambda answer: answer,
) -> Response:
    """Return the answer to an order by its tag; 304 to a caller that has it.

    Parameters
    ----------
    tag : str
        Names the content, in quotes.
    body_of : callable
        From the worker's answer to the body.
    """
    headers = {"ETag": tag, "Cache-Control": "no-cache"}
    if tag in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    body = await run_in_threadpool(context.kept.find, tag)
    if body is None:
        body = body_of(await asyncio.wrap_future(context.live.ask(order)))
        await run_in_threadpool(context.kept.keep, tag, body)
    return Response(body, media_type=media_type, headers=headers)
