"""A batch of a service: many jobs of one process that were entered at once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from lineofaction.client.job import AsyncJob, Followed, Job, JobSurface
from lineofaction.client.job_calls import end_of, pace_of_known
from lineofaction.client.status import JobState, Result, Watch
from lineofaction.client.steps import Steps
from lineofaction.client.surface import Awaiting, Blocking, Surface, operation
from lineofaction.gearbox.problems import ServiceError

if TYPE_CHECKING:
    from lineofaction.gearbox.schemas.figures import Figures

T = TypeVar("T")
F = TypeVar("F", bound="Figures")
J = TypeVar("J")


class _BatchSurface(Followed, Generic[T, J]):
    """The calls of a batch; `state` is the last known state of the batch as a whole."""

    def __init__(self, client: Surface, state: JobState, read: Callable[[Path], T]) -> None:
        self.session, self.driver, self.state = client.session, client.driver, state
        self._read = read

    @operation
    def wait(
        self, progress: Watch | None = None, *, timeout: float | None = None, interval: float = 0.05
    ) -> Steps[list[J]]:
        """Wait until all jobs have ended; return them in order.

        The error of a job that failed is raised when its result is read. Raises `StillRunning`,
        `Unreachable`; parameters as of the client's `wait`.
        """
        if not self.state.ended:
            pace = pace_of_known(self.session, timeout, interval)
            yield from end_of(self, self.id, self._watch(progress), pace)
        path, exchange = f"/v1/jobs/{self.id}/results", self.session.exchange

        def jobs(answer: dict[str, Any]) -> list[J]:
            return [self._job(*self._ended(index, entry)) for index, entry in enumerate(answer["jobs"])]

        return (yield from self._with_retries(lambda: exchange.read(jobs, "GET", path)))

    @operation
    def result(self, progress: Watch | None = None, *, timeout: float | None = None) -> Steps[list[T]]:
        """Wait for all jobs and return their results in order; raises the error of the first failed job."""
        results: list[Any] = []
        for index, job in enumerate((yield from _BatchSurface.wait(self, progress, timeout=timeout))):
            try:
                results.append((yield from JobSurface.result(job)))
            except ServiceError as error:
                error.add_note(f"This is job {index} of batch {self.id}; wait() returns all of them.")
                raise
        return results

    def _ended(self, index: int, entry: dict[str, Any]) -> tuple[JobState, Result | None]:
        message = entry["problem"]["detail"] if entry["problem"] else "Done."
        state = JobState(entry["jobID"], self.state.process, entry["status"], message, "", 100, 100)
        result = Result.from_json(entry["results"]) if entry["results"] else None
        return replace(state, parent=self.id, place=index), result

    def _job(self, state: JobState, result: Result | None) -> J:
        raise NotImplementedError


class Batch(_BatchSurface[T, Job[T, F]], Blocking):
    """A batch whose calls block."""

    def _job(self, state: JobState, result: Result | None) -> Job[T, F]:
        return Job(self, state, self._read, result)


class AsyncBatch(_BatchSurface[T, AsyncJob[T, F]], Awaiting):
    """A batch whose calls are awaited."""

    def _job(self, state: JobState, result: Result | None) -> AsyncJob[T, F]:
        return AsyncJob(self, state, self._read, result)
