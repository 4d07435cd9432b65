"""What a run cost and how wrong it is, by stage and by source."""

from __future__ import annotations

import resource
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from fe_contact.types import Json


@dataclass(frozen=True)
class Stage:
    """Time of one stage: CPU seconds of this process and its finished children, and wall seconds."""

    name: str
    cpu_seconds: float
    wall_seconds: float


@dataclass
class StageClock:
    """Collects the stages of one run (the only mutable object of the analysis)."""

    stages: list[Stage] = field(default_factory=list)

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time what happens inside."""
        cpu, wall = _cpu_seconds(), time.perf_counter()
        try:
            yield
        finally:
            self.stages.append(Stage(name, _cpu_seconds() - cpu, time.perf_counter() - wall))

    def to_json(self) -> Json:
        """Return times by stage, their sum, and the peak memory in bytes; repeated stages are added up."""
        names = list(dict.fromkeys(stage.name for stage in self.stages))
        by_stage = {
            name: {
                "cpu_seconds": sum(s.cpu_seconds for s in self.stages if s.name == name),
                "wall_seconds": sum(s.wall_seconds for s in self.stages if s.name == name),
            }
            for name in names
        }
        return {
            "stages": by_stage,
            "cpu_seconds": sum(stage.cpu_seconds for stage in self.stages),
            "wall_seconds": sum(stage.wall_seconds for stage in self.stages),
            "peak_memory_bytes": _peak_memory(),
        }


def _cpu_seconds() -> float:
    """User and system time of this process and of its finished children."""
    usage = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(u.ru_utime + u.ru_stime for u in usage)


def _peak_memory() -> int:
    """Largest resident memory of this process or one of its children, bytes (Linux reports KiB)."""
    return 1024 * max(
        resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
