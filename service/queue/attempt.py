"""One attempt at a computation: its claim, its worker, and where they work."""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path

import structlog

from lineofaction.gearbox.stages import PacedFraction
from service.queue.attempt_trace import AttemptTrace
from service.queue.claims import Claim
from service.queue.worker_figures import WorkerFigures
from service.settings import LEAST_MEMORY_MB, Settings
from service.tracing.traceparent import trace_facts
from service.worker.child_process import Launch
from service.worker.memory import machine_memory_mb
from service.worker.order import USABLE, WorkOrder
from service.worker.process import Process
from service.worker.worker import Worker

logger = structlog.get_logger(__name__)


@dataclass(frozen=True)
class Attempt:
    """A claim and the process that works on it.

    Attributes
    ----------
    claim : Claim
    worker : Worker
    workspace : Path
        Directory of the computation alone.
    log : Path
        What the worker writes to its standard error.
    figures : WorkerFigures
        Where its start and end are counted.
    trace : AttemptTrace
        Its spans.
    fraction : PacedFraction
        Of the work, where it does not predict its cost.
    """

    claim: Claim
    worker: Worker
    workspace: Path
    log: Path
    figures: WorkerFigures
    trace: AttemptTrace
    fraction: PacedFraction

    def note_end(self, how: str) -> None:
        """Count and log how the worker ended and, if it has been reaped, what it took."""
        self.figures.ended(self.claim.process, how, self.worker)
        self.trace.end(how, self.worker.usage)
        usage = {} if self.worker.usage is None else self.worker.usage.as_json()
        logger.info(
            "worker ended",
            computation=self.claim.id,
            process=self.claim.process,
            pid=self.worker.pid,
            attempt=self.claim.attempts,
            outcome=how,
            **usage,
            **trace_facts(self.claim.traceparent),
        )


def begun(
    settings: Settings, process: Process, claim: Claim, launch: Launch, figures: WorkerFigures
) -> Attempt:
    """Launch a worker for a claim; raises what keeps the system from it."""
    workspace = workspace_of(settings, claim)
    log = settings.data_directory / "log" / f"{claim.id}.log"
    workspace.mkdir(parents=True, exist_ok=True)
    launched = time.time()  # before the worker can reach its first stage
    worker = Worker(_order(settings, process.entry, claim), log, launch)
    figures.started(claim.process)
    facts = {"computation": claim.id, "process": claim.process, "key": claim.key}
    facts |= trace_facts(claim.traceparent)
    logger.info("worker started", **facts, pid=worker.pid, attempt=claim.attempts)
    trace = AttemptTrace(claim, worker.pid, launched)
    return Attempt(claim, worker, workspace, log, figures, trace, PacedFraction(process.stages))


def workspace_of(settings: Settings, claim: Claim) -> Path:
    """Directory of a computation, the same for all its attempts."""
    return settings.data_directory / "work" / claim.id


def _order(settings: Settings, entry: str, claim: Claim) -> WorkOrder:
    """Return the order of a claim."""
    return WorkOrder(
        entry=entry,
        inputs=claim.inputs,
        key=claim.key,
        project=claim.project,
        workspace=workspace_of(settings, claim),
        data_directory=settings.data_directory,
        memory_limit_mb=_memory_mb(settings),
        database_url=settings.database_address,
        results_url=settings.results_url,
        results_keys=settings.results_keys,
        lease_until=claim.asked + USABLE * settings.lease_s,
        dask_scheduler=settings.dask_scheduler,
    )


def _memory_mb(settings: Settings) -> int:
    """Return what one worker may have, MB: what is set, or its share of the machine's memory."""
    if settings.memory_limit_mb is not None:
        return settings.memory_limit_mb
    return max(LEAST_MEMORY_MB, machine_memory_mb() // settings.workers)
