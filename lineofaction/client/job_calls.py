"""Calls on the jobs of a service, for any process: submit, look, wait, list, dismiss."""

from __future__ import annotations

import math
import time
import uuid
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import httpx2

from lineofaction.client.event_stream import EVENT_STREAM, EventReader
from lineofaction.client.exchange import Exchange
from lineofaction.client.problem_answers import stranger
from lineofaction.client.status import (
    AWAY,
    AWAY_PAUSE_S,
    STOPS,
    JobState,
    OfflineWarning,
    Pace,
    Result,
    Watch,
    ended,
    note_continuing,
    outlasting,
)
from lineofaction.client.steps import Item, Items, Pause, Piece, Steps, Stream
from lineofaction.client.surface import Session, Surface, listing, operation
from lineofaction.gearbox.problems import BadInput, ServiceError, Unreachable
from service.version import solver_version

T = TypeVar("T")
_PAGE = 100
"""Entries that are fetched at a time."""

_LONGEST_PAUSE_S = 2.0
_REFERENCES = {"response": "document", "transmissionMode": "reference"}
"""Members of an execution by which the service answers with the address of the result."""


def pages(
    exchange: Exchange,
    path: str,
    entries: str,
    reader: Callable[[dict[str, Any]], T],
    parameters: Mapping[str, Any],
    limit: int | None,
) -> Items[T]:
    """Yield the entries of a list, at most `limit`; a page is fetched when its first entry is needed.

    Parameters
    ----------
    path, entries : str
        Path of the list; name of the entries in its pages.
    reader : callable
        JSON of an entry to the entry.
    parameters : mapping
        Query parameters of the first page.
    """

    def read(page: dict[str, Any]) -> tuple[list[T], str | None]:
        following = (link["href"] for link in page["links"] if link["rel"] == "next")
        return [reader(entry) for entry in page[entries]], next(following, None)

    left = limit
    size = _PAGE if limit is None else max(1, min(limit, _PAGE))
    batch, following = yield from exchange.read(read, "GET", path, params={**parameters, "limit": size})
    while True:
        for entry in batch[:left]:
            yield Item(entry)
        left = None if left is None else left - len(batch)
        if following is None or (left is not None and left <= 0):
            return
        batch, following = yield from exchange.read(read, "GET", following)


def pace_of_known(session: Session, timeout: float | None = None, interval: float = 0.05) -> Pace:
    """Return the pace of waiting for a job that the service has confirmed just now."""
    longest = math.inf if timeout is None else timeout
    return Pace(interval, _LONGEST_PAUSE_S, longest, session.patience, time.monotonic())


def end_of(surface: Surface, job: str, progress: Watch | None, pace: Pace) -> Steps[JobState]:
    """Wait until a job has ended with any status; raises `StillRunning`, `Unreachable`."""
    watch = progress or surface.session.progress

    def look() -> Steps[JobState]:
        state = yield from JobCalls.status(surface, job)
        if watch is not None:
            watch(state)
        return state

    return (yield from ended(job, look, pace))


def result_of(surface: Surface, job: str, progress: Watch | None, pace: Pace) -> Steps[Result]:
    """Wait for a job and return where its result is; raises as `JobCalls.wait`."""
    yield from end_of(surface, job, progress, pace)
    return (yield from outlasting(lambda: JobCalls.result(surface, job), pace.patience))


class JobCalls(Surface):
    """The steps of any process, by identifiers of jobs; inputs are JSON."""

    @operation
    def submit(
        self, process: str, inputs: dict[str, Any], *, idempotency_key: str | None = None
    ) -> Steps[JobState]:
        """Enter a job; equal work of several callers is done once.

        Repetitions of the request by the network make no further job, since the request carries an
        ``Idempotency-Key``. Raises `BadInput`: the inputs cannot be used; `QueueFull`, `Unreachable`,
        `ServiceError`.

        Parameters
        ----------
        inputs : dict
            Inputs as JSON.
        idempotency_key : str, optional
            Name of this submission: a later one of the same name is the same job. Default: a new name.
        """
        path = f"/v1/processes/{process}/execution"
        headers = {"Idempotency-Key": idempotency_key or str(uuid.uuid4())}
        request = {"json": {**self.session.terms, "inputs": inputs}, "headers": headers}
        try:
            return (yield from self.session.exchange.read(JobState.from_json, "POST", path, **request))
        except BadInput as error:
            yield from self._note_other_version(error)
            raise

    @operation
    def submit_batch(
        self, process: str, jobs: Sequence[dict[str, Any]], inputs: dict[str, Any] | None = None
    ) -> Steps[JobState]:
        """Enter many jobs of a process at once, all or none; return the state of the batch, a job itself.

        Raises `BadInput`: with the faults of all jobs, by their index: ``jobs[3].pair.pinion.teeth``;
        `QueueFull`, `Unreachable`, `ServiceError`.

        Parameters
        ----------
        jobs : sequence of dict
            For each job its inputs, or their differences from what all share, as a JSON merge patch.
        inputs : dict, optional
            Inputs that all share.
        """
        body = {**self.session.terms, "process": process, "inputs": inputs or {}, "jobs": list(jobs)}
        request = {"json": body, "headers": {"Idempotency-Key": str(uuid.uuid4())}}
        return (yield from self.session.exchange.read(JobState.from_json, "POST", "/v1/batches", **request))

    @operation
    def version(self) -> Steps[str]:
        """Return the version of the service."""
        return self.session.exchange.read(lambda answer: str(answer["version"]), "GET", "/v1/")

    @operation
    def status(self, job: str) -> Steps[JobState]:
        """Return the state of a job."""
        return self.session.exchange.read(JobState.from_json, "GET", f"/v1/jobs/{job}")

    @operation
    def dismiss(self, job: str) -> Steps[JobState]:
        """Cancel a job; its work ends unless other jobs share it."""
        return self.session.exchange.read(JobState.from_json, "DELETE", f"/v1/jobs/{job}")

    @operation
    def relabel(
        self, job: str, *, title: str | None = None, tags: Sequence[str] | None = None
    ) -> Steps[JobState]:
        """Change title and tags of a job, ended or not; None: they stay. Raises `BadInput`, `NotFound`."""
        body = {"title": title, "tags": None if tags is None else list(tags)}
        return self.session.exchange.read(JobState.from_json, "PATCH", f"/v1/jobs/{job}", json=body)

    @listing
    def jobs(
        self,
        *,
        process: Sequence[str] = (),
        status: Sequence[str] = (),
        created: str = "../..",
        tags: Sequence[str] = (),
        title: str = "",
        parent: str | None = None,
        limit: int | None = None,
    ) -> Items[JobState]:
        """Yield the states of jobs, the newest first; pages are fetched as they are needed.

        Parameters
        ----------
        process, status : sequence of str
            Only these; default: all.
        created : str
            An RFC 3339 instant, or an interval ``start/end`` with ``..`` for an open end.
        tags : sequence of str
            Only jobs that have all of these.
        title : str
            Only jobs that have all of these words in their title, in any case.
        parent : str, optional
            The batch whose jobs are wanted; default: batches, and jobs that are in none.
        limit : int, optional
            Most jobs to yield; default: all.
        """
        query = {"processID": list(process), "status": list(status), "datetime": created}
        query |= {"tag": list(tags), "title": title}
        query |= {} if parent is None else {"parent": parent}
        yield from pages(self.session.exchange, "/v1/jobs", "jobs", JobState.from_json, query, limit)

    @listing
    def events(self, job: str) -> Items[JobState]:
        """Yield the state of a job now and whenever it changes, until it has ended.

        A stream that breaks is opened again; a state that did not change meanwhile is not yielded twice.

        Raises
        ------
        NotFound
        QueueFull
            The service serves as many streams as it may.
        Unreachable
            The service was away for longer than the client's patience.
        """
        exchange, patience = self.session.exchange, self.session.patience
        last: JobState | None = None
        answered = time.monotonic()
        while True:
            try:
                stream: Stream = yield from exchange.opened(f"/v1/jobs/{job}/events", EVENT_STREAM)
                reader = EventReader()
                while (piece := (yield Piece(stream))) is not None:
                    answered = time.monotonic()
                    for state in map(JobState.from_json, reader.documents(piece)):
                        if state != last:
                            last = state
                            yield Item(state)
            except (httpx2.TransportError, *AWAY) as error:
                if last is None or time.monotonic() - answered > patience:
                    raise (
                        exchange.away(error) if isinstance(error, httpx2.TransportError) else error
                    ) from None
            except STOPS as stop:
                note_continuing(stop, job)
                raise
            else:
                if last is None:
                    raise stranger(stream.response)
            if last.ended:
                return
            yield Pause(AWAY_PAUSE_S)

    @operation
    def wait(
        self,
        job: str,
        progress: Watch | None = None,
        *,
        timeout: float | None = None,
        interval: float = 0.05,
    ) -> Steps[Result]:
        """Wait for a job and return where its result is. Whatever ends the wait, the job continues.

        Parameters
        ----------
        job : str
            Identifier of the job.
        progress : callable, optional
            Called with every state seen; default: that of the client.
        timeout : float, optional
            Seconds to wait at most.
        interval : float
            Seconds between the first two looks; later pauses grow, to 2 s.

        Raises
        ------
        BadInput, JobFailed, JobDismissed
            The job ended without a result.
        StillRunning
            It did not end within `timeout`; a TimeoutError too.
        Unreachable
            The service was away for longer than the client's patience.
        """
        known = pace_of_known(self.session, timeout, interval)
        # a service that has never answered is not waited for
        return (yield from result_of(self, job, progress, replace(known, answered=-math.inf)))

    @operation
    def result(self, job: str) -> Steps[Result]:
        """Return the reference to the result of a job; raises as `wait`, or `ResultNotReady`."""
        path = f"/v1/jobs/{job}/results"
        return self.session.exchange.read(Result.from_json, "GET", path, params=_REFERENCES)

    @operation
    def obtain(self, process: str, inputs: dict[str, Any], progress: Watch | None = None) -> Steps[Result]:
        """Return the reference to the result of inputs, computed if need be: submit, wait.

        When the service cannot be reached, the result that it gave for the same inputs before is taken, if
        its file is in the cache; an `OfflineWarning` says so. Raises as `submit` and `wait`.
        """
        service, cache = self.session.exchange.base_url, self.session.cache
        try:
            state = yield from JobCalls.submit(self, process, inputs)
            result = yield from result_of(self, state.id, progress, pace_of_known(self.session))
        except Unreachable:
            known = cache.recall(service, process, inputs)
            if known is None:
                raise
            text = f"No service answers at {service}: the {known.kind} is from the cache."
            warnings.warn(text, OfflineWarning, stacklevel=6)  # the caller of the client, above its driver
            return known
        cache.remember(service, process, inputs, result)
        return result

    def _note_other_version(self, error: BadInput) -> Steps[None]:
        """Add to a refusal that client and service are of different versions, if they are."""
        try:
            service_version = yield from JobCalls.version(self)
        except ServiceError:
            return
        if service_version != solver_version():
            error.add_note(
                f"The service is version {service_version}, this client {solver_version()}: they "
                "may differ. Install the version of the service."
            )
