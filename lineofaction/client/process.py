"""Processes as a client offers them: call one, submit to it, map it over many.

The types are those of `lineofaction.gearbox.study`: P the parameters of a call, T its result, F its figures.
`Steps` are generators that a driver of the client runs, blocking or awaiting. `outlasting` repeats steps
while the service is away.
"""

from __future__ import annotations

import uuid
from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from contextlib import aclosing, suppress
from pathlib import Path
from typing import Any, Generic

from lineofaction.client.batch import AsyncBatch, Batch
from lineofaction.client.job import AsyncJob, Job
from lineofaction.client.job_calls import JobCalls
from lineofaction.client.offers import Offer
from lineofaction.client.result_calls import ResultCalls
from lineofaction.client.status import JobState, Result, note_continuing, outlasting
from lineofaction.client.steps import Steps
from lineofaction.client.surface import Awaiting, Blocking, Surface
from lineofaction.gearbox.problems import BadInput, ServiceError
from lineofaction.gearbox.study import F, P, T

CONCURRENCY = 8
"""Largest number of jobs of a `map` that are under way at once, unless the caller sets another."""


def _at_least_one(concurrency: int) -> int:
    if concurrency < 1:
        raise BadInput.of("concurrency", concurrency, "at least 1")
    return concurrency


def obtained(client: Surface, offer: Offer, inputs: dict[str, Any]) -> Steps[Any]:
    """Return the result of inputs: submit, wait, fetch, read."""
    result = yield from JobCalls.obtain(client, offer.name, inputs)
    patience = client.session.patience
    file: Path = yield from outlasting(
        lambda: ResultCalls.fetch_file(client, result.key, result.kind), patience
    )
    return offer.read(file)


class _Mapping:
    """The jobs of one `map`; results of the service's version in the cache are not computed again.

    From the first answer on, the service may be away or busy for the client's patience.
    """

    def __init__(self, client: Surface, offer: Offer, job: Callable[[JobState, Result | None], Any]) -> None:
        self._client, self._offer, self._job = client, offer, job
        self._version: str | None = None
        self._under_way: set[str] = set()

    def all_ended(self, subjects: Iterable[Any], options: dict[str, Any]) -> Iterator[Steps[Any]]:
        """Yield the steps of a job for each subject."""
        for subject in subjects:
            yield self.ended(self._offer.inputs(subject, **options))

    def ended(self, inputs: dict[str, Any]) -> Steps[Any]:
        """Return the job of inputs after it has ended, with or without a result."""
        if self._version is None:
            self._version = yield from JobCalls.version(self._client)
        session, name = self._client.session, self._offer.name
        service, cache = session.exchange.base_url, session.cache
        known = cache.recall(service, name, inputs, self._version)
        if known is not None:
            return self._job(JobState.cached(name), known)
        job = self._job((yield from self._submitted(inputs)), None)
        self._under_way.add(job.id)
        result = yield from job.ending()
        self._under_way.discard(job.id)
        if result is not None:
            cache.remember(service, name, inputs, result, self._version)
        return job

    def dismissed(self) -> Steps[None]:
        """Dismiss the jobs under way, whose results nobody will take."""
        for job in self._under_way:
            with suppress(ServiceError, RuntimeError):  # away; the client is closed
                yield from JobCalls.dismiss(self._client, job)

    def note_continuing(self, error: BaseException) -> None:
        """Note on an error which jobs it does not end."""
        for job in sorted(self._under_way):
            note_continuing(error, job)

    def _submitted(self, inputs: dict[str, Any]) -> Steps[JobState]:
        """Enter a job, once however often it is sent; return its state."""
        key = str(uuid.uuid4())
        return outlasting(
            lambda: JobCalls.submit(self._client, self._offer.name, inputs, idempotency_key=key),
            self._client.session.patience,
        )


class _Calls(Generic[P, T, F]):
    """Construction and signature that blocking and awaiting processes share."""

    def __init__(self, client: Any, offer: Offer) -> None:
        self._client, self._offer = client, offer
        self.__doc__ = offer.description
        self.__signature__ = offer.signature

    def _entered(self, subjects: Iterable[Any], options: dict[str, Any]) -> Steps[JobState]:
        jobs = [self._offer.inputs(subject, **options) for subject in subjects]
        return JobCalls.submit_batch(self._client, self._offer.name, jobs)


class Process(_Calls[P, T, F]):
    """A process whose calls block."""

    _client: Blocking

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> T:
        """Submit, wait, and return the result; raises as `obtain` and `fetch_file` of the client.

        When the service cannot be reached, what it gave for the same inputs before is taken from the cache.
        """
        inputs = self._offer.inputs(*args, **kwargs)
        result: T = self._client.driver.run(obtained(self._client, self._offer, inputs))
        return result

    def submit(self, *args: P.args, **kwargs: P.kwargs) -> Job[T, F]:
        """Enter a job and return it; raises `BadInput`, `QueueFull`, `Unreachable`."""
        inputs = self._offer.inputs(*args, **kwargs)
        steps = JobCalls.submit(self._client, self._offer.name, inputs)
        return self._job(self._client.driver.run(steps))

    def batch(self, subjects: Iterable[Any], **options: Any) -> Batch[T, F]:
        """Enter a job for every subject at once, all or none; raises as `submit`, faults by their index.

        Parameters
        ----------
        subjects : iterable
            Cases or scenes, or another first argument of the process; at most 200.
        **options
            Options of the process, the same for all subjects.
        """
        state = self._client.driver.run(self._entered(subjects, options))
        return Batch(self._client, state, self._offer.read)

    def map(
        self, subjects: Iterable[Any], *, concurrency: int = CONCURRENCY, **options: Any
    ) -> Iterator[Job[T, F]]:
        """Yield the ended job of every subject, in order.

        What the cache holds is not computed again while the service has the version that gave it. A loop
        that is left early dismisses the jobs under way; an error notes which of them continue. Raises
        `BadInput`: a subject cannot be used. The error of a failed job is raised by the `result` of the job.

        Parameters
        ----------
        subjects : iterable
            Cases or scenes, or another first argument of the process; taken as they are needed.
        concurrency : int
            Jobs that are entered and not yet yielded, at most.
        **options
            Options of the process, the same for all subjects.
        """
        mapping, driver = _Mapping(self._client, self._offer, self._job), self._client.driver
        try:
            yield from driver.map(mapping.all_ended(subjects, options), _at_least_one(concurrency))
        except GeneratorExit:
            driver.run(mapping.dismissed())
            raise
        except BaseException as error:
            mapping.note_continuing(error)
            raise

    def _job(self, state: JobState, result: Result | None = None) -> Job[T, F]:
        return Job(self._client, state, self._offer.read, result)


class AsyncProcess(_Calls[P, T, F]):
    """A process whose calls are awaited; as `Process`."""

    _client: Awaiting

    async def __call__(self, *args: P.args, **kwargs: P.kwargs) -> T:
        """Submit, wait, and return the result; as of `Process`."""
        inputs = self._offer.inputs(*args, **kwargs)
        result: T = await self._client.driver.run(obtained(self._client, self._offer, inputs))
        return result

    async def submit(self, *args: P.args, **kwargs: P.kwargs) -> AsyncJob[T, F]:
        """Enter a job and return it; as of `Process`."""
        inputs = self._offer.inputs(*args, **kwargs)
        steps = JobCalls.submit(self._client, self._offer.name, inputs)
        return self._job(await self._client.driver.run(steps))

    async def batch(self, subjects: Iterable[Any], **options: Any) -> AsyncBatch[T, F]:
        """Enter a job for every subject at once, all or none; as of `Process`."""
        state = await self._client.driver.run(self._entered(subjects, options))
        return AsyncBatch(self._client, state, self._offer.read)

    async def map(
        self, subjects: Iterable[Any], *, concurrency: int = CONCURRENCY, **options: Any
    ) -> AsyncIterator[AsyncJob[T, F]]:
        """Yield the ended job of every subject, in order; as of `Process`.

        A loop that is left early closes this when it is collected; `contextlib.aclosing` closes it at once.
        """
        mapping, driver = _Mapping(self._client, self._offer, self._job), self._client.driver
        jobs = driver.map(mapping.all_ended(subjects, options), _at_least_one(concurrency))
        try:
            async with aclosing(jobs):
                async for job in jobs:
                    yield job
        except GeneratorExit:
            await driver.run(mapping.dismissed())
            raise
        except BaseException as error:
            mapping.note_continuing(error)
            raise

    def _job(self, state: JobState, result: Result | None = None) -> AsyncJob[T, F]:
        return AsyncJob(self._client, state, self._offer.read, result)
