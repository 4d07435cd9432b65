"""Cost of tasks to the workers that did them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, TypeVar

R = TypeVar("R")


@dataclass
class RunCost:
    """Cost of remote tasks so far, without work that was lost with its worker: nobody can tell.

    The CPU time is that of the threads that did them, or of all threads of a worker that does them in its
    main one as those of a pool do, and of the processes they started; the memory the largest of any of their
    processes; `lost` says why they were lost and the rest was done here.
    """

    tasks: int = 0
    cpu_seconds: float = 0.0
    peak_memory_bytes: int = 0
    lost: str = ""

    def since(self, before: RunCost) -> RunCost:
        """Return the cost since an earlier reading of the same cost; the peak is that of the whole time."""
        cpu_seconds = self.cpu_seconds - before.cpu_seconds
        return RunCost(self.tasks - before.tasks, cpu_seconds, self.peak_memory_bytes, self.lost)

    def add(self, done: TaskResult[R]) -> R:
        """Count a task, and return its result."""
        self.tasks += 1
        self.cpu_seconds += done.cpu_seconds
        self.peak_memory_bytes = max(self.peak_memory_bytes, done.peak_memory_bytes)
        return done.result


@dataclass(frozen=True)
class TaskResult(Generic[R]):
    """The result of one task, and its cost for the worker."""

    result: R
    cpu_seconds: float
    peak_memory_bytes: int
