"""The metrics of one process, put together from its parts."""

from __future__ import annotations

from prometheus_client import CollectorRegistry, ProcessCollector, disable_created_metrics
from sqlalchemy import Engine

from service.management.database_figures import DatabaseFigures, WriteFigures
from service.management.process_figures import SchedulerFigures, SpaceFigures, StoreFigures, build_info
from service.queue.scheduler import Scheduler
from service.queue.workload import WorkloadReader
from service.settings import Settings
from service.store import ResultStore
from service.store.write_check import WriteCheck
from service.worker.cluster import RemoteWork


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
    registry.register(build_info())
    registry.register(DatabaseFigures(WorkloadReader(engine)))
    registry.register(WriteFigures(writes))
    registry.register(StoreFigures(store))
    registry.register(SpaceFigures(settings.data_directory))
    if isinstance(scheduler, Scheduler):
        registry.register(SchedulerFigures(scheduler, settings.workers))
        registry.register(scheduler.figures)
    return registry
