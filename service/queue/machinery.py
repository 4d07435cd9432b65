"""Job table, store and scheduler of one process, put together from its settings."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Engine

from host import require_sessions
from service.queue.claims import Claims
from service.queue.cluster import Cluster
from service.queue.crew import Children, Crew
from service.queue.retention import Housekeeper, Retention
from service.queue.scheduler import Scheduler
from service.queue.submissions import Submissions
from service.settings import Settings
from service.store.database import open_database
from service.store.deployment import Deployment
from service.store.integrity import IntegrityCheck
from service.store.ownership import Ownership
from service.store.places import DATABASE_FILE, result_store
from service.store.results import ResultStore
from service.worker.process import Registry


@dataclass(frozen=True)
class Machinery:
    """The parts that use one database and one store; a process without scheduler computes nothing."""

    engine: Engine
    store: ResultStore
    submissions: Submissions
    scheduler: Scheduler | None
    integrity: IntegrityCheck

    def close(self) -> None:
        """Close open connections, which open again on demand."""
        if self.scheduler is not None:
            self.scheduler.give_up()
        self.engine.dispose()


def job_machinery(settings: Settings, registry: Registry, *, works: bool = True) -> Machinery:
    """Open the database and put the parts together; a process that `works` has locked its data directory.

    Raises `BadInput`: database or results cannot be opened, do not belong together, have another schema, or
    another server owns the job table; `DatabaseUnavailable`, `StoreUnavailable`: one does not answer;
    `DatabaseDamaged`; and `Unavailable`: the system has no sessions of processes.
    """
    if works:
        require_sessions()
    engine = open_database(settings.database_address or settings.data_directory / DATABASE_FILE)
    try:
        integrity = IntegrityCheck(engine)
        integrity.start()
        target = (settings.results_url, settings.results_cache_mb, settings.results_keys)
        store = result_store(engine, settings.data_directory, *target)
        scheduler = _scheduler(settings, registry, engine, store) if works else None
    except BaseException:
        engine.dispose()
        raise
    return Machinery(engine, store, Submissions(engine, settings.queue_limit), scheduler, integrity)


def _scheduler(settings: Settings, registry: Registry, engine: Engine, store: ResultStore) -> Scheduler:
    """Return the scheduler of the server that owns the job table."""
    retention = Retention(engine, store, settings.data_directory, settings.quarantine_days)
    days = settings.retention_days
    housekeeper = None if days is None else Housekeeper(retention, days)
    crew = crew_of(settings, registry, Deployment(engine, store))
    owner = Ownership(engine)
    owner.acquire()
    return Scheduler(settings, registry, Claims(engine), store, owner, housekeeper, crew)


def crew_of(settings: Settings, registry: Registry, deployment: Deployment) -> Crew:
    """Return the crew that the settings name; raises `BadInput`: the Dask scheduler cannot be used."""
    if settings.scheduler is None:
        return Children(settings, registry.modules)
    cluster = Cluster(settings.scheduler, deployment.identifier() or "")
    cluster.check()
    return cluster
