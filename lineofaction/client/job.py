"""A job of a service, and its results."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Generic, TypeVar, cast

from lineofaction.client.job_calls import JobCalls, pace_of_known, result_of
from lineofaction.client.result_calls import ResultCalls
from lineofaction.client.status import JobState, Result, Watch, outlasting
from lineofaction.client.steps import Item, Items, Steps
from lineofaction.client.surface import Awaiting, Blocking, Surface, listing, operation
from lineofaction.gearbox.problems import BadInput, DamagedFile, JobDismissed, JobFailed, NotFound

if TYPE_CHECKING:
    import xarray

    from lineofaction.client.report import Report
    from lineofaction.gearbox.schemas.figures import Figures

T = TypeVar("T")
F = TypeVar("F", bound="Figures")
Fetched = TypeVar("Fetched")


class Followed(Surface):
    """Operations that a job of any process and a batch share."""

    state: JobState
    """State by the last answer of the service."""

    @property
    def id(self) -> str:
        """Identifier of the job."""
        return self.state.id

    @operation
    def status(self) -> Steps[JobState]:
        """Return the state of the job now; the service is not asked about a job that has ended."""
        if not self.state.ended:
            self.state = yield from JobCalls.status(self, self.id)
        return self.state

    @operation
    def dismiss(self) -> Steps[JobState]:
        """Cancel the job, unless it has ended; its work ends unless other jobs share it."""
        if not self.state.ended:
            self.state = yield from JobCalls.dismiss(self, self.id)
        return self.state

    @operation
    def relabel(self, *, title: str | None = None, tags: Sequence[str] | None = None) -> Steps[JobState]:
        """Change title and tags of the job, ended or not; None: they stay."""
        self.state = yield from JobCalls.relabel(self, self.id, title=title, tags=tags)
        return self.state

    @listing
    def events(self) -> Items[JobState]:
        """Yield the state now and whenever it changes, until the job has ended; as the client's `events`."""
        if self.state.ended:
            yield Item(self.state)
        else:
            yield from JobCalls.events(self, self.id)

    def _with_retries(self, fetch: Callable[[], Steps[Fetched]]) -> Steps[Fetched]:
        """Repeat a fetch while the service is away, within the patience of the client."""
        return outlasting(fetch, self.session.patience)

    def _watch(self, progress: Watch | None) -> Watch:
        """Return the function to call with every new state: it stores the state and reports it."""

        def store_and_report(state: JobState) -> None:
            self.state = state
            watch = progress or self.session.progress
            if watch is not None:
                watch(state)

        return store_and_report

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.id or 'cached'} {self.state}>"


class JobSurface(Followed, Generic[T, F]):
    """The calls of a job."""

    def __init__(
        self, client: Surface, state: JobState, read: Callable[[Path], T], result: Result | None = None
    ) -> None:
        self.session, self.driver, self.state = client.session, client.driver, state
        self._read, self._result = read, result

    @operation
    def wait(
        self, progress: Watch | None = None, *, timeout: float | None = None, interval: float = 0.05
    ) -> Steps[Result]:
        """Wait for the job; return where its result is; as the client's `wait`."""
        if self._result is None and self.state.status != "successful":
            pace = pace_of_known(self.session, timeout, interval)
            self._result = yield from result_of(self, self.id, self._watch(progress), pace)
        elif self._result is None:
            self._result = yield from JobCalls.result(self, self.id)
        return self._result

    @operation
    def result(self, progress: Watch | None = None, *, timeout: float | None = None) -> Steps[T]:
        """Wait for the job and return its result as an object of the library; raises as `wait`."""
        return self._read((yield from JobSurface.file(self, progress, timeout=timeout)))

    @operation
    def file(self, progress: Watch | None = None, *, timeout: float | None = None) -> Steps[Path]:
        """Wait for the job and return its netCDF file in the cache; raises as `wait`."""
        result = yield from JobSurface.wait(self, progress, timeout=timeout)
        return (yield from self._with_retries(lambda: ResultCalls.fetch_file(self, result.key, result.kind)))

    @operation
    def dataset(
        self, progress: Watch | None = None, *, timeout: float | None = None
    ) -> Steps[xarray.Dataset]:
        """Wait for the job and return its result as arrays with units and names; raises as `wait`."""
        result = yield from JobSurface.wait(self, progress, timeout=timeout)
        return (
            yield from self._with_retries(lambda: ResultCalls.fetch_dataset(self, result.key, result.kind))
        )

    @operation
    def figures(self, progress: Watch | None = None, *, timeout: float | None = None) -> Steps[F]:
        """Wait for the job and return the figures of its result, units in their names; raises as `wait`."""
        result = yield from JobSurface.wait(self, progress, timeout=timeout)
        fetch = partial(ResultCalls.fetch_figures, self, result.key, result.kind)
        return cast("F", (yield from self._with_retries(fetch)))

    @operation
    def report(self, progress: Watch | None = None, *, timeout: float | None = None) -> Steps[Report]:
        """Wait for the job and return the report on its result; notebooks show it; raises as `wait`."""
        result = yield from JobSurface.wait(self, progress, timeout=timeout)
        return (yield from self._with_retries(lambda: ResultCalls.report(self, result.key)))

    def ending(self) -> Steps[Result | None]:
        """Wait until the job has ended and its file is in the cache; return its result.

        None for a job without a result; its `result` then raises the reason.
        """
        with suppress(BadInput, JobFailed, JobDismissed, NotFound, DamagedFile):
            yield from JobSurface.file(self)
            return self._result
        return None


class Job(JobSurface[T, F], Blocking):
    """A job whose calls block."""


class AsyncJob(JobSurface[T, F], Awaiting):
    """A job whose calls are awaited."""
