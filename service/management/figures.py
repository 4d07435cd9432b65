"""Metrics of a service: of its database, and of one process with its program, workers and caches."""

from __future__ import annotations

import platform
import shutil
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from prometheus_client import CollectorRegistry, Info, Metric, ProcessCollector, disable_created_metrics
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, HistogramMetricFamily
from prometheus_client.registry import Collector
from sqlalchemy import Engine

from fe_contact.cache_reads import CacheReads
from fe_contact.solver_version import SOLVER_VERSION
from lineofaction.gearbox.problems import DatabaseUnavailable
from service.queue.scheduler import Scheduler
from service.queue.workload import Workload, WorkloadReader
from service.settings import Settings
from service.store import ResultStore
from service.store.migrations import REVISIONS
from service.store.write_check import WriteCheck
from service.version import solver_version
from service.worker.cluster import RemoteWork

# Metrics of the database and the store: equal for all processes on them.


_STATES = ("accepted", "running", "successful", "failed", "dismissed")
_ENDED = ["process", "outcome"]


class DatabaseFigures(Collector):
    """Metrics of the database, read when requested; without one, that it is gone."""

    def __init__(self, workload: WorkloadReader) -> None:
        self._workload = workload

    def collect(self) -> Iterable[Metric]:
        """Return the figures."""
        up = GaugeMetricFamily("loa_database_up", "Whether the database answers this process")
        try:
            load = self._workload.read()
        except DatabaseUnavailable:
            up.add_metric([], 0)
            yield up
            return
        up.add_metric([], 1)
        yield up
        yield from _queue(load)
        yield from _ended(load)
        yield from _results(load)


class WriteFigures(Collector):
    """Metrics of writing, tried when requested."""

    def __init__(self, writes: WriteCheck) -> None:
        self._writes = writes

    def collect(self) -> Iterable[Metric]:
        """Return a figure for each part."""
        outcome = self._writes.outcome()
        text = "Whether this process can write to the database, and to the place of results"
        writable = GaugeMetricFamily("loa_writable", text, labels=["part"])
        writable.add_metric(["database"], float(not outcome.database))
        writable.add_metric(["results"], float(not outcome.results))
        yield writable


def _queue(load: Workload) -> Iterable[Metric]:
    """Return what waits, runs and has ended."""
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
    """Return how long computations took, and in how many attempts."""
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
    """Return what is stored."""
    number = GaugeMetricFamily("loa_results", "Results in the store", labels=["kind"])
    size = GaugeMetricFamily("loa_result_bytes", "Bytes of results in the store", labels=["kind"])
    for kind, count, total in load.results:
        number.add_metric([kind], count)
        size.add_metric([kind], total)
    return number, size


# The metrics of one process, put together from its parts.


def _build_info() -> Info:
    """Return the versions of what runs."""
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


class SchedulerFigures(Collector):
    """The workers of a scheduler now."""

    def __init__(self, scheduler: Scheduler, most_workers: int) -> None:
        self._scheduler, self._most = scheduler, most_workers

    def collect(self) -> Iterable[Metric]:
        """Return the figures."""
        scheduler = self._scheduler
        age = "Seconds since the scheduler's last turn"
        for name, text, value in (
            ("loa_workers_busy", "Workers that run", scheduler.busy),
            ("loa_workers_limit", "Workers that may run at the same time (LOA_WORKERS)", self._most),
            ("loa_workers_warm", "Warm processes that workers are forked from", scheduler.warm),
            ("loa_scheduler_up", "Whether the scheduler's thread runs", scheduler.alive),
            ("loa_scheduler_turn_age_seconds", age, scheduler.turn_age_s),
        ):
            yield GaugeMetricFamily(name, text, value=float(value))


class SpaceFigures(Collector):
    """The file system of the data directory: workspaces, caches, and results that have no other place."""

    def __init__(self, data_directory: Path) -> None:
        self._directory = data_directory

    def collect(self) -> Iterable[Metric]:
        """Return the figures; none while the directory is not there."""
        with suppress(OSError):
            space = shutil.disk_usage(self._directory)
            yield GaugeMetricFamily("loa_data_free_bytes", "Free space of the data directory", space.free)
            yield GaugeMetricFamily("loa_data_size_bytes", "Size of its file system", space.total)


class StoreFigures(Collector):
    """What this process looked for in the store."""

    def __init__(self, store: ResultStore) -> None:
        self._store = store

    def collect(self) -> Iterable[Metric]:
        """Return the figures."""
        yield _reads("loa_result_lookups", "Results looked for in the store", self._store.lookups)
        text = "Files of a remote store looked for in the cache of this machine"
        yield _reads("loa_file_cache_reads", text, self._store.files.reads)


def _reads(name: str, text: str, reads: CacheReads) -> CounterMetricFamily:
    """Return hits and misses."""
    family = CounterMetricFamily(name, text, labels=["outcome"])
    family.add_metric(["hit"], reads.hits)
    family.add_metric(["miss"], reads.misses)
    return family


def process_registry(
    engine: Engine,
    store: ResultStore,
    writes: WriteCheck,
    scheduler: Scheduler | RemoteWork,
    settings: Settings,
) -> CollectorRegistry:
    """Return the metrics that every process of the service has; who answers requests adds those.

    Labels have values of this program only, never a caller's, so that their number is bounded.
    """
    disable_created_metrics()  # type: ignore[no-untyped-call]  # a third of the series, which no one reads
    registry = CollectorRegistry()
    ProcessCollector(registry=registry)
    registry.register(_build_info())
    registry.register(DatabaseFigures(WorkloadReader(engine)))
    registry.register(WriteFigures(writes))
    registry.register(StoreFigures(store))
    registry.register(SpaceFigures(settings.data_directory))
    if isinstance(scheduler, Scheduler):
        registry.register(SchedulerFigures(scheduler, settings.workers))
        registry.register(scheduler.figures)
    return registry
