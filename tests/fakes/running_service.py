"""What the tests of the service share: the job machinery on a fresh directory, waiting, processes."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sqlalchemy import Engine

from service.queue.claims import Claim, Claims, Reached
from service.queue.job import Job
from service.queue.scheduler import Scheduler
from service.queue.submissions import Submissions
from service.settings import Settings
from service.store.database import open_database
from service.store.ownership import Ownership
from service.store.places import result_store
from service.store.results import ResultStore
from service.worker.process import Registry

REFERENCES = {"response": "document", "transmissionMode": "reference"}
"""Parameters of a job's results: where they are, whatever form was requested."""
PATIENCE_S = 300.0
"""Many times what a busy machine needs: a hang, not a speed, is what this finds."""


@dataclass(frozen=True)
class Bench:
    """The job machinery without HTTP."""

    settings: Settings
    submissions: Submissions
    claims: Claims
    store: ResultStore
    scheduler: Scheduler
    engine: Engine

    def submit(self, **wish: Any) -> Job:
        inputs = {"wish": {"mode": "write", "text": "", "number": 0.0, **wish}}
        key = self._registry()["fake"].key(inputs)
        stored = self.store.find(key, "database") is not None
        job = self.submissions.submit("fake", key, inputs, stored=stored)
        self.scheduler.wake()
        return job

    def ended(self, job: Job) -> Job:
        until(lambda: self.submissions.find(job.id).ended)
        return self.submissions.find(job.id)

    def claimed(self) -> Claim:
        """Claim the computation whose turn it is."""
        claim = self.claims.claim()
        assert claim is not None
        return claim

    def reach(self, claim: Claim, fraction: float, whole: float) -> None:
        """Note that a claim has come so far in its first stage and as a whole."""
        self.claims.progress([(claim, Reached("first", fraction, whole))])

    def close(self) -> None:
        if self.scheduler.alive:
            self.scheduler.stop()
        self.scheduler.give_up()
        self.engine.dispose()

    def starts(self, job: Job) -> list[str]:
        file = self.settings.data_directory / f"started_{job.key[:8]}"
        return file.read_text().splitlines() if file.exists() else []

    def again(self) -> Bench:
        """Return a new scheduler on the same directory, as after a restart."""
        scheduler = Scheduler(
            self.settings, self._registry(), self.claims, self.store, Ownership(self.engine)
        )
        return replace(self, scheduler=scheduler)

    def _registry(self) -> Registry:
        return self.scheduler._registry


def bench(directory: Path, registry: Registry, results: Path | None = None, **settings: Any) -> Bench:
    """Return the machinery on a directory; its scheduler is not started."""
    chosen = Settings(data_directory=directory, **settings)
    directory.mkdir(parents=True, exist_ok=True)
    engine = open_database(chosen.database_address or directory / "service.sqlite3")
    try:
        store = result_store(engine, directory, results.as_uri() if results else chosen.results_url)
    except BaseException:
        engine.dispose()
        raise
    claims = Claims(engine)
    scheduler = Scheduler(chosen, registry, claims, store, Ownership(engine))
    return Bench(chosen, Submissions(engine, chosen.queue_limit), claims, store, scheduler, engine)


def until(condition: Callable[[], bool]) -> None:
    """Wait for a condition; fail if it never comes true."""
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def lives(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state not in ("Z", "X")
