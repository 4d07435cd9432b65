"""Cost of tasks to the workers that did them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from fe_contact.workers.packed import Packed
from host import children_cpu_seconds, peak_memory

R = TypeVar("R")


@dataclass
class RunCost:
    """Cost of remote tasks so far; the only state here that changes.

    Work that is lost with its worker is not in it: nobody can tell.

    Attributes
    ----------
    tasks : int
    cpu_seconds : float
        Of the threads that did them and of the processes they started. A worker that does its tasks in its
        main thread, as those of a pool of processes, has no others: then of all its threads.
    peak_memory_bytes : int
        Largest resident memory of any of their processes.
    lost : str
        Why they were lost, and the rest was done here; empty if they were not.
    """

    tasks: int = 0
    cpu_seconds: float = 0.0
    peak_memory_bytes: int = 0
    lost: str = ""

    def since(self, before: RunCost) -> RunCost:
        """Return what was spent after another reading of the same; the peak is that of all."""
        cpu_seconds = self.cpu_seconds - before.cpu_seconds
        return RunCost(self.tasks - before.tasks, cpu_seconds, self.peak_memory_bytes, self.lost)

    def add(self, done: Done[R]) -> R:
        """Count a task, and return its result."""
        self.tasks += 1
        self.cpu_seconds += done.cpu_seconds
        self.peak_memory_bytes = max(self.peak_memory_bytes, done.peak_memory_bytes)
        return done.result


@dataclass(frozen=True)
class Done(Generic[R]):
    """The result of one task, and what it cost its worker."""

    result: R
    cpu_seconds: float
    peak_memory_bytes: int


def do_task(function: Callable[[Any, Any], R], packed: Packed, item: Any) -> Done[R]:
    """Do one task, on a worker."""
    begun = _cpu_seconds()
    result = function(packed.unpacked(), item)
    return Done(result, _cpu_seconds() - begun, peak_memory())


def _cpu_seconds() -> float:
    alone = threading.current_thread() is threading.main_thread()
    own = time.process_time() if alone else time.thread_time()
    return own + children_cpu_seconds()
