"""Cost of a piece of work: predicted before it runs, corrected for the host, measured."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from bounds import engineering
from host import memory_figure, peak_memory
from model_studies.progress import ANNOUNCED, Progress
from model_studies.workers import InProcess, Workers, spent


class Cost(NamedTuple):
    """CPU seconds on one thread, and bytes of the largest working set."""

    seconds: float
    bytes: float

    def then(self, later: Cost) -> Cost:
        """Return the cost of this work and another after it: seconds add up, memory is used again."""
        return Cost(self.seconds + later.seconds, max(self.bytes, later.bytes))

    def times(self, count: float) -> Cost:
        """Return the cost of `count` pieces of the same work, one after the other."""
        return Cost(self.seconds * count, self.bytes)

    @property
    def text(self) -> str:
        """The cost in words: "about 25 CPU s, 1.2 GB"."""
        return f"about {engineering(self.seconds, 2)} CPU s, {engineering(self.bytes / 1e9, 2)} GB"


@dataclass(frozen=True)
class WorkCost:
    """Predicted and measured cost of work that was done."""

    predicted_seconds: float
    """Predicted CPU seconds on this host."""
    predicted_bytes: float
    """Predicted bytes of the largest working set."""
    seconds: float
    """Measured CPU seconds."""
    bytes: float | None = None
    """Largest resident memory during the work less the memory at its start, bytes. None: the process had been
    larger before, or the system does not state its memory, so that the growth is unknown.
    """


def on_this_host(kind: str, cost: Cost, cache: Path | None) -> Cost:
    """Return a predicted cost scaled by the speed of this host and by the cost of earlier work of its kind.

    Parameters
    ----------
    kind : str
        The name under which `run_log` keeps the work.
    cost : Cost
        Cost on the reference host of `host_speed`.
    cache : Path, optional
        Directory with the measured speed of the host and the log of its work; None: the speed is measured
        once per process.
    """
    from model_studies.host_speed import host_slowness  # noqa: PLC0415 (start-up time)
    from model_studies.run_log import corrections  # noqa: PLC0415

    factor = host_slowness(cache) * corrections(cache).get(kind, 1.0)
    return cost._replace(seconds=cost.seconds * factor)


@dataclass(frozen=True)
class WorkMeter:
    """Clock and memory of this process at the beginning of a piece of work."""

    kind: str
    reference: Cost
    """Predicted cost on the reference host."""
    cache: Path | None
    workers: Workers
    predicted: Cost
    """Predicted cost on this host."""
    began: float
    """CPU seconds of this process and of the workers before the work."""
    memory: int | None
    """Resident memory before the work, bytes; None: the system does not state it."""
    peak: int
    """Largest resident memory of the process before the work, bytes."""

    @classmethod
    def at_start(
        cls,
        kind: str,
        reference: Cost,
        cache: Path | None,
        workers: Workers = InProcess(),  # noqa: B008 (frozen)
    ) -> WorkMeter:
        """Read clock and memory before the work.

        Parameters
        ----------
        kind, reference, cache
            Arguments kind, cost and cache of `on_this_host`.
        workers : Workers
            Workers that do parts of the work: their CPU time counts.
        """
        predicted = on_this_host(kind, reference, cache)
        memory, peak = memory_figure("VmRSS"), peak_memory()
        return cls(kind, reference, cache, workers, predicted, spent(workers), memory, peak)

    def finish(self) -> WorkCost:
        """Return the predicted and the measured cost of the work, and record both in the log of the host."""
        from model_studies.host_speed import host_slowness  # noqa: PLC0415 (start-up time)
        from model_studies.run_log import record  # noqa: PLC0415

        seconds, highest = spent(self.workers) - self.began, peak_memory()
        expected = self.reference.seconds * host_slowness(self.cache)
        record(self.cache, {self.kind: expected}, {self.kind: seconds})
        growth = float(highest - self.memory) if self.memory is not None and highest > self.peak else None
        return WorkCost(self.predicted.seconds, self.predicted.bytes, seconds, growth)


def announce(progress: Progress, stage: str, subject: str, cost: Cost) -> None:
    """Report the cost of a stage before it begins, if it exceeds `ANNOUNCED` CPU seconds.

    `progress`: called as progress("stage; subject: about 25 CPU s, 1.2 GB", 0.0), where 0.0 is the fraction
    of the work that is done.
    """
    if cost.seconds > ANNOUNCED:
        progress(f"{stage}; {subject}: {cost.text}", 0.0)
