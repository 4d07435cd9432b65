"""The context that the handlers work with."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Annotated, NamedTuple

from fastapi import Depends, Request
from sqlalchemy import Engine

from service.access.holder import Holder
from service.live.cached_answers import KeptAnswers
from service.live.question_pool import QuestionPool
from service.live.turns import Asker
from service.project import COMMON
from service.queue.scheduler import Scheduler
from service.queue.submissions import Submissions
from service.queue.terms import KEYLESS_CALLER
from service.queue.watcher import Watcher
from service.routes.open_databases import OpenDatabases
from service.settings import Settings
from service.store.results import ResultStore
from service.store.write_check import WriteCheck
from service.worker.process import Registry


class JobEvent(NamedTuple):
    """A state of a job as a server-sent event; it is formatted once for all streams that send it."""

    id: str
    """Mark of the state: a browser that reconnects names it (``Last-Event-ID``)."""
    text: bytes
    """The server-sent event."""
    last: bool
    """Whether nothing more happens to the job."""


@dataclass
class Streams:
    """Number of open event streams, with an upper bound; one event loop counts them, so there is no lock."""

    maximum: int = 256
    """Streams that may be open at once."""
    _open: int = 0

    def enter(self) -> bool:
        """Count one stream more; False: `maximum` streams are open already."""
        if self._open >= self.maximum:
            return False
        self._open += 1
        return True

    def leave(self) -> None:
        """Count one stream less."""
        self._open -= 1


@dataclass(frozen=True)
class Context:
    """Everything a handler may use, as the callers of one project see it.

    Jobs and results are those of `project`: handlers have no way to others.
    """

    settings: Settings
    registry: Registry
    submissions: Submissions
    scheduler: Scheduler | None
    """None: another process schedules the jobs."""
    store: ResultStore
    live: QuestionPool
    """Worker processes that compute the answers of sliders and drawings."""
    reader: QuestionPool
    """Worker processes that read files of the request's body."""
    cached_answers: KeptAnswers
    engine: Engine
    writes: WriteCheck
    watcher: Watcher[JobEvent]
    databases: OpenDatabases = field(default_factory=OpenDatabases)
    streams: Streams = field(default_factory=Streams)
    project: str = COMMON
    _projects: dict[str, Context] = field(default_factory=dict)

    def within(self, project: str) -> Context:
        """Return the context of another project."""
        if project == self.project:
            return self
        if project not in self._projects:
            jobs, store = self.submissions.within(project), self.store.within(project)
            self._projects[project] = replace(self, submissions=jobs, store=store, project=project)
        return self._projects[project]

    def wake(self) -> None:
        """Let the scheduler look for new jobs now; one in another process looks twice a second anyway."""
        if self.scheduler is not None:
            self.scheduler.wake()

    def start_waiting(self) -> None:
        """Take the questions of callers that wait for an answer, also after a stop."""
        self.live.start()
        self.reader.start()

    def stop_waiting(self) -> None:
        """End the workers of callers that wait for an answer, and the streams of events."""
        self.watcher.stop()
        self.live.stop()
        self.reader.stop()

    def close(self) -> None:
        """Close open connections, which open again on demand."""
        if self.scheduler is not None:
            self.scheduler.give_up()
        self.engine.dispose()


def context_of(request: Request) -> Context:
    """Return the context of the app that serves `request`, for the project of its caller."""
    context: Context = request.app.state.context
    key = key_of(request)
    return context if key is None else context.within(key.project)


def key_of(request: Request) -> Holder | None:
    """Return who sent a request, None on a service without keys; see `service.routes.access`."""
    return getattr(request.state, "caller", None)


def asker_of(request: Request, slider: str | None = None) -> Asker:
    """Return who asks a question by a request; `slider`: see `Asker`."""
    key = key_of(request)
    return Asker(slider=slider) if key is None else Asker(key.name, slider)


def caller_of(request: Request) -> Holder:
    """Return who submits by a request."""
    return key_of(request) or KEYLESS_CALLER


async def _caller(request: Request) -> Holder:
    return caller_of(request)


async def _context(request: Request) -> Context:
    return context_of(request)


From = Annotated[Holder, Depends(_caller)]
Ctx = Annotated[Context, Depends(_context)]
