"""Changes of a job's status as server-sent events (HTML Living Standard, clause 9.2)."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Header
from starlette.concurrency import run_in_threadpool
from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from lineofaction.gearbox.problems import NoSuchJob, QueueFull
from service.access import holder
from service.queue.job import Job
from service.routes.context import Context, Ctx, JobEvent, Streams
from service.routes.jobs import status_info
from service.routes.media_types import EVENT_STREAM, NO_STORE, answer
from service.routes.openapi import documented
from service.routes.scopes import ScopedRoute, needs
from service.worker.process import Registry

HEARTBEAT_S = 15.0
LastEvent = Annotated[
    str | None,
    Header(description="The `id` of the last event that arrived: it is not sent again", max_length=100),
]

router = APIRouter(prefix="/jobs", tags=["jobs"], route_class=ScopedRoute)


class _TooManyStreams(QueueFull):
    """Problem: the service already serves its largest number of event streams."""

    type = "urn:lineofaction:problem:too-many-streams"
    title = "Too many event streams"


@router.get(
    "/{job_id}/events",
    summary="Changes of a job's status",
    response_class=Response,
    responses={
        200: answer(
            "Events `status`, each with the status document",
            "Cache-Control",
            content={EVENT_STREAM: {}},  # OpenAPI 3.1 has no schema of events
        ),
        204: {"description": "The last event was the final one: browsers connect no more"},
        **documented(NoSuchJob, _TooManyStreams),
    },
)
@needs(holder.Scope.READ, streams=True)
async def job_events(job_id: str, context: Ctx, last_event_id: LastEvent = None) -> Response:
    """Send the status now and whenever it changes; the stream ends after the final one.

    A caller that reconnects gets the current status, unless it is that of the last event that arrived.
    Comments in the stream keep the connection open.
    """
    job = await run_in_threadpool(context.submissions.find, job_id)
    event = await run_in_threadpool(event_of, job, context.registry)
    if event.last and event.id == last_event_id:
        return Response(status_code=204)
    if not context.streams.enter():
        text = f"{context.streams.maximum} event streams are open. Poll the status, or try again."
        raise _TooManyStreams(text)
    headers = {"Cache-Control": NO_STORE, "X-Accel-Buffering": "no"}
    return _Stream(context.streams, _changes(context, job, event, last_event_id), headers)


def event_of(job: Job, registry: Registry) -> JobEvent:
    """Return the event of a job as it is."""
    document = status_info(job, registry).model_dump_json().encode()
    text = b"event: status\nid: %s\ndata: %s\n\n" % (job.mark.encode(), document)
    return JobEvent(job.mark, text, job.ended)


class _Stream(StreamingResponse):
    """A stream that leaves the count of open streams when it ends for any reason."""

    def __init__(self, streams: Streams, content: AsyncIterator[bytes], headers: dict[str, str]) -> None:
        super().__init__(content, media_type=EVENT_STREAM, headers=headers)
        self._streams = streams

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._streams.leave()


class _Latest:
    """The latest event, passed from the watcher's thread to a coroutine; None: there will be no more."""

    def __init__(self, event: JobEvent) -> None:
        self.event: JobEvent | None = event
        self._loop, self._changed = asyncio.get_running_loop(), asyncio.Event()

    def tell(self, event: JobEvent | None) -> None:
        """Replace the event, from any thread; a coroutine that has not read the former one reads this one."""

        def replace() -> None:
            self.event = event
            self._changed.set()

        with contextlib.suppress(RuntimeError):  # the loop was closed
            self._loop.call_soon_threadsafe(replace)

    async def changed(self, patience_s: float) -> bool:
        """Wait for the next event; return False if none came within `patience_s`."""
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(patience_s):
                await self._changed.wait()
        changed = self._changed.is_set()
        self._changed.clear()
        return changed


async def _changes(context: Context, job: Job, event: JobEvent, sent: str | None) -> AsyncIterator[bytes]:
    """Yield events from `event` on, except the one with the id `sent`, which the caller has."""
    if event.last:
        yield event.text
        return
    latest = _Latest(event)
    with context.watcher.following(job, latest.tell):
        while latest.event is not None:
            if latest.event.id != sent:
                current = latest.event
                yield current.text
                if current.last:
                    return
                sent = current.id
            while not await latest.changed(HEARTBEAT_S):
                yield b": the job goes on\n\n"
