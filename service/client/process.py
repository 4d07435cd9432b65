"""Processes as a client offers them: call one, submit to it, map it over many."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar, overload

from service.client.job import AsyncJob, Job
from service.client.job_calls import JobCalls
from service.client.offers import Offer
from service.client.result_calls import ResultCalls
from service.client.status import JobState, Result
from service.client.steps import Steps
from service.client.surface import Awaiting, Blocking, Surface

P = ParamSpec("P")
T = TypeVar("T")
CONCURRENCY = 8
"""Jobs of a `map` that are under way at once."""


def obtained(client: Surface, offer: Offer, inputs: dict[str, Any]) -> Steps[Any]:
    """Return the result of inputs: submit, wait, fetch, read."""
    result = yield from JobCalls.obtain(client, offer.name, inputs)
    file: Path = yield from ResultCalls.fetch_file(client, result.key, result.kind)
    return offer.read(file)


class _Mapping:
    """The jobs of one `map`: what the cache holds of the service's version is not computed again."""

    def __init__(self, client: Surface, offer: Offer, job: Callable[[JobState, Result | None], Any]) -> None:
        self._client, self._offer, self._job = client, offer, job
        self._version: str | None = None

    def ended(self, inputs: dict[str, Any]) -> Steps[Any]:
        """Return the job of inputs after it has ended, with or without a result."""
        if self._version is None:
            self._version = yield from JobCalls.version(self._client)
        session, name = self._client.session, self._offer.name
        service, cache = session.exchange.base_url, session.cache
        known = cache.recall(service, name, inputs, self._version)
        if known is not None:
            return self._job(JobState.cached(name), known)
        job = self._job((yield from JobCalls.submit(self._client, name, inputs)), None)
        found = yield from job.ending()
        if found is not None:
            cache.remember(service, name, inputs, found, self._version)
        return job


class _Calls(Generic[P, T]):
    """What both kinds of processes share."""

    def __init__(self, client: Any, offer: Offer) -> None:
        self._client, self._offer = client, offer
        self.__doc__ = offer.description
        self.__signature__ = offer.signature

    def _ended_ones(self, subjects: Iterable[Any], options: dict[str, Any], job: Any) -> Iterator[Steps[Any]]:
        """Yield the steps of a job for each subject."""
        mapping = _Mapping(self._client, self._offer, job)
        for subject in subjects:
            yield mapping.ended(self._offer.inputs(subject, **options))


class Process(_Calls[P, T]):
    """A process whose calls block."""

    _client: Blocking

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> T:
        """Submit, wait, and return the result; raises as `obtain` and `fetch_file` of the client.

        When the service cannot be reached, what it gave for the same inputs before is taken from the cache.
        """
        inputs = self._offer.inputs(*args, **kwargs)
        result: T = self._client.driver.run(obtained(self._client, self._offer, inputs))
        return result

    def submit(self, *args: P.args, **kwargs: P.kwargs) -> Job[T]:
        """Enter a job and return it; raises `BadInput`, `QueueFull`, `Unreachable`."""
        inputs = self._offer.inputs(*args, **kwargs)
        steps = JobCalls.submit(self._client, self._offer.name, inputs)
        return self._job(self._client.driver.run(steps))

    def map(
        self, subjects: Iterable[Any], *, concurrency: int = CONCURRENCY, **options: Any
    ) -> Iterator[Job[T]]:
        """Yield the ended job of every subject, in order.

        What the cache holds is not asked for again while the service has the version that gave it.

        Parameters
        ----------
        subjects : iterable
            Cases or scenes, or what the process takes first; taken as they are needed.
        concurrency : int
            Jobs that are entered and not yet yielded, at most.
        **options
            Of the process, the same for all.

        Raises
        ------
        BadInput
            A subject cannot be used; that of a job which failed is raised by its `result`.
        """
        return self._client.driver.map(self._ended_ones(subjects, options, self._job), concurrency)

    def _job(self, state: JobState, result: Result | None = None) -> Job[T]:
        """Return the job of a state."""
        return Job(self._client, state, self._offer.read, result)


class AsyncProcess(_Calls[P, T]):
    """A process whose calls are awaited; as `Process`."""

    _client: Awaiting

    async def __call__(self, *args: P.args, **kwargs: P.kwargs) -> T:
        """Submit, wait, and return the result; as of `Process`."""
        inputs = self._offer.inputs(*args, **kwargs)
        result: T = await self._client.driver.run(obtained(self._client, self._offer, inputs))
        return result

    async def submit(self, *args: P.args, **kwargs: P.kwargs) -> AsyncJob[T]:
        """Enter a job and return it; as of `Process`."""
        inputs = self._offer.inputs(*args, **kwargs)
        steps = JobCalls.submit(self._client, self._offer.name, inputs)
        return self._job(await self._client.driver.run(steps))

    def map(
        self, subjects: Iterable[Any], *, concurrency: int = CONCURRENCY, **options: Any
    ) -> AsyncIterator[AsyncJob[T]]:
        """Yield the ended job of every subject, in order; as of `Process`."""
        return self._client.driver.map(self._ended_ones(subjects, options, self._job), concurrency)

    def _job(self, state: JobState, result: Result | None = None) -> AsyncJob[T]:
        """Return the job of a state."""
        return AsyncJob(self._client, state, self._offer.read, result)


class Offered(Generic[P, T]):
    """The attribute of a client that is a process."""

    def __init__(self, offer: Offer) -> None:
        self.offer = offer
        self.__doc__ = offer.description

    @overload
    def __get__(self, client: None, owner: type) -> Offered[P, T]: ...
    @overload
    def __get__(self, client: Blocking, owner: type) -> Process[P, T]: ...
    @overload
    def __get__(self, client: Awaiting, owner: type) -> AsyncProcess[P, T]: ...
    def __get__(self, client: Any, owner: type) -> Any:
        """Return the process of a client."""
        if client is None:
            return self
        return (Process if isinstance(client, Blocking) else AsyncProcess)(client, self.offer)
