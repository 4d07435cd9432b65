"""Job table, store and scheduler of one process, put together from its settings."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import Engine

from host import require_sessions
from service.queue.claims import Claims
from service.queue.retention import Housekeeper, Retention
from service.queue.scheduler import Scheduler
from service.queue.submissions import Submissions
from service.settings import Settings
from service.store import DATABASE_FILE, ResultStore, identity_of, open_database, result_store
from service.store.database import Schema
from service.worker.cluster import RemoteWork
from service.worker.process import Registry


@dataclass(frozen=True)
class Machinery:
    """The parts of the service that work on one database and one store.

    Attributes
    ----------
    engine : Engine
    store : ResultStore
    submissions : Submissions
    scheduler : Scheduler or RemoteWork
        Not started.
    """

    engine: Engine
    store: ResultStore
    submissions: Submissions
    scheduler: Scheduler | RemoteWork

    def close(self) -> None:
        """Close what is open; it opens again when it is needed."""
        self.engine.dispose()


def job_machinery(settings: Settings, registry: Registry, *, works: bool = True) -> Machinery:
    """Open the database and put the parts together; a process that `works` has locked its data directory.

    Raises
    ------
    BadInput
        The database or the place of results is none, or they do not belong together, or the schema is another
        program's.
    DatabaseUnavailable, StoreUnavailable
        One does not answer; `DatabaseDamaged`: it has to be mended.
    Unavailable
        It works, and the system has no sessions of processes.
    """
    if works:
        require_sessions()
    engine = open_database(settings.database_address or settings.data_directory / DATABASE_FILE)
    try:
        Schema(engine).check()
        target = (settings.results_url, settings.results_cache_mb, settings.results_keys)
        store = result_store(engine, settings.data_directory, *target)
    except BaseException:
        engine.dispose()
        raise
    scheduler: Scheduler | RemoteWork = RemoteWork()
    if works:
        claims = Claims(engine, identity_of(settings.data_directory), settings.lease_s)
        scheduler = Scheduler(settings, registry, claims, store, _housekeeper(settings, engine, store))
    return Machinery(engine, store, Submissions(engine, settings.queue_limit), scheduler)


def _housekeeper(settings: Settings, engine: Engine, store: ResultStore) -> Housekeeper | None:
    """Return who removes what nobody asks for, if anything is to be removed."""
    if settings.retention_days is None:
        return None
    retention = Retention(engine, store, settings.data_directory, settings.quarantine_days)
    return Housekeeper(retention, settings.retention_days)
