"""Cost of tasks to the workers that did them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

R = TypeVar("R")


@dataclass
class RunCost:
    """Cost of remote tasks so far; the cost of a task that was lost with its worker is not known."""

    tasks: int = 0
    """Number of tasks."""
    cpu_seconds: float = 0.0
    """CPU time of the threads that did the tasks, and of the processes that these started. A worker that does
    tasks in its main thread, as those of a pool do, counts all its threads.
    """
    peak_memory_bytes: int = 0
    """Largest memory of a process of the workers."""
    lost: str = ""
    """Reason why the workers were lost, after which this process did the remaining tasks; else empty."""

    def since(self, before: RunCost) -> RunCost:
        """Return the cost since an earlier reading; the largest memory remains that since the beginning."""
        cpu_seconds = self.cpu_seconds - before.cpu_seconds
        return RunCost(self.tasks - before.tasks, cpu_seconds, self.peak_memory_bytes, self.lost)

    def add(self, task: TaskResult[Any]) -> None:
        """Count the cost of a task."""
        self.tasks += 1
        self.cpu_seconds += task.cpu_seconds
        self.peak_memory_bytes = max(self.peak_memory_bytes, task.peak_memory_bytes)


@dataclass(frozen=True)
class TaskResult(Generic[R]):
    """The result of one task, and its cost for the worker."""

    result: R
    cpu_seconds: float
    peak_memory_bytes: int
