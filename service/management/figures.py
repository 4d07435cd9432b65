"""Metrics of a service: of its database, of one process with its program, workers and caches, of requests."""

from __future__ import annotations

import os
import platform
import shutil
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any

from prometheus_client import (
    CollectorRegistry,
    Counter,
    Gauge,
    Histogram,
    Info,
    Metric,
    ProcessCollector,
    disable_created_metrics,
    generate_latest,
)
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily
from prometheus_client.multiprocess import MultiProcessCollector
from prometheus_client.registry import Collector
from sqlalchemy import Engine

from fe_contact.cache_reads import CacheReads
from fe_contact.solver_version import SOLVER_VERSION
from lineofaction.gearbox.problems import DatabaseUnavailable, ServiceError, last_part
from service.queue.scheduler import Scheduler
from service.queue.workload import Workload, WorkloadReader
from service.settings import Settings
from service.store.deployment import WriteCheck
from service.store.migrations import REVISIONS
from service.store.results import ResultStore
from service.version import solver_version

# Metrics of the database and the store: equal for all processes on them.


_STATES = ("accepted", "running", "successful", "failed", "dismissed")
_ENDED = ["process", "outcome"]
_METHODS = frozenset(("GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "CONNECT"))
"""Of RFC 9110 and RFC 5789; a caller may send any word."""


class _Collected(Collector):
    """Figures that are read when they are requested."""

    def __init__(self, read: Callable[[], Iterable[Metric]]) -> None:
        self._read = read

    def collect(self) -> Iterable[Metric]:
        return self._read()


def _of_database(workload: WorkloadReader) -> Iterable[Metric]:
    """Yield figures of the database; without one, that it is gone."""
    up = GaugeMetricFamily("loa_database_up", "Whether the database answers this process")
    try:
        load = workload.read()
    except DatabaseUnavailable:
        up.add_metric([], 0)
        yield up
        return
    up.add_metric([], 1)
    yield up
    yield from _queue(load)
    yield from _ended(load)
    yield from _results(load)


def _of_writing(writes: WriteCheck) -> Iterable[Metric]:
    outcome = writes.outcome()
    text = "Whether this process can write to the database, and to the place of results"
    writable = GaugeMetricFamily("loa_writable", text, labels=["part"])
    writable.add_metric(["database"], float(not outcome.database))
    writable.add_metric(["results"], float(not outcome.results))
    yield writable


def _queue(load: Workload) -> Iterable[Metric]:
    states = GaugeMetricFamily("loa_computations", "Computations by state", labels=["state"])
    for state in _STATES:
        states.add_metric([state], load.states.get(state, 0))
    depth = GaugeMetricFamily(
        "loa_queue_depth", "Computations that wait or run, by process", labels=["state", "process"]
    )
    for (state, process), number in sorted(load.queue.items()):
        depth.add_metric([state, process], number)
    oldest = GaugeMetricFamily("loa_oldest_waiting_seconds", "Age of the oldest waiting computation")
    oldest.add_metric([], load.oldest_waiting_s)
    return states, depth, oldest


def _ended(load: Workload) -> Iterable[Metric]:
    text = "Computations that ended, from their first start"
    taken = HistogramMetricFamily("loa_computation_seconds", text, labels=_ENDED)
    attempts = CounterMetricFamily(
        "loa_computation_attempts", "Attempts at computations that ended", labels=_ENDED
    )
    for entry in load.durations:
        names = [entry.process, entry.outcome]
        taken.add_metric(names, list(entry.buckets), entry.seconds)
        attempts.add_metric(names, entry.attempts)
    return taken, attempts


def _results(load: Workload) -> Iterable[Metric]:
    number = GaugeMetricFamily("loa_results", "Results in the store", labels=["kind"])
    size = GaugeMetricFamily("loa_result_bytes", "Bytes of results in the store", labels=["kind"])
    for kind, count, total in load.results:
        number.add_metric([kind], count)
        size.add_metric([kind], total)
    return number, size


# The metrics of one process, put together from its parts.


def _build_info() -> Info:
    info = Info("loa_build", "Versions of the program, its interpreter, solver and tables", registry=None)
    info.info(
        {
            "version": solver_version(),
            "python": platform.python_version(),
            "solver": SOLVER_VERSION,
            "schema": REVISIONS[-1],
        }
    )
    return info


def _of_scheduler(scheduler: Scheduler) -> Iterable[Metric]:
    age = "Seconds since the scheduler's last turn"
    for name, text, value in (
        ("loa_workers_busy", "Workers that run", scheduler.busy),
        ("loa_workers_limit", "Workers that may run at the same time", scheduler.most),
        ("loa_scheduler_up", "Whether the scheduler's thread runs", scheduler.alive),
        ("loa_scheduler_turn_age_seconds", age, scheduler.turn_age_s),
    ):
        yield GaugeMetricFamily(name, text, value=float(value))


def _of_space(directory: Path) -> Iterable[Metric]:
    """Yield the space of the data directory: workspaces, caches, and results that have no other place."""
    with suppress(OSError):  # while the directory is not there
        space = shutil.disk_usage(directory)
        yield GaugeMetricFamily("loa_data_free_bytes", "Free space of the data directory", space.free)
        yield GaugeMetricFamily("loa_data_size_bytes", "Size of its file system", space.total)


def _of_store(store: ResultStore) -> Iterable[Metric]:
    yield _reads("loa_result_lookups", "Results looked for in the store", store.lookups)
    text = "Files of a remote store looked for in the cache of this machine"
    yield _reads("loa_file_cache_reads", text, store.files.reads)


def _reads(name: str, text: str, reads: CacheReads) -> CounterMetricFamily:
    family = CounterMetricFamily(name, text, labels=["outcome"])
    family.add_metric(["hit"], reads.hits)
    family.add_metric(["miss"], reads.misses)
    return family


def process_registry(
    engine: Engine,
    store: ResultStore,
    writes: WriteCheck,
    scheduler: Scheduler | None,
    settings: Settings,
) -> CollectorRegistry:
    """Return the metrics that every process of the service has; who answers requests adds those.

    Labels have values of this program only, never a caller's, so that their number is bounded.
    """
    disable_created_metrics()  # type: ignore[no-untyped-call]  # a third of the series, which no one reads
    registry = CollectorRegistry()
    ProcessCollector(registry=registry)
    registry.register(_build_info())
    for read in (
        partial(_of_database, WorkloadReader(engine)),
        partial(_of_writing, writes),
        partial(_of_store, store),
        partial(_of_space, settings.data_directory),
    ):
        registry.register(_Collected(read))
    if scheduler is not None:
        registry.register(_Collected(partial(_of_scheduler, scheduler)))
        registry.register(scheduler.figures)
    return registry


# Metrics of the requests that this process answers.


class Metrics:
    """Metrics of one app.

    `process`: with the metrics of its process. Those of requests are of the process, or, where several serve
    on one socket, the sums over all of them.
    """

    def __init__(self, process: CollectorRegistry) -> None:
        self._process, self._registry = process, CollectorRegistry()
        self._answered = self._registry
        if "PROMETHEUS_MULTIPROC_DIR" in os.environ:  # see `lineofaction.cli.serve`
            self._answered = CollectorRegistry()
            MultiProcessCollector(self._answered)  # type: ignore[no-untyped-call]
        labels = ["method", "route", "status"]
        self._requests = Counter("loa_requests", "Requests answered", labels, registry=self._registry)
        text = "Time to answer, event streams left out"
        self._seconds = Histogram("loa_request_seconds", text, labels, registry=self._registry)
        self._problems = Counter(
            "loa_problems", "Requests answered with a problem", ["problem"], registry=self._registry
        )
        for kind in sorted(_kinds(ServiceError)):
            self._problems.labels(kind)  # rates count from 0, not from the first time
        sums: dict[str, Any] = {"registry": self._registry, "multiprocess_mode": "livesum"}
        self._open = Gauge("loa_event_streams", "Open event streams", ["route"], **sums)
        self._events = Counter("loa_events", "Events sent", ["route"], registry=self._registry)
        self._connections = Gauge("loa_connections", "Open HTTP connections", **sums)
        self._dropped = Counter(
            "loa_dropped_connections", "Idle connections closed to admit others", registry=self._registry
        )

    def observe(self, method: str, route: str, status: int, seconds: float | None) -> None:
        """Note one answered request; None: it was a stream, which lasts as long as its reader likes."""
        labels = (method if method in _METHODS else "other", route, str(status))
        self._requests.labels(*labels).inc()
        if seconds is not None:
            self._seconds.labels(*labels).observe(seconds)

    def refused(self, problem: str) -> None:
        """Note the kind of problem of an answer."""
        self._problems.labels(problem).inc()

    def streams(self, route: str, change: int) -> None:
        """Note an event stream that opened (1) or ended (-1)."""
        self._open.labels(route).inc(change)

    def sent(self, route: str, events: int) -> None:
        """Note events of a stream."""
        self._events.labels(route).inc(events)

    def connected(self, change: int) -> None:
        """Note a connection that was made (1) or lost (-1)."""
        self._connections.inc(change)

    def dropped(self) -> None:
        """Note an idle connection that made room for another."""
        self._dropped.inc()

    def text(self) -> bytes:
        """Return all figures in the text exposition format."""
        return generate_latest(self._answered) + generate_latest(self._process)


def _kinds(problem: type[ServiceError]) -> set[str]:
    return {last_part(problem.type)}.union(*(_kinds(below) for below in problem.__subclasses__()))
