"""Metrics of one process with its program, workers and caches, and of its database."""

from __future__ import annotations

import platform
import shutil
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from pathlib import Path

from prometheus_client import CollectorRegistry, Info, Metric, ProcessCollector, disable_created_metrics
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.registry import Collector
from sqlalchemy import Engine

from fe_contact.cache_reads import CacheReads
from fe_contact.solver_version import SOLVER_VERSION
from service.management.database_figures import database_figures, writing_figures
from service.queue.scheduler import Scheduler
from service.queue.workload import WorkloadReader
from service.settings import Settings
from service.store.migrations import REVISIONS
from service.store.results import ResultStore
from service.store.write_check import WriteCheck
from service.version import solver_version


class _Collected(Collector):
    """Figures that are read when they are requested."""

    def __init__(self, read: Callable[[], Iterable[Metric]]) -> None:
        self._read = read

    def collect(self) -> Iterable[Metric]:
        return self._read()


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
        ("loa_workers_limit", "Workers that may run at the same time", scheduler.maximum),
        ("loa_scheduler_up", "Whether the scheduler's thread runs", scheduler.alive),
        ("loa_scheduler_turn_age_seconds", age, scheduler.turn_age_s),
    ):
        yield GaugeMetricFamily(name, text, value=float(value))


def _of_space(directory: Path) -> Iterable[Metric]:
    """Yield free space and size of the data directory: workspaces, caches, results without a remote store."""
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
    """Return the metrics that every process of the service has; a process that answers requests adds more.

    Labels have values of this program only, never a caller's, so that their number is bounded.
    """
    disable_created_metrics()  # type: ignore[no-untyped-call]  # a third of the series, which no one reads
    registry = CollectorRegistry()
    ProcessCollector(registry=registry)
    registry.register(_build_info())
    for read in (
        partial(database_figures, WorkloadReader(engine)),
        partial(writing_figures, writes),
        partial(_of_store, store),
        partial(_of_space, settings.data_directory),
    ):
        registry.register(_Collected(read))
    if scheduler is not None:
        registry.register(_Collected(partial(_of_scheduler, scheduler)))
        registry.register(scheduler.figures)
    return registry
