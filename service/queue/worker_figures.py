"""Metrics of the workers of one scheduler, labelled by the process that they worked for."""

from __future__ import annotations

from collections.abc import Iterable

from prometheus_client import Counter, Histogram, Metric
from prometheus_client.registry import Collector

from service.queue.crew import Run
from service.worker.usage import BYTES_PER_MB

_MEMORY_MB = (128, 256, 512, 1024, 2048, 4096, 8192, 16384)
"""Upper bounds of the classes of peak memory."""
_ALARMING = ("died", "defect")
"""Outcomes that an operator is to look into."""


class WorkerFigures(Collector):
    """Counts of starts, ends and resources, from which readers derive rates and means."""

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
        """Count a started worker; counts of alerts exist from 0 on, not from their first event."""
        self._starts.labels(process).inc()
        self._warnings.labels(process)
        for outcome in _ALARMING:
            self._ends.labels(process, outcome)

    def ended(self, process: str, outcome: str, worker: Run) -> None:
        """Count an ended worker, and its use of resources if it was reaped."""
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
