"""The context that the handlers work with."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

from fastapi import Depends, Request
from sqlalchemy import Engine

from service.access import AccessKey
from service.live.kept_answers import KeptAnswers
from service.live.pool import LivePool
from service.queue.caller import ANYBODY, Caller
from service.queue.scheduler import Scheduler
from service.queue.submissions import Submissions
from service.queue.watcher import Watcher
from service.routes.open_databases import OpenDatabases
from service.routes.streams import JobEvent, Streams
from service.settings import Settings
from service.store import ResultStore
from service.store.write_check import WriteCheck
from service.worker.process import Registry
from service.worker.remote_work import RemoteWork


@dataclass(frozen=True)
class Context:
    """Everything a handler may use."""

    settings: Settings
    registry: Registry
    submissions: Submissions
    scheduler: Scheduler | RemoteWork
    store: ResultStore
    live: LivePool
    reader: LivePool
    kept: KeptAnswers
    engine: Engine
    writes: WriteCheck
    watcher: Watcher[JobEvent]
    databases: OpenDatabases = field(default_factory=OpenDatabases)
    streams: Streams = field(default_factory=Streams)

    def stop_waiting(self) -> None:
        """End the workers of those who wait for an answer, and the streams of those who wait for an event."""
        self.watcher.stop()
        self.live.stop()
        self.reader.stop()

    def close(self) -> None:
        """Close what is open; it opens again when it is needed."""
        self.engine.dispose()


def context_of(request: Request) -> Context:
    """Return the context of the app that serves `request`."""
    context: Context = request.app.state.context
    return context


def caller_of(request: Request) -> Caller:
    """Return who sent a request; see `service.routes.access`."""
    key: AccessKey | None = getattr(request.state, "caller", None)
    if key is None:
        return ANYBODY
    return Caller(key.name, key.unfinished_jobs, key.highest_priority, key.max_cost_s)


From = Annotated[Caller, Depends(caller_of)]
Ctx = Annotated[Context, Depends(context_of)]
