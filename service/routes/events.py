"""Changes of a job's status as server-sent events (HTML Living Standard, clause 9.2)."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator

from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from service.problems import NoSuchJob, QueueFull
from service.routes.caching import NO_STORE
from service.routes.context import Context, Ctx
from service.routes.jobs import status_info
from service.routes.refusals import documented
from service.routes.response_headers import described_headers
from service.routes.streams import Streams

LOOK_S = 0.25
HEARTBEAT_S = 15.0
EVENT_STREAM = "text/event-stream"

router = APIRouter(prefix="/jobs", tags=["jobs"])


class TooManyStreams(QueueFull):
    """As many callers as the service bears listen already."""

    type = "urn:lineofaction:problem:too-many-streams"
    title = "Too many event streams"


@router.get(
    "/{job_id}/events",
    summary="Changes of a job's status",
    response_class=Response,
    responses={
        200: {
            "description": "Events `status`, each with the status document",
            "content": {EVENT_STREAM: {"schema": {"type": "string"}}},
            "headers": described_headers("Cache-Control"),
        },
        **documented(NoSuchJob, TooManyStreams),
    },
)
async def job_events(job_id: str, context: Ctx) -> Response:
    """Send the status now and whenever it changes; the stream ends after the final one.

    Who reconnects gets the current status. Comments keep the connection open.
    """
    await run_in_threadpool(context.submissions.find, job_id)
    if not context.streams.enter():
        raise TooManyStreams(f"{context.streams.most} event streams are open. Poll the status, or try again.")
    headers = {"Cache-Control": NO_STORE, "X-Accel-Buffering": "no"}
    return _Stream(context.streams, _changes(context, job_id), headers)


class _Stream(StreamingResponse):
    """A stream that is counted as long as it is sent, however that ends."""

    def __init__(self, streams: Streams, content: AsyncIterator[bytes], headers: dict[str, str]) -> None:
        super().__init__(content, media_type=EVENT_STREAM, headers=headers)
        self._streams = streams

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the stream."""
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._streams.leave()


async def _changes(context: Context, job_id: str) -> AsyncIterator[bytes]:
    """Yield events until the job has ended; a thread is taken for each look only."""
    sent, last = b"", time.monotonic()
    while True:
        job = await run_in_threadpool(context.submissions.find, job_id)
        status = await run_in_threadpool(status_info, job, context.registry)
        document = status.model_dump_json().encode()
        if document != sent:
            sent, last = document, time.monotonic()
            yield b"event: status\ndata: " + document + b"\n\n"
        elif time.monotonic() - last > HEARTBEAT_S:
            last = time.monotonic()
            yield b": the job goes on\n\n"
        if job.ended:
            return
        await asyncio.sleep(LOOK_S)
