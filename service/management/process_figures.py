"""Metrics of one process: its program, the process itself, its workers and its caches."""

from __future__ import annotations

import platform
import shutil
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from prometheus_client import Info, Metric
from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily
from prometheus_client.registry import Collector

from fe_contact.cache_reads import CacheReads
from fe_contact.solver_version import SOLVER_VERSION
from service.queue.scheduler import Scheduler
from service.store import ResultStore
from service.store.migrations import REVISIONS
from service.version import solver_version


def build_info() -> Info:
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
