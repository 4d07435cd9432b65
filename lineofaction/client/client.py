"""The clients of one service: one whose calls block, one whose calls are awaited."""

from __future__ import annotations

import os
from collections.abc import Sequence
from copy import copy
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import httpx2

from host.directories import cache_home
from lineofaction.client.batch import AsyncBatch, Batch
from lineofaction.client.cache import ResultCache
from lineofaction.client.drivers import AwaitingDriver, BlockingDriver
from lineofaction.client.exchange import Exchange
from lineofaction.client.job import AsyncJob, Job
from lineofaction.client.job_calls import JobCalls
from lineofaction.client.lookup_calls import LookupCalls
from lineofaction.client.offers import offers, reader_of
from lineofaction.client.page_address import PageCalls
from lineofaction.client.process import AsyncProcess, Process
from lineofaction.client.result_calls import ResultCalls
from lineofaction.client.scene_calls import SceneCalls
from lineofaction.client.status import Watch
from lineofaction.client.surface import Awaiting, Blocking, Session
from lineofaction.gearbox.problems import BadInput
from lineofaction.gearbox.registry import Studies
from lineofaction.gearbox.study import F, Offered, P
from lineofaction.gearbox.study import T as Answer
from service.origin import is_loopback
from service.version import solver_version

if TYPE_CHECKING:
    from dynamics.results import RunResult
    from fe_contact.ste import SteDatabase
    from lineofaction.gearbox.schemas.figures import RunFigures, TableFigures
    from lineofaction.gearbox.subjects import CaseLike, SceneLike

DEFAULT = "http://127.0.0.1:8321"


def _http_options(base_url: str | None, timeout: float, key: str | None) -> dict[str, Any]:
    """Return the arguments of an httpx2 client, blocking or awaiting, of one service.

    Proxies and certificates are those of the environment (``HTTPS_PROXY``, ``NO_PROXY``, ``SSL_CERT_FILE``).
    Requests to a service on this machine take no proxy.
    """
    address = base_url or os.environ.get("LOA_SERVICE") or DEFAULT
    key = key or os.environ.get("LOA_KEY")
    agent = {"User-Agent": f"lineofaction/{solver_version()}"}
    return {
        "base_url": address.rstrip("/"),
        "headers": agent | ({"Authorization": f"Bearer {key}"} if key else {}),
        "timeout": timeout,
        "trust_env": not is_loopback(_host(address)),
    }


def _host(base_url: str) -> str:
    try:
        url = httpx2.URL(base_url)
    except httpx2.InvalidURL:
        url = httpx2.URL()
    if url.scheme not in ("http", "https") or not url.host:
        remedy = "Begin it with http:// or https://."
        raise BadInput.of("service", base_url, "an address such as http://127.0.0.1:8321", remedy)
    return url.host


class Client(Studies, JobCalls, ResultCalls, PageCalls, LookupCalls, SceneCalls):
    """All calls of a client.

    Raises `BadInput`: `base_url` is no address of HTTP.

    Parameters
    ----------
    base_url : str, optional
        Address of the service; default: the environment variable ``LOA_SERVICE``, else
        ``http://127.0.0.1:8321``.
    cache_dir : str or Path, optional
        Folder of fetched results; default: the user's cache directory.
    transport : httpx2.BaseTransport or httpx2.AsyncBaseTransport, optional
        Replaces the network, for tests.
    timeout : float
        Seconds that connecting, sending, or the next piece of an answer may take.
    attempts : int
        Number of times a request is sent before the service counts as unreachable.
    patience : float
        Seconds for which the service may be away while a job is waited for: jobs outlast its restart.
    key : str, optional
        Access key of the service; default: the environment variable ``LOA_KEY``.
    progress : callable, optional
        Called with every state seen of any job that is waited for; see `progress_bars`.
    """

    analyze: Offered[[CaseLike], SteDatabase, TableFigures] = Offered()
    simulate: Offered[[SceneLike], RunResult, RunFigures] = Offered()

    def __init__(
        self,
        base_url: str | None = None,
        *,
        cache_dir: str | Path | None = None,
        transport: Any = None,
        timeout: float = 30.0,
        attempts: int = 4,
        patience: float = 60.0,
        key: str | None = None,
        progress: Watch | None = None,
    ) -> None:
        options = _http_options(base_url, timeout, key)
        cache = ResultCache(cache_home() / "results" if cache_dir is None else Path(cache_dir))
        self.session = Session(Exchange(options["base_url"], attempts), cache, patience, progress)
        self._connect(transport, options)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.session.exchange.base_url}>"

    def _connect(self, transport: Any, options: dict[str, Any]) -> None:
        raise NotImplementedError

    def with_terms(
        self, *, title: str = "", tags: Sequence[str] = (), priority: int = 0, max_cost_s: float | None = None
    ) -> Self:
        """Return this client with terms for its submissions; both share connections and cache.

        Parameters
        ----------
        title : str
            Name of its jobs, up to 200 characters.
        tags : sequence of str
            Tags by which lists find the jobs: up to 16, each of up to 40 letters, digits and ``._:/+-``.
        priority : int
            -9 to 9: the next job is the oldest of those that wait with the highest priority.
        max_cost_s : float, optional
            CPU seconds that each job may take; default: no limit.
        """
        view = copy(self)
        view.session = replace(
            self.session,
            terms={"title": title, "tags": list(tags), "priority": priority, "max_cost_s": max_cost_s},
        )
        return view


class LineOfActionClient(Client, Blocking):
    """A service whose calls block; threads may share one."""

    def _connect(self, transport: httpx2.BaseTransport | None, options: dict[str, Any]) -> None:
        self.driver = BlockingDriver(transport, options)

    def process(self, offered: Offered[P, Answer, F]) -> Process[P, Answer, F]:
        """Return the process of a study, such as `loa.modes`; it is also the attribute `modes`."""
        return Process(self, offers()[offered.name])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections."""
        self.driver.close()

    def job(self, identifier: str) -> Job[Any, Any]:
        """Return a job by its identifier; raises `NotFound`."""
        state = self.status(identifier)
        return Job(self, state, reader_of(state.process))

    def batch(self, identifier: str) -> Batch[Any, Any]:
        """Return a batch by its identifier; raises `NotFound`."""
        state = self.status(identifier)
        return Batch(self, state, reader_of(state.process))


class AsyncLineOfActionClient(Client, Awaiting):
    """A service whose calls are awaited, in one event loop."""

    def _connect(self, transport: httpx2.AsyncBaseTransport | None, options: dict[str, Any]) -> None:
        self.driver = AwaitingDriver(transport, options)

    def process(self, offered: Offered[P, Answer, F]) -> AsyncProcess[P, Answer, F]:
        """Return the process of a study, such as `loa.modes`; it is also the attribute `modes`."""
        return AsyncProcess(self, offers()[offered.name])

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Close the connections."""
        await self.driver.close()

    async def job(self, identifier: str) -> AsyncJob[Any, Any]:
        """Return a job by its identifier; raises `NotFound`."""
        state = await self.status(identifier)
        return AsyncJob(self, state, reader_of(state.process))

    async def batch(self, identifier: str) -> AsyncBatch[Any, Any]:
        """Return a batch by its identifier; raises `NotFound`."""
        state = await self.status(identifier)
        return AsyncBatch(self, state, reader_of(state.process))
