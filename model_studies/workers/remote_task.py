"""A task on a worker: the arguments that tasks share, pickled once, and its result with its cost."""

from __future__ import annotations

import hashlib
import pickle
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from host import children_cpu_seconds, peak_memory
from model_studies.workers.in_process import WorkersLost
from model_studies.workers.run_cost import TaskResult

R = TypeVar("R")
MAX_SHARED = 2
"""Number of shared inputs that a thread of a worker keeps. An input that it prepared once serves all its
tasks.
"""
_local = threading.local()


@dataclass(frozen=True)
class Packed:
    """The input that tasks share, pickled, with its digest; its bytes are in `file` if there is one."""

    content: bytes
    digest: str
    file: Path | None = None

    @classmethod
    def of(cls, shared: object) -> Packed:
        """Pickle a shared input."""
        content = pickle.dumps(shared, protocol=pickle.HIGHEST_PROTOCOL)
        return cls(content, hashlib.sha256(content).hexdigest())

    def in_file(self, folder: Path) -> Packed:
        """Write the shared input into a file of the folder."""
        file = folder / self.digest
        file.write_bytes(self.content)
        return Packed(b"", self.digest, file)

    def unpacked(self) -> Any:
        """Return the shared input, one object for all tasks of a thread, so that its caches last."""
        known: dict[str, Any] = _local.__dict__.setdefault("known", {})
        if self.digest not in known:
            while len(known) >= MAX_SHARED:
                known.pop(next(iter(known)))
            content = self.content if self.file is None else self.file.read_bytes()
            known[self.digest] = pickle.loads(content)
        return known[self.digest]


def do_task(function: Callable[[Any, Any], R], item: Any, packed: Packed) -> TaskResult[R]:
    """Do one task, on a worker."""
    cpu_before = task_cpu_seconds()
    try:
        result = function(packed.unpacked(), item)
    except KeyboardInterrupt:  # a Ctrl-C reaches the processes of a pool, too
        raise WorkersLost("A worker was interrupted.") from None
    return TaskResult(result, task_cpu_seconds() - cpu_before, peak_memory())


def task_cpu_seconds() -> float:
    """Return the CPU seconds of this process with its children; of its thread if it is not the main one."""
    is_main = threading.current_thread() is threading.main_thread()  # else other threads do other tasks
    seconds = time.process_time() if is_main else time.thread_time()
    return seconds + children_cpu_seconds()
