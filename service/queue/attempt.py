"""One attempt at a computation: its claim, its worker, its directory, its log and its trace.

A *claim* is a computation that this process has taken from the queue. A *trace* (OpenTelemetry) is a tree of
*spans*, intervals of time with attributes: one for the wait in the queue, one for the attempt, and in it one
for each stage. Times are s since 1970.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import structlog
from opentelemetry.trace import Span

from bounds import engineering
from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.stages import PacedFraction
from model_studies.progress import stage_name
from service.queue.claims import Claim, Claims
from service.queue.crew import Crew, Run
from service.queue.terms import LOWER_COST
from service.queue.worker_figures import WorkerFigures
from service.settings import Settings
from service.store.results import ResultStore
from service.tracing import Fact, begun_span, end_span, trace_fields, traceparent_of
from service.worker.order import WorkOrder
from service.worker.process import Process
from service.worker.usage import Usage
from service.worker.worker import Step

logger = structlog.get_logger(__name__)
files_read = on_demand("service.worker.preparations:files_read")


_START = "start"
"""Stage before the first report: the process starts and loads its program."""
_MAX_STAGES = 200
"""Most spans of stages of one attempt; later stages are part of the last span."""


class _AttemptTrace:
    """The spans of one attempt, whose worker was `launched` at a time; stages begin then at the earliest."""

    def __init__(self, claim: Claim, named: dict[str, Any], launched: float) -> None:
        attributes: dict[str, Fact] = {
            "loa.computation": claim.id,
            "loa.process": claim.process,
            "loa.attempt": claim.attempts,
        }
        queued = datetime.fromisoformat(claim.waited_from).timestamp() if claim.waited_from else launched
        # `min`: clocks of two machines may differ
        end_span(begun_span("queue", claim.traceparent, min(queued, launched), attributes), launched)
        attributes |= {f"process.{name}": value for name, value in named.items()}
        self._attempt = begun_span(f"attempt {claim.process}", claim.traceparent, launched, attributes)
        self._name, self._cpu_s, self._left = "", 0.0, _MAX_STAGES
        self._stage = self._begun(_START, launched, 0.0)

    def _begun(self, name: str, at_s: float, cpu_s: float) -> Span:
        self._name, self._cpu_s, self._left = name, cpu_s, self._left - 1
        return begun_span(name, traceparent_of(self._attempt), at_s)

    def see(self, steps: Iterable[Step]) -> None:
        """Take reports of the worker: the name of another stage ends a span and begins the next."""
        for step in steps:
            name = stage_name(step.stage)
            if name != self._name and self._left > 0:
                end_span(self._stage, step.at, {"loa.cpu_s": step.cpu_s - self._cpu_s})
                self._stage = self._begun(name, step.at, step.cpu_s)

    def end(self, outcome: str, usage: Usage | None) -> None:
        """End the spans of the attempt with its outcome, such as "done", and its resources if known."""
        now, fault = time.time(), "" if outcome == "done" else outcome
        of_stage, of_attempt = dict[str, Fact](), dict[str, Fact]({"loa.outcome": outcome})
        if usage is not None:
            of_stage["loa.cpu_s"] = max(usage.cpu_s - self._cpu_s, 0.0)
            of_attempt |= {"loa.cpu_s": usage.cpu_s, "loa.peak_mb": usage.peak_mb}
        end_span(self._stage, now, of_stage, fault=fault)
        end_span(self._attempt, now, of_attempt, fault=fault)


@dataclass(frozen=True)
class Attempt:
    """A claim and its worker in a directory, with log, figures and spans."""

    claim: Claim
    worker: Run
    workspace: Path
    log: Path
    figures: WorkerFigures
    trace: _AttemptTrace
    fraction: PacedFraction

    def note_end(self, outcome: str) -> None:
        """Count and log the end of the worker and, if it has been reaped, its use of resources."""
        self.figures.ended(self.claim.process, outcome, self.worker)
        for reason in self.worker.warnings:
            logger.warning("worker warns", **self.worker.log_fields, reason=reason)
        self.trace.end(outcome, self.worker.usage)
        usage = {} if self.worker.usage is None else self.worker.usage.as_json()
        logger.info(
            "worker ended",
            computation=self.claim.id,
            process=self.claim.process,
            **self.worker.log_fields,
            attempt=self.claim.attempts,
            outcome=outcome,
            **usage,
            **trace_fields(self.claim.traceparent),
        )

    def too_costly(self, claims: Claims) -> str | None:
        """Return the reason why the attempt exceeds its limit of cost, or None.

        Before that the limit is read again, because another job with the same work may have raised it.
        """
        if self.claim.max_cost_s is None:
            return None
        spent = self.worker.spent()
        if spent is None or spent <= self.claim.max_cost_s:
            return None
        limit = claims.max_cost_s(self.claim)
        if limit is None or spent <= limit:
            return None
        return f"The limit of {engineering(limit, 4)} CPU s (max_cost_s) was reached. {LOWER_COST}"


def begun(
    settings: Settings, process: Process, claim: Claim, crew: Crew, store: ResultStore, figures: WorkerFigures
) -> Attempt:
    """Start the work on a claim; raises if the system starts no process or an input result was removed."""
    workspace = settings.data_directory / "work" / claim.id
    log = settings.data_directory / "log" / f"{claim.id}.log"
    workspace.mkdir(parents=True, exist_ok=True)
    launched = time.time()  # before the worker can reach its first stage
    reads = claim.inputs.get("scene") is not None or claim.inputs.get("run") is not None
    stored = files_read(claim.inputs, store.within(claim.project)) if reads else {}
    order = WorkOrder(
        entry=process.entry,
        inputs=claim.inputs,
        key=claim.key,
        workspace=workspace,
        data_directory=settings.data_directory,
        memory_limit_mb=settings.memory_limit_mb,
        stored=stored,
    )
    worker = crew.begin(order, f"{claim.id}-{claim.attempts}-{claim.lost_runs}", log)
    figures.started(claim.process)
    fields = {"computation": claim.id, "process": claim.process, "key": claim.key}
    fields |= trace_fields(claim.traceparent)
    logger.info("worker started", **fields, **worker.log_fields, attempt=claim.attempts)
    trace = _AttemptTrace(claim, worker.log_fields, launched)
    return Attempt(claim, worker, workspace, log, figures, trace, PacedFraction(process.stages))
