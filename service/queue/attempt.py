"""One attempt at a computation: its claim, its worker, and where they work."""

from __future__ import annotations

import shutil
import time
import uuid
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any, TypeAlias

import structlog
from opentelemetry.trace import Span
from prometheus_client import Counter, Histogram, Metric
from prometheus_client.registry import Collector

from bounds import engineering
from host.children.launcher import Launcher
from lineofaction.gearbox.loading import on_demand
from lineofaction.gearbox.stages import PacedFraction
from model_studies.progress import stage_name
from service.queue.claims import MOST_LOST_RUNS, SUSPECT_FROM, Claim, Claims
from service.queue.cluster import Cluster, Task
from service.queue.terms import LOWER_COST
from service.settings import LEAST_MEMORY_MB, Settings
from service.store.results import ResultStore
from service.tracing import Fact, begun_span, end_span, trace_facts, traceparent_of
from service.worker.order import Outcome, WorkOrder
from service.worker.process import Process
from service.worker.usage import BYTES_PER_MB, Usage, machine_memory_mb, no_space
from service.worker.worker import WORK, Step, Worker

logger = structlog.get_logger(__name__)
files_read = on_demand("service.worker.preparations:files_read")


# Who works: children of this machine, or tasks of a Dask scheduler.


Run: TypeAlias = Worker | Task
"""Work on one order."""

_MEMORY_MB = (128, 256, 512, 1024, 2048, 4096, 8192, 16384)
"""Upper bounds of the classes of peak memory."""
_ALARMING = ("died", "defect")
"""Outcomes that an operator is to look into."""
_START = "start"
"""Stage before the first report: the process starts and loads its program."""
_MOST_STAGES = 200
"""Spans of one attempt; what is reported after them belongs to the last."""


class Children:
    """Child processes of this one, `settings.workers` at a time."""

    keeps = False

    def __init__(self, settings: Settings, modules: Iterable[str]) -> None:
        self.most = settings.workers
        self._memory_mb = max(LEAST_MEMORY_MB, machine_memory_mb() // settings.workers)
        log = settings.data_directory / "log" / "warm.log"
        self._launcher = Launcher(WORK, modules, log, logger.warning)

    def start(self, _heard: Callable[[], None]) -> None:
        """Do nothing: the first child starts the warm process."""

    def begin(self, order: WorkOrder, _name: str, log: Path) -> Worker:
        """Start a child, or fork one; raises OSError: the system does neither."""
        memory_mb = order.memory_limit_mb or self._memory_mb
        return Worker(replace(order, memory_limit_mb=memory_mb), log, self._launcher.launch)

    def hurry(self) -> None:
        """Begin what is being begun at once: it is to stop."""
        self._launcher.hurry()

    def close(self) -> None:
        """End the warm process."""
        self._launcher.close()


Crew: TypeAlias = Children | Cluster
"""Who begins work on orders; what one runs that `keeps` outlives the server and is found again by name."""


# What the workers of one scheduler did: counted by the process they worked for.


class WorkerFigures(Collector):
    """Counts of starts, ends and resources; what follows from them is for who reads them."""

    def __init__(self) -> None:
        def counter(name: str, text: str, *labels: str) -> Counter:
            return Counter(name, text, labels, registry=None)

        self._starts = counter("loa_worker_starts", "Workers started", "process")
        self._ends = counter("loa_worker_ends", "Workers ended", "process", "outcome")
        text = "Warnings of ended workers, as that the Dask cluster is away"
        self._warnings = counter("loa_worker_warnings", text, "process")
        self._cpu = counter("loa_worker_cpu_seconds", "CPU time of ended workers", "process")
        text, bounds = "Most resident memory of ended workers", [bound * BYTES_PER_MB for bound in _MEMORY_MB]
        name = "loa_worker_peak_memory_bytes"
        self._memory = Histogram(name, text, ["process"], buckets=bounds, registry=None)
        text = "Bodies that workers looked for in the compliance cache"
        self._reads = counter("loa_compliance_cache_reads", text, "outcome")
        for outcome in ("hit", "miss"):
            self._reads.labels(outcome)

    def started(self, process: str) -> None:
        """Count a worker that was started; what alerts are about counts from 0, not from its first time."""
        self._starts.labels(process).inc()
        self._warnings.labels(process)
        for outcome in _ALARMING:
            self._ends.labels(process, outcome)

    def ended(self, process: str, outcome: str, worker: Run) -> None:
        """Count a worker that ended, and what it took if it was reaped."""
        self._ends.labels(process, outcome).inc()
        self._warnings.labels(process).inc(len(worker.warnings))
        self._reads.labels("hit").inc(worker.compliance_reads.hits)
        self._reads.labels("miss").inc(worker.compliance_reads.misses)
        if worker.usage is not None:
            self._cpu.labels(process).inc(worker.usage.cpu_s)
            self._memory.labels(process).observe(worker.usage.peak_mb * BYTES_PER_MB)

    def collect(self) -> Iterable[Metric]:
        """Return the figures."""
        for figure in (self._starts, self._ends, self._warnings, self._cpu, self._memory, self._reads):
            yield from figure.collect()


# The spans of one attempt: its wait in the queue, the attempt, and the stages of its worker.


class _AttemptTrace:
    """Spans that end as the attempt goes on; no stage begins before it was `launched`, s since 1970."""

    def __init__(self, claim: Claim, named: dict[str, Any], launched: float) -> None:
        facts: dict[str, Fact] = {
            "loa.computation": claim.id,
            "loa.process": claim.process,
            "loa.attempt": claim.attempts,
        }
        begun = datetime.fromisoformat(claim.waited_from).timestamp() if claim.waited_from else launched
        end_span(begun_span("queue", claim.traceparent, min(begun, launched), facts), launched)
        facts |= {f"process.{name}": value for name, value in named.items()}
        self._attempt = begun_span(f"attempt {claim.process}", claim.traceparent, launched, facts)
        self._name, self._cpu_s, self._left = "", 0.0, _MOST_STAGES
        self._stage = self._begun(_START, launched, 0.0)

    def _begun(self, name: str, at_s: float, cpu_s: float) -> Span:
        self._name, self._cpu_s, self._left = name, cpu_s, self._left - 1
        return begun_span(name, traceparent_of(self._attempt), at_s)

    def see(self, steps: Iterable[Step]) -> None:
        """Take what the worker reported: another name ends a stage and begins the next."""
        for step in steps:
            name = stage_name(step.stage)
            if name != self._name and self._left > 0:
                end_span(self._stage, step.at, {"loa.cpu_s": step.cpu_s - self._cpu_s})
                self._stage = self._begun(name, step.at, step.cpu_s)

    def end(self, how: str, usage: Usage | None) -> None:
        """End the attempt; what it took is known if its worker was reaped."""
        now, fault = time.time(), "" if how == "done" else how
        of_stage, of_attempt = dict[str, Fact](), dict[str, Fact]({"loa.outcome": how})
        if usage is not None:
            of_stage["loa.cpu_s"] = max(usage.cpu_s - self._cpu_s, 0.0)
            of_attempt |= {"loa.cpu_s": usage.cpu_s, "loa.peak_mb": usage.peak_mb}
        end_span(self._stage, now, of_stage, fault=fault)
        end_span(self._attempt, now, of_attempt, fault=fault)


@dataclass(frozen=True)
class Attempt:
    """A claim and what works on it: in a directory of its own, with its log, its figures and its spans."""

    claim: Claim
    worker: Run
    workspace: Path
    log: Path
    figures: WorkerFigures
    trace: _AttemptTrace
    fraction: PacedFraction

    def note_end(self, how: str) -> None:
        """Count and log how the worker ended and, if it has been reaped, what it took."""
        self.figures.ended(self.claim.process, how, self.worker)
        for reason in self.worker.warnings:
            logger.warning("worker warns", **self.worker.facts, reason=reason)
        self.trace.end(how, self.worker.usage)
        usage = {} if self.worker.usage is None else self.worker.usage.as_json()
        logger.info(
            "worker ended",
            computation=self.claim.id,
            process=self.claim.process,
            **self.worker.facts,
            attempt=self.claim.attempts,
            outcome=how,
            **usage,
            **trace_facts(self.claim.traceparent),
        )

    def too_costly(self, claims: Claims) -> str | None:
        """Return why it has to end; the limit is read again before, as a job that shares it may extend it."""
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
    """Let a claim be worked on; raises what keeps the system from it, or that a result it reads is gone."""
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
    facts = {"computation": claim.id, "process": claim.process, "key": claim.key}
    facts |= trace_facts(claim.traceparent)
    logger.info("worker started", **facts, **worker.facts, attempt=claim.attempts)
    trace = _AttemptTrace(claim, worker.facts, launched)
    return Attempt(claim, worker, workspace, log, figures, trace, PacedFraction(process.stages))


# The end of an attempt: its products are stored, or the table states why there are none.


@dataclass(frozen=True)
class Ended:
    """An attempt that has ended, and how."""

    attempt: Attempt
    outcome: Outcome


@dataclass(frozen=True)
class Settlement:
    """Settles attempts; each step may be repeated until the database and the store take it.

    Suspects run `alone`, unless a cluster places them.
    """

    claims: Claims
    store: ResultStore
    most_attempts: int
    alone: bool = True

    def settle(self, ended: Ended) -> None:
        """Store what was made, or note why nothing is; remove the workspace unless an attempt follows."""
        claim = ended.attempt.claim
        span = begun_span("settle", claim.traceparent, time.time())
        try:
            waits = self._note(claim, ended.outcome, ended.attempt)
        finally:
            end_span(span, time.time(), {"loa.computation": claim.id})
        if not waits:
            shutil.rmtree(ended.attempt.workspace, ignore_errors=True)

    def _note(self, claim: Claim, outcome: Outcome, attempt: Attempt) -> bool:
        """Note how an attempt ended; return whether another follows."""
        if outcome.lost:
            return self.free_or_fail(claim, outcome.failure, claim.lost_runs + 1)
        if outcome.died:
            return self.again_or_fail(claim, outcome.failure)
        if outcome.unexpected:
            self.fail_by_log(claim, "An unexpected failure occurred.", log=str(attempt.log))
        elif outcome.failure:
            self.claims.fail(claim, outcome.failure, outcome.faults)
        else:
            self._keep(claim, outcome, attempt.worker.usage)
        return False

    def _keep(self, claim: Claim, outcome: Outcome, usage: Usage | None) -> None:
        """Store what was made; a file system that does not take it will not do so at a repetition either."""
        store = self.store.within(claim.project)
        spent = {} if usage is None else {"cpu_seconds": round(usage.cpu_s, 3)}
        try:
            for product in outcome.products:
                cost = {} if product.key != claim.key else spent
                store.put(product.key, product.kind, product.file, product.headline | cost)
        except OSError as error:
            self.fail_by_log(claim, no_space(error) or "The result could not be stored.", exc_info=True)
        else:
            self.claims.succeed(claim)

    def fail_by_log(self, claim: Claim, text: str, **facts: Any) -> None:
        """End work without a result; the details are in the log, under a reference that the caller gets."""
        reference = uuid.uuid4().hex[:12]
        logger.error("worker failed", computation=claim.id, reference=reference, reason=text, **facts)
        told = f"{text} The log has the details under {reference}."
        self.claims.fail(claim, told, reference=reference)

    def again_or_fail(self, claim: Claim, reason: str) -> bool:
        """Give work that died another attempt, as long as there are any; return whether there is one."""
        most = self.most_attempts
        if claim.attempts < most:
            text = f"{reason} Waits for attempt {claim.attempts + 1} of {most}."
            self.claims.put_back(claim, text, counted=True)
            return True
        self.claims.fail(claim, f"{reason} That was attempt {claim.attempts} of {most}.")
        return False

    def free_or_fail(self, claim: Claim, reason: str, lost_runs: int) -> bool:
        """Let work be begun again whose server or Dask worker ended, unless it is what ends them.

        The evidence is who ran: this work so many times in a row, in the end without others.
        """
        if lost_runs < MOST_LOST_RUNS:
            text = f"{reason} Waits to be begun again, which is no attempt."
            self.claims.put_back(claim, text, counted=False, lost_runs=lost_runs)
            return True
        alone = f", the last {lost_runs - SUSPECT_FROM} with no other job beside it" if self.alone else ""
        text = f"{reason} So ended {lost_runs} of its runs in a row{alone}: it may need too much memory. "
        text += "Select a coarser level or fewer positions, or start the service with LOA_MEMORY_LIMIT_MB."
        self.claims.fail(claim, text)
        return False
