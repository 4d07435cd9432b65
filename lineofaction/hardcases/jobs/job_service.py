"""A service for one hard scene: its settings, its processes, and its disturbance."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from structlog.testing import capture_logs

from fe_contact.ste import SteDatabase
from fe_contact.types import FloatArray
from host import kill, processes_in
from lineofaction.gearbox.schemas import Case, validated
from lineofaction.hardcases.scene import TIME_LIMIT
from service.queue.job import Job
from service.queue.machinery import job_machinery
from service.queue.scheduler import Scheduler
from service.queue.submissions import Submissions
from service.schemas.execute import AnalyzeInputs
from service.settings import Settings
from service.store.results import ResultStore
from service.worker.process import ANALYZE, default_registry

LOOK_S = 0.02
"""Seconds between two looks at a job: a mesher needs several times as long to load."""

Disturb = Callable[["JobService", Job], None]


@dataclass(frozen=True)
class JobService:
    """A service at work.

    `log`: what it has logged.
    """

    directory: Path
    submissions: Submissions
    store: ResultStore
    scheduler: Scheduler
    log: list[Any]

    def submit(self, case: dict[str, Any]) -> Job:
        """Enter the analysis of a case as the execution route does."""
        inputs = ANALYZE.prepare(AnalyzeInputs(case=validated(Case, case)), self.store)
        key = ANALYZE.key(inputs)
        stored = self.store.find(key, "database") is not None
        job = self.submissions.submit("analyze", key, inputs, stored=stored)
        self.scheduler.wake()
        return job

    def ended(self, job: Job, disturb: Disturb | None = None) -> Job:
        """Wait for a job; `disturb` is called at every look.

        Raises `TimeoutError`: it has not ended within the time a scene may take.
        """
        latest = time.monotonic() + TIME_LIMIT
        while not (state := self.submissions.find(job.id)).ended:
            if time.monotonic() > latest:
                raise TimeoutError(f"the job has not ended after {TIME_LIMIT:g} s; it says: {state.message}")
            if disturb is not None:
                disturb(self, state)
            time.sleep(LOOK_S)
        return state

    def errors(self, job: Job) -> FloatArray:
        """Return the transmission errors of a job that has succeeded."""
        file = self.store.verified(job.key, "database").path
        return SteDatabase.from_netcdf(file).static_transmission_error

    def end_processes(self) -> None:
        """Kill processes that should have ended, so that a failed scene leaves none."""
        for pid in self.processes():
            with suppress(ProcessLookupError):
                kill(pid)

    def processes(self, name: str = "") -> list[int]:
        """Return the processes at work for the service, or those of them whose command has `name`.

        Each worker, and what it starts, stands in a directory of its own below that of the service.
        """
        return processes_in(self.directory, name)


@contextmanager
def fresh_service(**settings: Any) -> Iterator[JobService]:
    """Run a service with one worker on a directory of its own, its log kept from the terminal."""
    with tempfile.TemporaryDirectory(prefix="loa-hard-jobs-") as name, capture_logs() as log:
        directory = Path(name).resolve()
        service_settings = Settings(data_directory=directory, workers=1, **settings)
        parts = job_machinery(service_settings, default_registry())
        assert parts.scheduler is not None
        service = JobService(directory, parts.submissions, parts.store, parts.scheduler, log)
        service.scheduler.start()
        try:
            yield service
        finally:
            service.scheduler.stop()
