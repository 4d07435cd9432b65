"""Retention: removal of ended jobs without requests, and of files that computations leave on disk."""

from __future__ import annotations

import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import structlog
from sqlalchemy import Engine, delete, exists, func, select

from lineofaction.gearbox.problems import ServiceError
from service.queue.job import ENDED
from service.queue.tables import computations, jobs, webhooks
from service.store.database import reading, writing
from service.store.deployment import Deployment
from service.store.maintenance import (
    GRACE_S,
    Leftover,
    Quarantine,
    collect_orphans,
    days_ago,
    expire_results,
    purge_quarantine,
)
from service.store.results import ResultStore
from service.store.retries import retried

logger = structlog.get_logger(__name__)

_AT_ONCE = 500
"""Jobs that one transaction removes, so that others need not wait long for the database."""
_IDENTIFIER = 36  # characters of a computation's identifier: other logs are not this program's
FIRST_S, EVERY_S = 60.0, 3600.0
"""Seconds from the start of the service to the first removal, and between removals."""


class Retention:
    """Removes results, jobs and files that a service needs no more, also while the service runs.

    It removes workspaces and logs of the data directory too. A file that is removed from the store can be
    restored from the quarantine for `quarantine_days`.
    """

    def __init__(
        self, engine: Engine, store: ResultStore, data_directory: Path, quarantine_days: float
    ) -> None:
        self._engine, self._store, self._data_directory = engine, store, data_directory
        self._quarantine = Quarantine(store.files, Deployment(engine, store), quarantine_days)

    def collect(self, older_than_days: float | None = None, *, dry_run: bool = False) -> Iterator[Leftover]:
        """Remove, or only list, leftovers and expired items.

        Leftovers are files without a row in the database, and rows without their file.
        """
        yield from collect_orphans(self._store, self._quarantine, dry_run=dry_run)
        yield from self.expire(older_than_days, dry_run=dry_run)

    def expire(self, older_than_days: float | None = None, *, dry_run: bool = False) -> Iterator[Leftover]:
        """Remove old items with a date: results, jobs, workspaces, logs, and quarantined files.

        Raises `BadInput`: another deployment has taken the files of the store over.
        """
        self._quarantine.confirm()
        if older_than_days is not None:
            yield from expire_results(self._store, self._quarantine, older_than_days, dry_run=dry_run)
            since = days_ago(older_than_days)
            while names := self._forgotten(since, dry_run=dry_run):
                yield from (Leftover("not asked for", f"job {name}", 0) for name in names)
                if dry_run:
                    break
        yield from self._of_computations(dry_run=dry_run)
        yield from purge_quarantine(self._quarantine, dry_run=dry_run)

    @retried
    def _forgotten(self, since: str, *, dry_run: bool) -> list[str]:
        """Return ended jobs that nobody requested since an instant, and remove them unless `dry_run`.

        One call removes at most `_AT_ONCE` jobs. The jobs of a batch are removed with it, never alone.
        Computations and webhooks that no job has any more are removed too.
        """
        ended = computations.c.state.in_(ENDED) & (computations.c.updated < since)
        unasked = func.coalesce(jobs.c.asked, jobs.c.created) < since
        batch = jobs.alias()
        of_no_batch = ~exists().where(batch.c.id == jobs.c.parent)  # the job is in no batch that still exists
        old = select(jobs.c.id).join(computations, jobs.c.computation_id == computations.c.id)
        with writing(self._engine, in_turn=True) as connection:
            chosen = old.where(ended, unasked, of_no_batch)
            names = list(connection.execute(chosen if dry_run else chosen.limit(_AT_ONCE)).scalars())
            if not dry_run:
                connection.execute(delete(jobs).where(jobs.c.id.in_(names) | jobs.c.parent.in_(names)))
                needed = exists().where(jobs.c.computation_id == computations.c.id)
                connection.execute(delete(computations).where(ended, ~needed))
                connection.execute(delete(webhooks).where(~exists().where(jobs.c.id == webhooks.c.job)))
        return names

    def _of_computations(self, *, dry_run: bool) -> Iterator[Leftover]:
        """Remove workspaces and logs of ended computations; logs of failed ones stay: messages name them."""
        live = self._states("accepted", "running")
        for path in self._old("work"):
            if path.name not in live:
                size = sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
                if not dry_run:
                    shutil.rmtree(path, ignore_errors=True)
                yield Leftover("workspace", f"work/{path.name}", size)
        retained = live | self._states("failed")
        for path in self._old("log"):
            if path.suffix == ".log" and len(path.stem) == _IDENTIFIER and path.stem not in retained:
                size = path.stat().st_size
                if not dry_run:
                    path.unlink(missing_ok=True)
                yield Leftover("log", f"log/{path.name}", size)

    def _old(self, folder: str) -> list[Path]:
        """Return the files of a folder that were not written for `GRACE_S` seconds."""
        directory = self._data_directory / folder
        paths = sorted(directory.iterdir()) if directory.is_dir() else []
        return [path for path in paths if time.time() - path.stat().st_mtime > GRACE_S]

    @retried
    def _states(self, *states: str) -> set[str]:
        with reading(self._engine) as connection:
            which = select(computations.c.id).where(computations.c.state.in_(states))
            return set(connection.execute(which).scalars())


class Housekeeper:
    """Thread that runs the retention of results without requests for a number of days."""

    def __init__(self, retention: Retention, days: float) -> None:
        self._retention, self._days = retention, days
        self._stopping = threading.Event()
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Begin."""
        self._stopping.clear()
        self._thread = threading.Thread(target=self._loop, name="housekeeper", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """End after the removal in progress."""
        self._stopping.set()
        if self._thread is not None:
            self._thread.join()

    def _loop(self) -> None:
        pause = FIRST_S
        while not self._stopping.wait(pause):
            pause = EVERY_S
            try:
                removed = 0
                for _ in self._retention.expire(self._days):
                    removed += 1
                    if self._stopping.is_set():
                        break
                logger.info("collected", removed=removed)
            except ServiceError as error:
                logger.warning("nothing collected", error=str(error))
            except Exception:
                logger.exception("collection failed")
