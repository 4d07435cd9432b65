"""Time of the stages of a computation, for its receipt."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from fe_contact.types import Json
from host import children_peak_memory, cpu_seconds, peak_memory
from model_studies.progress import Progress, silent
from model_studies.workers.executor import RunCost


@dataclass(frozen=True)
class _Stage:
    """Time of one stage: CPU seconds of all who worked on it, and wall seconds."""

    name: str
    cpu_seconds: float
    wall_seconds: float


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
        self.stages: list[_Stage] = []
        self.progress = progress
        self._remote = remote or RunCost()
        self._last = self._reading()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what happens inside."""
        begun = self._reading()
        try:
            yield
        finally:
            self._book(name, begun)

    def finish(self, name: str) -> None:
        """Book the time since the last stage ended, or since the clock was made."""
        self._book(name, self._last)

    @property
    def seconds(self) -> dict[str, float]:
        """CPU seconds by stage."""
        names = dict.fromkeys(stage.name for stage in self.stages)
        return {name: sum(s.cpu_seconds for s in self.stages if s.name == name) for name in names}

    def to_json(self) -> Json:
        """Return times by stage, their sum, and the peak memory in bytes."""
        by_stage = {
            name: {
                "cpu_seconds": cpu,
                "wall_seconds": sum(s.wall_seconds for s in self.stages if s.name == name),
            }
            for name, cpu in self.seconds.items()
        }
        return {
            "stages": by_stage,
            "cpu_seconds": sum(stage.cpu_seconds for stage in self.stages),
            "wall_seconds": sum(stage.wall_seconds for stage in self.stages),
            "peak_memory_bytes": max(peak_memory(), children_peak_memory()),
        }

    def _book(self, name: str, begun: tuple[float, float]) -> None:
        self._last = self._reading()
        self.stages.append(_Stage(name, self._last[0] - begun[0], self._last[1] - begun[1]))

    def _reading(self) -> tuple[float, float]:
        """CPU seconds of this process, its finished children and others' tasks, and wall seconds."""
        own = cpu_seconds()
        return own + self._remote.cpu_seconds, time.perf_counter()
