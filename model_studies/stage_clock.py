"""Time of the stages of a computation, for its receipt."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass

from bounds.types import Json
from host import children_peak_memory, cpu_seconds, peak_memory
from model_studies.progress import Progress, silent
from model_studies.workers.run_cost import RunCost


@dataclass(frozen=True)
class TimeTaken:
    """Time of a piece of work."""

    cpu_seconds: float = 0.0
    """CPU time of this process, its finished children and others' tasks: the cost."""
    wall_seconds: float = 0.0
    """Elapsed time, s."""

    @classmethod
    def now(cls, remote: RunCost | None = None) -> TimeTaken:
        """Read both clocks, to be told apart from a later reading; `remote` counts tasks of others."""
        seconds = cpu_seconds()
        return cls(seconds + (remote.cpu_seconds if remote else 0.0), time.perf_counter())

    def plus(self, other: TimeTaken) -> TimeTaken:
        """Return the time of both."""
        return TimeTaken(self.cpu_seconds + other.cpu_seconds, self.wall_seconds + other.wall_seconds)

    def since(self, earlier: TimeTaken) -> TimeTaken:
        """Return the time from one reading to this one."""
        return TimeTaken(self.cpu_seconds - earlier.cpu_seconds, self.wall_seconds - earlier.wall_seconds)


class StageClock:
    """Collects the stages of one run; repeated stages are added up.

    Parameters
    ----------
    remote : RunCost, optional
        What tasks cost that others do for this process: it counts beside its own time and its children's.
    progress : callable
        Called as progress(stage, fraction).
    """

    def __init__(self, remote: RunCost | None = None, progress: Progress = silent) -> None:
        self.stages: dict[str, TimeTaken] = {}
        self.progress = progress
        self._remote = remote
        self._last = TimeTaken.now(remote)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time the block as a stage; a context manager."""
        start = TimeTaken.now(self._remote)
        try:
            yield
        finally:
            self._end(name, start)

    def finish(self, name: str) -> None:
        """Book the time since the last stage ended, or since the clock was made."""
        self._end(name, self._last)

    def book(self, name: str, duration: TimeTaken) -> None:
        """Add the time of a stage that was taken apart."""
        self.stages[name] = self.stages.get(name, TimeTaken()).plus(duration)

    @property
    def seconds(self) -> dict[str, float]:
        """CPU seconds by stage."""
        return {name: duration.cpu_seconds for name, duration in self.stages.items()}

    @property
    def wall_seconds(self) -> dict[str, float]:
        """Wall seconds by stage."""
        return {name: duration.wall_seconds for name, duration in self.stages.items()}

    def to_json(self) -> Json:
        """Return times by stage, their sum, and the peak memory in bytes."""
        return {
            "stages": {name: asdict(duration) for name, duration in self.stages.items()},
            "cpu_seconds": sum(self.seconds.values()),
            "wall_seconds": sum(self.wall_seconds.values()),
            "peak_memory_bytes": max(peak_memory(), children_peak_memory()),
        }

    def _end(self, name: str, start: TimeTaken) -> None:
        self._last = TimeTaken.now(self._remote)
        self.book(name, self._last.since(start))
